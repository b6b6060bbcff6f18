"""`culet bench`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.command.places import opened
from culet.command.single import single_command
from culet.command.terminal import errors_in_one_line, progress_bar, report_console
from culet.errors import CuletError

if TYPE_CHECKING:
    from rich.console import Console

app = single_command()


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
    profile: Annotated[
        bool,
        typer.Option(
            "--profile",
            help="Instead, where the processor time of a moving frame goes, of a stone and of twelve: by stage, beside "
            "the work that was counted, and its share of the machine's measured limit.",
        ),
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
    from culet.study.bench.baseline import doubts, last_line
    from culet.study.bench.bench import measure_cases, measure_features
    from culet.study.bench.bench import record as record_line
    from culet.study.bench.cases import FEATURE_CASES
    from culet.study.bench.light_bench import measure_light
    from culet.study.bench.tables import case_table, feature_table, light_table, print_comparison

    console = report_console()
    if profile:
        with errors_in_one_line():
            _profile(console, width, height, repeats, alone=not (features or light or out or against))
        return
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


def _profile(console: Console, width: int, height: int, repeats: int, *, alone: bool) -> None:
    from culet.rendering.renderer import Renderer
    from culet.study.bench.cases import CASES
    from culet.study.bench.profile import FLOPS_PER_INSTRUCTION, PROFILED, measure_profile
    from culet.study.bench.tables import profile_table

    if not alone:
        raise CuletError("expected --profile by itself, or with --width, --height and --repeats")
    renderer = Renderer()
    device = renderer.describe()["device"]
    console.print(f"{device}, {width} x {height}, a frame while stones move, median of {repeats}, processor time")
    for found in measure_profile(renderer, {name: CASES[name] for name in PROFILED}, width, height, repeats):
        console.print(profile_table(found))
    limits = found.limits
    console.print(
        f"limits, of one processor: {limits.single_flops / FLOPS_PER_INSTRUCTION / 1e9:.1f} G multiply-adds a second, "
        f"each of one lane; {limits.bandwidth_per_second / 1e9:.1f} GB/s copied (read and written). Of tracing, the "
        "search for facets alone is counted.",
        soft_wrap=True,
    )
