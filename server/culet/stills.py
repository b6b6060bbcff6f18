"""One way to render a still picture, for scripts, notebooks and the command line."""

from __future__ import annotations

import functools
import math
import os
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from culet.errors import InputError
from culet.rendering.cut_out import CuttingRenderer
from culet.rendering.film import files
from culet.rendering.film.target import Target
from culet.rendering.renderer import DevicePicture
from culet.scene import Scene
from culet.scene.film import MOST_SAMPLES
from culet.sources import load_scene, load_stage
from culet.stage import Stage

PIECE_SECONDS = 0.1
"""Between two looks at the progress, and at whether the caller wants to stop (Ctrl-C)."""
LARGEST_EDGE = 8192
"""Pixels."""

Progress = Callable[[float], None]
"""Called now and then with the part done, 0 to 1."""


class Cost(NamedTuple):
    """What a picture took."""

    samples: int
    """Of each pixel."""
    rays: int
    """Rays that were followed: one from the camera for each sample of each pixel, and every segment within stones."""
    seconds: float
    """s of rendering and developing; the compiler, which is needed once for a kind of scene, apart."""


class Missed(NamedTuple):
    """What a picture does not show, and how far it can be wrong."""

    cut: float
    """Mean weight, over all pixels, of the light that was followed no more (`optics.cutoff`)."""
    bound: float
    """The most by which the mean radiance, averaged over the channels, can be too low for it."""
    error: float
    """Root mean square error of `linear` that its samples let expect, radiance; NaN below two samples."""
    shown_error: float
    """The same of what is shown, from 0 (black) to 1 (white), as `rgb` is of 255; what more samples would take away."""
    light_bound: float
    """Of the light that meets stones, the part whose shadows and caustics on floor and walls may be missing at most;
    NaN where a scene has none."""
    light_error: float
    """Root mean square error of shadows and caustics, radiance on a white surface; NaN where a scene has none."""
    shadows_only: bool
    """Whether stones throw no caustics in the scene, only shadows."""


