"""The compiled solver that moves several stones: its C sources, how they are compiled and loaded, what it is given."""
