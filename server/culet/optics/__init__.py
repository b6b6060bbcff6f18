"""Materials and their dispersion."""
