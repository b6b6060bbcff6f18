"""culet: dispersive gemstones, traced exactly and streamed to thin clients."""

from importlib.metadata import version

__version__ = version("culet")
