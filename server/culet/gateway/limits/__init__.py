"""How much there may be of something, of all and of each client: rates, places, turns, open files."""
