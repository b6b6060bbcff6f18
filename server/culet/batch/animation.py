"""Animations: every frame a still like any other, in a file of its own, and a journal that lets them be resumed."""

from __future__ import annotations

import hashlib
import math
from collections.abc import Generator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from culet.batch.cameras import Way, along
from culet.batch.crew import IN_PROCESS, Crew, in_turn
from culet.batch.digest import identity_of, motion_of
from culet.errors import InputError
from culet.falls import simulate_stage
from culet.journal import Journal
from culet.places import write_whole
from culet.rendering.film.files import FORMATS
from culet.scene import Scene
from culet.scene.turntable import around
from culet.stage import Stage
from culet.stills import Progress, render_stage
from culet.version import __version__

JOURNAL = "frames.journal"
MOST_FRAMES = 100_000


@dataclass(frozen=True, eq=False)
class Animation:
    """Frames, and how well each is rendered."""

    stages: tuple[Stage, ...]
    width: int
    height: int
    samples: int | None = None
    error: float | None = None
    """As of a still: see `culet.render`."""
    format: str = "png"

    def identity(self) -> dict[str, Any]:
        """What of another animation is different; all of one have the shapes and the sky of its first frame."""
        return {
            "animation": __version__, "frames": len(self.stages), "width": self.width, "height": self.height,
            "samples": self.samples, "error": self.error, "format": self.format, **identity_of(self.stages[0]),
            "motion": motion_of([stage.scene for stage in self.stages]),
        }  # fmt: skip

    def task(self) -> FrameTask:
        """Renders them."""
        return FrameTask(self.stages[0], self.width, self.height, self.samples, self.error, self.format)

    def file(self, folder: Path, number: int) -> Path:
        """Of a frame, counted from 0."""
        return folder / f"frame-{number + 1:06}.{self.format}"


def times_of(seconds: float, frames_per_second: float) -> list[float]:
    """s, of each frame; InputError for none, or too many."""
    asked = seconds * frames_per_second
    count = round(asked) if math.isfinite(asked) else 0
    if not 1 <= count <= MOST_FRAMES:
        raise InputError(
            f"seconds: expected 1 to {MOST_FRAMES} frames, got {asked:.0f} of {seconds:g} s at {frames_per_second:g}",
            "seconds",
        )
    return [number / frames_per_second for number in range(count)]


def turntable(stage: Stage, times: Sequence[float]) -> tuple[Stage, ...]:
    """Once around the vertical through the camera's target."""
    return tuple(stage.showing(scene) for scene in around(stage.scene, len(times)))


def fall(stage: Stage, times: Sequence[float], progress: Progress | None = None) -> tuple[Stage, ...]:
    """The stones let go, as `culet simulate` has them fall."""
    motion = simulate_stage(stage, times[-1], progress=progress)
    return tuple(stage.showing(motion.scene_at(time)) for time in times)


def on_a_way(stage: Stage, way: Way, seconds: float, times: Sequence[float]) -> tuple[Stage, ...]:
    """The camera on its way; SceneError where it would look nowhere."""
    cameras = along(way, stage.scene.camera, seconds, times)
    return tuple(stage.showing(stage.scene.model_copy(update={"camera": camera})) for camera in cameras)


@dataclass(frozen=True)
class RenderedFrame:
    """A rendered frame."""

    data: bytes
    """Its file."""
    samples: int
    seconds: float
    """s of rendering."""


@dataclass(frozen=True, eq=False)
class FrameTask:
    """Renders frames of an animation, by their numbers and scenes."""

    stage: Stage
    """Whose shapes and sky all have."""
    width: int
    height: int
    samples: int | None
    error: float | None
    format: str

    def __call__(self, item: tuple[int, Scene]) -> RenderedFrame:
        """The still of that scene."""
        stage = self.stage.showing(item[1])
        picture = render_stage(stage, self.width, self.height, samples=self.samples, error=self.error)
        return RenderedFrame(picture.encoded(self.format), picture.cost.samples, picture.cost.seconds)


def render_frames(
    animation: Animation, folder: Path, *, fresh: bool = False, crew: Crew = IN_PROCESS
) -> Generator[float, None, None]:
    """Have every frame rendered into the folder; the part done, now and then.

    Frames that the journal of the same animation has, and that are there as they were written, are kept. InputError for
    a folder that cannot be written to, or that has another animation.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise InputError(f"out: cannot make the folder {folder}: {error.strerror}", "out") from error
    count = len(animation.stages)
    with Journal(folder / JOURNAL, animation.identity(), kind="animation", fresh=fresh, anew="render anew") as journal:
        if fresh:
            _forget_frames(folder)
        there = whole(animation, folder, journal.records)
        yield len(there) / count
        missing = [(number, animation.stages[number].scene) for number in range(count) if number not in there]
        with closing(crew.results(animation.task(), in_turn(missing))) as done:
            for (number, _), frame in done:
                journal.append(write_frame(animation, folder, number, frame))
                there.add(number)
                yield len(there) / count


def _forget_frames(folder: Path) -> None:
    """Those of another animation may be more than this one's."""
    for file in folder.glob("frame-[0-9][0-9][0-9][0-9][0-9][0-9].*"):
        if file.suffix.lstrip(".") in FORMATS:
            file.unlink()


def whole(animation: Animation, folder: Path, records: Sequence[Any]) -> set[int]:
    """Numbers of the frames that are there as the journal has them."""
    written = [record for record in records if isinstance(record, dict) and {"frame", "sha256"} <= record.keys()]
    numbers = range(len(animation.stages))
    digests = {record["frame"]: record["sha256"] for record in written if record["frame"] in numbers}
    found = set()
    for number, digest in digests.items():
        file = animation.file(folder, number)
        if file.is_file() and hashlib.sha256(file.read_bytes()).hexdigest() == digest:
            found.add(number)
    return found


def write_frame(animation: Animation, folder: Path, number: int, frame: RenderedFrame) -> dict[str, Any]:
    """Whole or not at all; its record for the journal."""
    write_whole(animation.file(folder, number), frame.data, "out")
    return {
        "frame": number, "sha256": hashlib.sha256(frame.data).hexdigest(), "samples": frame.samples,
        "seconds": round(frame.seconds, 4),
    }  # fmt: skip
