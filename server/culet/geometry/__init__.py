"""Cuts and meshes, made into shapes."""
