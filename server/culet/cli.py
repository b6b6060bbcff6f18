"""The command line. What a command needs is imported by the command, so that `--help` answers at once."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any

import typer

from culet.command.design import design_app
from culet.command.help import ListedHelp
from culet.command.options import MeshFile, Preset, SceneFile, SkyFile
from culet.command.places import opened
from culet.command.settings import options_of
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, progress_bar, report_console
from culet.endpoints import check_trusted
from culet.engine.process.limits import Limits
from culet.gateway.settings import GatewaySettings
from culet.logs import configure
from culet.places import check_place
from culet.scene.film import MOST_SAMPLES
from culet.settings import Settings
from culet.study.command import study_app
from culet.version import __version__

app = typer.Typer(
    no_args_is_help=True,
    add_completion=False,
    pretty_exceptions_enable=False,
)

PROGRESS_SECONDS = 0.1
"""Between two looks at the progress bar."""

Control = Annotated[str, typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of control, ipc://... or tcp://...")]
Frames = Annotated[str, typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of frames, ipc://... or tcp://...")]
Endpoint = Annotated[str, typer.Argument(help="Where the engine publishes frames, such as tcp://127.0.0.1:5556.")]
SessionId = Annotated[
    str | None, typer.Option(help="The session's id, 32 hexadecimal digits; the page has it in its address.")
]
WatchId = Annotated[
    str | None, typer.Option(help="The session's watch id, in place of its id; `POST /api/sessions` gives it.")
]
Folder = Annotated[Path, typer.Option("-o", "--out", metavar="FOLDER", help="Folder for the frames; made if missing.")]
Spare = Annotated[
    bool,
    typer.Option(
        envvar="CULET_SPARE",
        help="Keep another one ready to take over when it dies or hangs; a small process of their own watches both.",
    ),
]
Patience = Annotated[float, typer.Option(min=0.1, help="Seconds to wait for a frame before giving up.")]


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"culet {__version__}")
        raise typer.Exit


@app.callback()
def culet(
    _version: Annotated[
        bool, typer.Option("--version", is_eager=True, callback=_print_version, help="Print the version and exit.")
    ] = False,
) -> None:
    """Dispersive gemstones, traced exactly on the processor and streamed to thin clients."""


@app.command()
def render(
    scene: SceneFile = None,
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FILE", help="Picture: .png .jpg .webp .tga, or linear: .exr .npy")
    ] = Path("out.png"),
    width: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 640,
    height: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 360,
    samples: Annotated[
        int | None,
        typer.Option(
            min=1, max=MOST_SAMPLES, help="Samples per pixel, with --error at most; without either the scene's."
        ),
    ] = None,
    error: Annotated[
        float | None,
        typer.Option(
            metavar="RMSE",
            help="Take samples until what is shown, from 0 to 1, is estimated to be off by this (root mean square over "
            "pixels and colours); from 0.004 on no difference is seen.",
        ),
    ] = None,
    preset: Preset = None,
    mesh: MeshFile = None,
    sky: SkyFile = None,
) -> None:
    """Render a still picture into a file."""
    from culet.rendering.files import FORMATS
    from culet.stills import render_stage

    with errors_in_one_line():
        check_place(out, "out", FORMATS)
        stage = read_stage(scene, preset, mesh, sky)
        with progress_bar(f"rendering {out.name}") as advance:
            picture = render_stage(stage, width, height, samples=samples, error=error, progress=advance)
        picture.save(out)
        typer.echo(f"{out}: {width} x {height}, {picture.quality()}")


@app.command()
def simulate(
    scene: SceneFile = None,
    seconds: Annotated[float, typer.Option(min=0, help="Simulated time.")] = 5,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="The stones' paths: .csv .json .npz")] = Path(
        "path.csv"
    ),
    preset: Preset = None,
    mesh: MeshFile = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw height, energy and angular speed over time too: .png")
    ] = None,
) -> None:
    """Let the stones fall and write their paths, step by step: position, orientation, velocities, energy, contacts.

    A stone that stands on the floor is lifted to y = 1.5 first, several stones all together.
    """
    from culet.falls import simulate_stage
    from culet.simulation.paths import ENDINGS

    with errors_in_one_line():
        check_place(out, "out", ENDINGS)
        if plot is not None:
            check_place(plot, "plot", ["png"])
        stage = read_stage(scene, preset, mesh)
        with progress_bar("simulating") as advance:
            motion = simulate_stage(stage, seconds, progress=advance)
        motion.save(out)
        if plot is not None:
            from culet.simulation.plot import plot as draw

            draw(motion.path, plot)
        typer.echo(f"{out}: {len(motion.time)} states, {motion.time[-1]:g} s")


@app.command()
def bench(
    width: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 1280,
    height: Annotated[int, typer.Option(min=1, max=8192, help="Pixels.")] = 720,
    repeats: Annotated[int, typer.Option(min=1, max=1000, help="Frames of each scene; the median counts.")] = 9,
    features: Annotated[
        bool, typer.Option("--features", help="Also what each feature of a scene costs: absent, idle, in use.")
    ] = False,
    light: Annotated[
        bool, typer.Option("--light", help="Also what maps of the light that stones throw cost, and frames with them.")
    ] = False,
    out: Annotated[
        Path | None,
        typer.Option("-o", "--out", metavar="FILE", help="Append the figures and the machine's, one line of JSON."),
    ] = None,
    against: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="Compare with the last line of an earlier file, as ratios; fails on none."),
    ] = None,
) -> None:
    """Measure the time of a frame of named scenes on this machine, the scenes taken in turns."""
    from rich.console import Console

    from culet.rendering.renderer import Renderer
    from culet.study.baseline import doubts, last_line
    from culet.study.bench import measure_cases, measure_features
    from culet.study.bench import record as record_line
    from culet.study.cases import FEATURE_CASES
    from culet.study.light_bench import measure_light
    from culet.study.tables import case_table, feature_table, light_table, print_comparison

    console = report_console()
    with errors_in_one_line(), opened(out) as file:
        baseline = last_line(against) if against is not None else None
        renderer = Renderer()
        with Console(stderr=True).status("measuring"):
            timings = measure_cases(renderer, width, height, repeats)
        console.print(f"{renderer.describe()['device']}, {width} x {height}, one sample a pixel, median of {repeats}")
        console.print(case_table(timings))
        if features:
            costs = []
            with progress_bar("compiling and measuring features") as advance:
                for cost in measure_features(renderer, width, height, repeats):
                    costs.append(cost)
                    advance(len(costs) / len(FEATURE_CASES))
            console.print(feature_table(costs))
        if light:
            with Console(stderr=True).status("measuring light"):
                console.print(light_table(measure_light(renderer, width, height, repeats)))
        line = record_line(renderer, width, height, timings)
        if baseline is not None:
            print_comparison(console, baseline, json.loads(line))
        if file is not None:
            for doubt in doubts(json.loads(line)):
                console.print(f"note: no line to compare others with: {doubt}", soft_wrap=True)
            print(line, file=file)


@app.command(cls=ListedHelp)
@options_of(Gateway=GatewaySettings, Engine=Limits)
def serve(
    frames: Annotated[
        str | None,
        typer.Option(
            metavar="ENDPOINT", help="Publish frames for native viewers here too, such as tcp://127.0.0.1:5556."
        ),
    ] = None,
    spare: Annotated[
        bool,
        typer.Option(
            envvar="CULET_SPARE",
            help="Keep another engine and gateway ready to take over when one dies; they take some 260 MiB of memory.",
        ),
    ] = True,
    *,
    given: dict[str, Any],
) -> None:
    """Serve the web page: gateway and engine, each restarted when it dies. Stop with Ctrl-C."""
    from culet.service.serve import serve as run

    with errors_in_one_line():
        limits = Limits.read(given)  # before the child would complain of them
        configure(limits.log_level, limits.log_format)
        if frames is not None:
            check_trusted(frames, "frames", trusted=limits.trust_network)
        run(given, frames=frames, engine_options=[*Limits.words(given)], spare=spare)


@app.command(cls=ListedHelp)
@options_of(Gateway=GatewaySettings)
def gateway(control: Control, frames: Frames, spare: Spare = False, *, given: dict[str, Any]) -> None:
    """Run the web process alone, for an engine that runs elsewhere."""
    with errors_in_one_line():
        settings = Settings.read(given)
        configure(settings.log_level, settings.log_format)
        if spare:
            from culet.service.serve import serve_gateway

            serve_gateway(given, control, frames)
        else:
            from culet.gateway.serve import run_gateway

            run_gateway(given, control, frames)


@app.command(cls=ListedHelp)
@options_of(Engine=Limits)
def engine(
    control: Control,
    frames: Annotated[
        list[str], typer.Option(metavar="ENDPOINT", help="ZeroMQ endpoint of frames; repeatable, for several at once.")
    ],
    stand_by: Annotated[
        bool, typer.Option("--stand-by", help="Get ready, and begin with a line on the standard input.")
    ] = False,
    spare: Spare = False,
    *,
    given: dict[str, Any],
) -> None:
    """Run the render process alone: sessions, simulation and frames over ZeroMQ."""
    with errors_in_one_line():
        limits = Limits.read(given)
        configure(limits.log_level, limits.log_format)
        for option, endpoint in (("control", control), *(("frames", endpoint) for endpoint in frames)):
            check_trusted(endpoint, option, trusted=limits.trust_network)
        if spare and not stand_by:  # one that stands by has the same environment
            from culet.service.serve import serve_engine

            serve_engine(control, frames, [*Limits.words(given)])
        else:
            from culet.engine.process.serve import run

            run(control, frames, limits, stand_by=stand_by)


@app.command()
def view(
    endpoint: Endpoint,
    session: SessionId = None,
    watch: WatchId = None,
    frames: Annotated[int, typer.Option(min=1, help="How many frames to take.")] = 10,
    out: Folder = Path("frames"),
    timeout: Patience = 10,
) -> None:
    """Take the latest frames of a session, straight from the engine, into a folder."""
    from culet_client.view import view as view_frames

    with errors_in_one_line(), _watched(session, watch) as watched:
        count = view_frames(endpoint, watched, frames, out, timeout_seconds=timeout)
        typer.echo(f"{out}: {count} frames")


@app.command()
def record(
    endpoint: Endpoint,
    session: SessionId = None,
    watch: WatchId = None,
    seconds: Annotated[float, typer.Option(min=0, help="How long, counted from the first frame.")] = 10,
    out: Folder = Path("frames"),
    timeout: Patience = 10,
) -> None:
    """Take every frame of a session that comes in some seconds, straight from the engine, into a folder."""
    from culet_client.view import record as record_frames

    with errors_in_one_line(), _watched(session, watch) as watched:
        count = record_frames(endpoint, watched, seconds, out, timeout_seconds=timeout)
        typer.echo(f"{out}: {count} frames")


@contextmanager
def _watched(session: str | None, watch: str | None) -> Iterator[str]:
    """The watch id of what the user named; that none of its frames came is said of the session that was named."""
    from culet_client.errors import ClientError, SilenceError
    from culet_protocol.watch import watch_id

    if (session is None) == (watch is None):
        raise ClientError("expected --session or --watch, got both or neither")
    if watch is not None:
        yield watch
        return
    if session is None or not re.fullmatch("[0-9a-f]{32}", session):
        raise ClientError(f"a session's id has 32 hexadecimal digits, got {session!r}")
    try:
        yield watch_id(session)
    except SilenceError as error:
        raise SilenceError(f"session {session}: {error}") from error


app.add_typer(study_app, name="study")
app.add_typer(design_app, name="design")
