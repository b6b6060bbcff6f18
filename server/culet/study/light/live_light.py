"""How good the light that stones throw is in a moving frame, and what the frame costs for it, by the cut-off.

The scene's stones, turned at random, pose by pose: the map of one pass, as a moving frame has it, against one that is
all but converged, and the whole frame against the same one with shadows alone, in turns. The error is in parts of the
root mean square of the caustics themselves (a map without them has 1), and in parts of the whole map's, which is mostly
shadow.
"""

from __future__ import annotations

import json
import statistics
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray
from rich import box
from rich.table import Table

from culet.errors import SceneError
from culet.rendering.emitters.light_map import Figures, frame_of
from culet.rendering.emitters.sources import mapped_surfaces, rays_of
from culet.rendering.light.effort import LightEffort
from culet.rendering.light.solids import MANY, takes_only_beams
from culet.rendering.renderer import Renderer
from culet.scene.model import Scene
from culet.stage import Stage
from culet.study.light.caustics import rms, turned

Array = NDArray[np.float64]

CUTOFFS = (3e-3, 1e-3, 5e-4, 3e-4, 2e-4, 1.7e-4, 1e-4)
CONVERGED = 1e-6
"""Cut-off of the maps that others are judged by. Against maps at 1e-7 their own error is 4 % of that at 1e-3; as what
they lack is lacked by all, errors at 1e-3 come out 1 % too small, at 1e-4 3 %."""


@dataclass(frozen=True)
class LiveLight:
    """Of one cut-off, over all poses."""

    cutoff: float
    error: float
    """RMSE over the root mean square of the caustics: the poses' mean."""
    worst: float
    """The largest of a pose."""
    of_map: float
    """RMSE over the root mean square of shadows and caustics together: the poses' mean."""
    cut: float
    """Light that was cut over light that met the stones: the poses' mean."""
    bound: float
    """The same with what was not resolved and what fell beside the map."""
    processor_seconds: float
    """Of a frame, all cores together: median of a pose, mean of the poses."""
    seconds: float
    """The same by the clock."""
    ratio: float
    """Processor time over that of the frame with shadows alone."""


@dataclass(frozen=True)
class CutOffSweep:
    """Of one scene."""

    width: int
    height: int
    poses: int
    shadows_alone: float
    """Processor seconds of a frame."""
    cutoffs: Sequence[LiveLight]

    def document(self) -> str:
        """As JSON."""
        return json.dumps(asdict(self), indent=1)


def measure(
    renderer: Renderer,
    stage: Stage,
    size: tuple[int, int],
    cutoffs: Sequence[float],
    poses: int,
    repeats: int,
    progress: Callable[[float], None],
) -> CutOffSweep:
    """Each frame is traced and developed `repeats` times a pose; SceneError where there is no light of beams.

    Maps of lamps are judged in the lamp's middle direction, which is all that a moving frame has of them.
    """
    _refuse(stage)
    maps: dict[float, list[_Judged]] = {cutoff: [] for cutoff in cutoffs}
    times: dict[float | None, list[tuple[float, float]]] = {key: [] for key in (None, *cutoffs)}
    for number in range(poses):
        pose = turned(stage, number)
        for cutoff, judged in _judged(renderer, pose, cutoffs):
            maps[cutoff].append(judged)
        for key, taken in _timed(renderer, pose, size, (None, *cutoffs), repeats).items():
            times[key].append(taken)
        progress((number + 1) / poses)
    means = {key: np.mean(taken, axis=0) for key, taken in times.items()}
    return CutOffSweep(*size, poses, float(means[None][1]), tuple(
        LiveLight(
            cutoff,
            error=statistics.fmean(each.error for each in judged),
            worst=max(each.error for each in judged),
            of_map=statistics.fmean(each.of_map for each in judged),
            cut=statistics.fmean(each.figures.cut / each.figures.incident for each in judged),
            bound=statistics.fmean(each.figures.bound for each in judged),
            processor_seconds=float(means[cutoff][1]), seconds=float(means[cutoff][0]),
            ratio=float(means[cutoff][1] / means[None][1]),
        )
        for cutoff, judged in maps.items()
    ))  # fmt: skip


