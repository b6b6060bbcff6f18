"""How exact a moving picture can be in the time that it has."""
