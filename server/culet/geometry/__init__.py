"""Cuts and meshes, made into stones."""
