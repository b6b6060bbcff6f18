"""Mesh files, read from memory: `read_triangles` is the way in."""

from culet.geometry.formats.reader import FORMATS, Soup, read_triangles

__all__ = ["FORMATS", "Soup", "read_triangles"]
