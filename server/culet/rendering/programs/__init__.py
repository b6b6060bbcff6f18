"""Programs by their features: built once, made in the background, kept."""
