"""`culet animate`."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.command.crew import Scheduler, TlsCa, TlsCert, TlsKey, Workers, crew_of
from culet.command.options import CutText, MeshFile, PresetOption, SceneFile, SkyFile
from culet.command.single import single_command
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, progress_bar
from culet.errors import InputError
from culet.scene.film import MOST_SAMPLES

if TYPE_CHECKING:
    from culet.batch.animation import Animation
    from culet.batch.crew import Crew
    from culet.stage import Stage

app = single_command()

SECONDS = 4.0


@app.command()
def animate(
    scene: SceneFile = None,
    out: Annotated[
        Path,
        typer.Option(
            "-o",
            "--out",
            metavar="FOLDER|FILM.mp4",
            help="Folder of the frames, made if missing; or a film, whose frames are kept in FILM.frames beside it.",
        ),
    ] = Path("frames"),
    turntable: Annotated[bool, typer.Option("--turntable", help="The camera goes once around the stones.")] = False,
    fall: Annotated[bool, typer.Option("--fall", help="The stones fall, as of culet simulate.")] = False,
    path: Annotated[
        Path | None,
        typer.Option(
            metavar="CAMERAS.json",
            help="The camera passes these: a list of objects with any of position, target, up, fov_degrees, height, "
            "and time (s) of all or none.",
        ),
    ] = None,
    seconds: Annotated[float, typer.Option(min=0.001, help="Of the film.")] = SECONDS,
    fps: Annotated[float, typer.Option("--fps", min=0.1, max=1000, help="Frames a second.")] = 30,
    width: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 640,
    height: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 360,
    samples: Annotated[
        int | None, typer.Option(min=1, max=MOST_SAMPLES, help="Samples per pixel, with --error at most.")
    ] = None,
    error: Annotated[
        float | None, typer.Option(metavar="RMSE", help="Each frame to this error as shown, as of culet render.")
    ] = None,
    image: Annotated[str, typer.Option("--format", metavar="png|webp|jpg|tga|exr|npy", help="Of the frames.")] = "png",
    preset: PresetOption = None,
    mesh: MeshFile = None,
    sky: SkyFile = None,
    cut: CutText = None,
    workers: Workers = None,
    scheduler: Scheduler = None,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Render anew what an earlier run has left there.")] = False,
) -> None:
    """Render an animation, frame by frame.

    Stopped with Ctrl-C, the same command goes on where it was; frames are there whole or not at all. With --workers, or
    the workers of a --scheduler, they are the same, bit for bit.
    """
    from culet.batch.animation import Animation, times_of
    from culet.batch.film import check_film, write_film
    from culet.rendering.film.files import FORMATS

    with errors_in_one_line():
        if turntable + fall + (path is not None) != 1:
            raise InputError("expected one of --turntable, --fall and --path", "turntable")
        if image not in FORMATS:
            raise InputError(f"format: expected one of {', '.join(FORMATS)}; got {image!r:.20}", "format")
        film = out.suffix.lower() == ".mp4"
        if film:
            check_film(out, fps, image)
        elif out.is_file():
            raise InputError(f"out: expected a folder, got the file {out}", "out")
        times = times_of(seconds, fps)
        stage = read_stage(scene, preset, mesh, sky, cut)
        stages = _stages(stage, times, seconds, fall=fall, path=path)
        frames = Animation(stages, width, height, samples, error, image)
        folder = out.with_suffix(".frames") if film else out
        with crew_of(workers, scheduler, tls_ca, tls_cert, tls_key) as crew:
            _render(frames, folder, crew, fresh=fresh)
        if film:
            with progress_bar(f"encoding {out.name}") as advance:
                write_film(frames, folder, out, fps, advance)
        typer.echo(f"{out}: {len(stages)} frames of {width} x {height}")


def _stages(stage: Stage, times: list[float], seconds: float, *, fall: bool, path: Path | None) -> tuple[Stage, ...]:
    from culet.batch import animation
    from culet.batch.cameras import Way
    from culet.sources import naming, parse_json

    if fall:
        with progress_bar("simulating") as advance:
            return animation.fall(stage, times, advance)
    if path is None:
        return animation.turntable(stage, times)
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"path: {path} cannot be read: {error.strerror}", "path") from error
    with naming(str(path)):
        return animation.on_a_way(stage, Way.read(parse_json(data)), seconds, times)


def _render(frames: Animation, folder: Path, crew: Crew, *, fresh: bool) -> None:
    from culet.batch.animation import render_frames

    steps = render_frames(frames, folder, fresh=fresh, crew=crew)
    with closing(steps), progress_bar(f"rendering {folder.name}") as advance:
        for done in steps:
            advance(done)
