"""Stones of a picture: where each one is, and its facets as kernels meet them."""
