"""One ray, made visible: what becomes of the light of a pixel, event by event."""
