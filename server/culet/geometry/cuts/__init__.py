"""The shapes of cuts, made of their proportions in closed form."""