@dataclass(frozen=True, eq=False, repr=False)
class Picture:
    """A rendered picture. In a notebook it shows itself."""

    scene: Scene
    """What it shows."""
    linear: NDArray[np.float32]
    """(height, width, 3) linear radiance in the primaries of sRGB, the top row first; not exposed, not clipped. Of one
    without a backdrop (height, width, 4): multiplied by alpha, and alpha."""
    rgb: NDArray[np.uint8]
    """(height, width, 3) as the scene's `film` develops it for a screen. Of a transparent picture (height, width, 4):
    not multiplied by alpha, and alpha."""
    cost: Cost
    missed: Missed
    error: float | None = None
    """That `missed.shown_error` was to fall to, if that was asked for."""
    met: bool | None = None
    """Whether it has."""
    findings: tuple[str, ...] = ()
    """What was found in the files that were named, repaired or left out, and which stones overlap, a sentence each."""

    @property
    def width(self) -> int:
        """Pixels."""
        return int(self.rgb.shape[1])

    @property
    def height(self) -> int:
        """Pixels."""
        return int(self.rgb.shape[0])

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the file that the path's ending says, whole or not at all; returns the path.

        `.png`, `.webp` and `.tga` hold `rgb` without loss, `.jpg` nearly so; `.exr` and `.npy` hold `linear`. An
        `.exr` has the scene as JSON (`culet.scene`), the version (`software`) and `quality()` (`comments`) beside it.
        InputError for another ending, and for a place that cannot be written to.
        """
        place = Path(path)
        files.write(place, lambda: self.rgb, lambda: self.linear, self._about())
        return place

    def _about(self) -> dict[str, str]:
        """What it takes to make the picture again."""
        from culet.version import __version__

        return {
            "culet.scene": self.scene.model_dump_json(),
            "software": f"culet {__version__}",
            "comments": self.quality(),
        }

    def with_legend(self) -> Picture:
        """The picture with a legend in a corner of `rgb`: what the colours of ASET or Ideal-Scope mean, and the tilt.

        InputError if the scene has no legend, or the picture no room.
        """
        from culet.legend import drawn, legend_for

        return replace(self, rgb=drawn(self.rgb, legend_for(self.scene, self.width, self.height)))

    def encoded(self, format: str) -> bytes:  # noqa: A002 - as Pillow calls it
        """The same file in memory, its format an ending without the dot."""
        return files.encode(format, lambda: self.rgb, lambda: self.linear)

    def _repr_png_(self) -> bytes:
        return self.encoded("png")

    def __repr__(self) -> str:
        return f"<Picture {self.width} x {self.height}: {self.quality()}>"

    def quality(self) -> str:
        """How right it is, in words."""
        samples = "1 sample" if self.cost.samples == 1 else f"{self.cost.samples} samples"
        return f"{samples} per pixel, {self._noise()}{self._missing()}{self._light_quality()}"

    def _missing(self) -> str:
        """What was cut off."""
        bound = (
            f"mean radiance too low by at most {self.missed.bound:.2g} (light of weight {self.missed.cut:.2g} cut off"
        )
        tells = self.missed.bound < float(self.linear[..., :3].mean())
        return f"{bound})" if tells else f"{bound}, which may all have come from the brightest lamp)"

    def _noise(self) -> str:
        """What more samples would take away."""
        shown, linear = self.missed.shown_error, self.missed.error
        if math.isnan(shown):
            return "" if self.error is None else f"error not known ({self.error:g} was asked for), "
        asked = "" if self.error is None else f" ({'' if self.met else 'but '}{self.error:g} was asked for)"
        return f"estimated error as shown {shown:.2g}{asked} and of radiance {linear:.2g}, "

    def _light_quality(self) -> str:
        """How right shadows and caustics are, where there are any."""
        if math.isnan(self.missed.light_bound):
            return ""
        what = "shadows" if self.missed.shadows_only else "shadows and caustics"
        return (
            f"; {what} miss at most {self.missed.light_bound:.2g} of the light that meets stones, "
            f"estimated error {self.missed.light_error:.2g}"
        )


def render(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str] | None = None,
    width: int = 640,
    height: int = 360,
    *,
    samples: int | None = None,
    error: float | None = None,
    background: str | None = None,
    mesh: str | os.PathLike[str] | None = None,
    sky: str | os.PathLike[str] | None = None,
    progress: Progress | None = None,
) -> Picture:
    """Render a scene.

    Args:
        scene: as `load_scene` takes it: a preset's name, a mapping, a file, a Scene; without it the default scene.
        width: pixels, 1 to 8192.
        height: pixels, 1 to 8192.
        samples: of each pixel, 1 to 65536, with an `error` at most. Without either, what is shown is taken to an
            estimated error of 0.01, with 16 to 256 samples, or more if the scene's `samples_per_pixel` says so.
        error: take samples until what is shown, from 0 to 1, is estimated to be off by this, root mean square over
            pixels and colours; from 0.004 on no difference is seen. Whether that is `met` the picture says.
        background: `transparent` for nothing behind the stones, with alpha, or a colour, such as `#f4f1ea`, for exactly
            that behind them; both take twice the work. Without it the scene's `film.background`.
        mesh: file of a mesh (.obj .off .stl .ply .glb) or of a design (.asc .gem .gcs) that takes the place of the
            scene's stone.
        sky: file (.exr .hdr .png) with a panorama, twice as wide as high, that becomes the scene's sky; of a preset,
            and of the default scene, nothing hides it.
        progress: called about ten times a second with the part done, 0 to 1.

    Raises:
        InputError: for what cannot be used; `field` names it. SceneError and MeshError are kinds of it.
        NotFoundError: for a name that no preset has.
        DeviceError: without an OpenCL device that works.

    The first picture of a kind of scene waits some seconds for a compiler, whose work is kept on the disk. From several
    threads, pictures are rendered one after the other.

    >>> picture = render("white", 32, 18, samples=2)
    >>> picture.linear.shape, picture.rgb.dtype.name, picture.cost.samples
    ((18, 32, 3), 'uint8', 2)
    """
    stage, findings = stage_of(scene, mesh, sky)
    if background is not None:
        stage = before(stage, background)
    return render_stage(stage, width, height, samples=samples, error=error, progress=progress, findings=findings)


def before(stage: Stage, background: str) -> Stage:
    """The stage whose stills have that behind everything, as `film.background` says it; SceneError for what is none."""
    film = stage.scene.film.model_dump(mode="json") | {"background": background}
    return stage.showing(Scene.read(stage.scene.model_dump(mode="json") | {"film": film}))


def stage_of(
    scene: Scene | Mapping[str, Any] | str | os.PathLike[str] | None,
    mesh: str | os.PathLike[str] | None = None,
    sky: str | os.PathLike[str] | None = None,
) -> tuple[Stage, tuple[str, ...]]:
    """The stage of what a caller names, and what was found in the files."""
    findings: list[str] = []
    is_named = scene is None or (isinstance(scene, str) and not scene.lower().endswith(".json"))
    stage = load_stage(
        load_scene(scene),
        None if mesh is None else Path(mesh),
        None if sky is None else Path(sky),
        findings.append,
        sky_is_seen=is_named,
    )
    return stage, tuple(findings)


def render_stage(
    stage: Stage,
    width: int,
    height: int,
    *,
    samples: int | None = None,
    error: float | None = None,
    progress: Progress | None = None,
    findings: tuple[str, ...] = (),
) -> Picture:
    """Render a stage; as `render`."""
    for field, value, most in (("width", width, LARGEST_EDGE), ("height", height, LARGEST_EDGE)):
        _check(field, value, most)
    if samples is not None:
        _check("samples", samples, MOST_SAMPLES)
    if error is not None and (isinstance(error, bool) or not isinstance(error, int | float | np.number)):
        raise InputError(f"error: expected a number above 0 and up to 1, got {error!r}", "error")
    target = Target.of(samples, error, stage.scene)
    with _RENDERING:
        renderer = _renderer()
        make = renderer.cut_out if stage.scene.film.cut_out else renderer.picture
        picture = make(stage, width, height)
        began, segments, paths = time.perf_counter(), 0, 0
        while not picture.reached(target):
            before = picture.samples
            for part in picture.refine_until(target, PIECE_SECONDS, pause=lambda: True):
                if progress is not None:
                    progress(part)
            made = picture.samples - before if picture.samples > before else picture.samples  # it may begin anew
            segments, paths = segments + made * picture.segments(), paths + made
        rgb = picture.rgb()
        cost = Cost(picture.samples, paths * width * height + segments, time.perf_counter() - began)
        met = None if error is None else picture.meets(target)
        linear = np.asarray(picture.linear(), np.float32)
        return Picture(stage.scene, linear, rgb, cost, _missed(picture), error, met, findings)


def _missed(picture: DevicePicture) -> Missed:
    return Missed(
        cut=picture.cut(),
        bound=picture.truncation_bound(),
        error=picture.error_estimate(),
        shown_error=picture.shown_error(),
        light_bound=picture.light_bound(),
        light_error=picture.light_error(),
        shadows_only=picture.shows_shadows_only(),
    )


def _check(field: str, value: int, most: int) -> None:
    if isinstance(value, bool) or not isinstance(value, int | np.integer):
        raise InputError(f"{field}: expected a whole number from 1 to {most}, got {value!r}", field)
    if not 1 <= value <= most:
        raise InputError(f"{field}: expected 1 to {most}, got {value}", field)


_RENDERING = threading.Lock()
"""One thread at a time may refine pictures of a renderer."""


@functools.cache
def _renderer() -> CuttingRenderer:
    """The process's own, made by the first picture."""
    return CuttingRenderer()
