"""culet: dispersive gemstones, traced exactly and streamed to thin clients.

    import culet

    picture = culet.render("ruby", 640, 360, samples=64)
    picture.save("ruby.png")

What a name needs is imported when the name is first used, so that `import culet` itself takes no time.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from culet import study
    from culet.errors import CuletError
    from culet.falls import Motion, simulate
    from culet.notebook import View, view
    from culet.scene import PRESETS, Scene
    from culet.sources import load_scene
    from culet.stills import Cost, Missed, Picture, render
    from culet.version import __version__

_HOMES = {
    "CuletError": "culet.errors",
    "Motion": "culet.falls",
    "simulate": "culet.falls",
    "View": "culet.notebook",
    "view": "culet.notebook",
    "PRESETS": "culet.scene",
    "Scene": "culet.scene",
    "load_scene": "culet.sources",
    "Cost": "culet.stills",
    "Missed": "culet.stills",
    "Picture": "culet.stills",
    "render": "culet.stills",
    "__version__": "culet.version",
}
"""The modules that the names come from."""

__all__ = [
    "PRESETS", "Cost", "CuletError", "Missed", "Motion", "Picture", "Scene", "View", "__version__", "load_scene",
    "render", "simulate", "study", "view",
]  # fmt: skip


def __getattr__(name: str) -> object:
    if name == "study":
        return import_module("culet.study")
    if name not in _HOMES:
        raise AttributeError(f"module 'culet' has no attribute {name!r}")
    found = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