def _refuse(stage: Stage) -> None:
    if not stage.shapes or not takes_only_beams(stage):
        raise SceneError(f"stones: expected convex stones of at most {MANY} facets, whose light beams follow", "stones")
    if not mapped_surfaces(stage) or not any(ray.follows for ray in rays_of(stage, 0)):
        raise SceneError(
            "floor: expected a matte floor or wall under a point light, or a lamp of at most 1 degree, with caustics "
            "on; nothing of this scene throws light onto one", "floor",
        )  # fmt: skip


@dataclass(frozen=True)
class _Judged:
    """One map."""

    error: float
    of_map: float
    figures: Figures


def _judged(renderer: Renderer, stage: Stage, cutoffs: Sequence[float]) -> Iterator[tuple[float, _Judged]]:
    converged, _ = _thrown(renderer, stage, CONVERGED)
    shadows, _ = _thrown(renderer, _with(stage, None), CONVERGED)
    caustics, whole = rms(converged - shadows), rms(converged)
    for cutoff in cutoffs:
        made, figures = _thrown(renderer, stage, cutoff)
        apart = rms(made - converged)
        yield cutoff, _Judged(apart / caustics, apart / whole, figures)


def _thrown(renderer: Renderer, stage: Stage, cutoff: float) -> tuple[Array, Figures]:
    """The map of a moving frame."""
    frame = frame_of(stage)
    target = cl.Buffer(renderer.device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    beams = renderer.lighting.passes.take_beams()
    figures = beams.make(stage, rays_of(stage, 0, moving=True), frame, target, cutoff=cutoff)
    renderer.lighting.passes.give_back(beams)
    made = np.empty(frame.shape, np.float32)
    cl.enqueue_copy(renderer.device.queue, made, target)
    return made[list(frame.matte)].astype(np.float64), figures


def _timed(
    renderer: Renderer, stage: Stage, size: tuple[int, int], cutoffs: Sequence[float | None], repeats: int
) -> dict[float | None, tuple[float, float]]:
    """Seconds by the clock and of all cores, medians; frames of all cut-offs in turns."""
    walls: dict[float | None, list[float]] = {key: [] for key in cutoffs}
    processors: dict[float | None, list[float]] = {key: [] for key in cutoffs}
    for number in range(repeats + 1):
        for key in cutoffs:
            shown = _with(stage, key)
            renderer.lighting.forget()
            wall, processor = time.perf_counter(), time.process_time()
            picture = renderer.picture(shown, *size, effort=LightEffort.MOVING)
            picture.refine(1)
            picture.rgb()
            if number > 0:  # the first ones are compiled, and warm
                walls[key].append(time.perf_counter() - wall)
                processors[key].append(time.process_time() - processor)
    return {key: (statistics.median(walls[key]), statistics.median(processors[key])) for key in cutoffs}


def _with(stage: Stage, cutoff: float | None) -> Stage:
    """With that cut-off; with shadows alone for None."""
    changes: dict[str, object] = {"caustics": "off"} if cutoff is None else {"caustics_cutoff": cutoff}
    scene: Scene = stage.scene
    return stage.showing(scene.model_copy(update={"optics": scene.optics.model_copy(update=changes)}))


def table(found: CutOffSweep) -> Table:
    """A row for each cut-off."""
    rows = Table("cut-off", box=box.SIMPLE_HEAD)
    for name in (
        "error / rms",
        "worst",
        "of the whole map's",
        "light cut",
        "strict bound",
        "processor ms",
        "ms",
        "ratio",
    ):
        rows.add_column(name, justify="right")
    rows.add_row("shadows alone", "1", "", "", "", "", f"{1e3 * found.shadows_alone:.1f}", "", "1")
    for each in found.cutoffs:
        shares = (each.error, each.worst, each.of_map, each.cut, each.bound)
        rows.add_row(
            f"{each.cutoff:g}", *(f"{share:.3f}" for share in shares), f"{1e3 * each.processor_seconds:.1f}",
            f"{1e3 * each.seconds:.1f}", f"{each.ratio:.2f}",
        )  # fmt: skip
    return rows
