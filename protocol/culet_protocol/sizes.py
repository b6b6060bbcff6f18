"""Sizes of pictures that nobody chose, in pixels: width and height."""

LIVE_SIZE = (960, 540)
"""Of live frames for viewers that never say what they would like."""
STILL_SIZE = (640, 360)
"""Of a still that names no size."""
