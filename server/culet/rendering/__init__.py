"""From scene to features, to a program, to an image."""
