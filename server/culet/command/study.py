"""`culet study`: error against run time, on the machine at hand. What a command needs is imported by the command."""

from __future__ import annotations

import asyncio
import contextlib
import math
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from culet.command.options import MeshFile, PresetOption, SceneFile, SkyFile
from culet.command.places import opened
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, progress_bar, report_console
from culet.errors import SceneError
from culet.scene.film import MOST_SAMPLES

if TYPE_CHECKING:
    from culet.study.findings.comparison import Difference
    from culet.study.measuring import Study
    from culet.study.report import Report

app = typer.Typer(
    help="Measure what each approximation costs and what it saves; reports as HTML, JSON and CSV.",
    no_args_is_help=True,
    add_completion=False,
)

Out = Annotated[Path, typer.Option("-o", "--out", metavar="FOLDER", help="Folder of the report; made if missing.")]
Quick = Annotated[bool, typer.Option("--quick", help="Fewer settings and samples, a smaller picture.")]
Fresh = Annotated[bool, typer.Option("--fresh", help="Measure anew what an earlier run has left in the folder.")]
WidthOption = Annotated[int | None, typer.Option(min=16, max=4096, help="Pixels; without it 640, quick 320.")]
HeightOption = Annotated[int | None, typer.Option(min=16, max=4096, help="Pixels; without it 360, quick 180.")]
ReportFile = Annotated[Path, typer.Argument(metavar="REPORT.json", help="A report.json of a study.")]
BenchFile = Annotated[Path, typer.Argument(metavar="BENCH.jsonl", help="A file of `culet bench -o`.")]

SHOWN_RATIOS = 20
"""Of a comparison: those that changed most."""


@app.command()
def rendering(
    scene: SceneFile = None,
    out: Out = Path("report/rendering"),
    preset: PresetOption = None,
    mesh: MeshFile = None,
    sky: SkyFile = None,
    quick: Quick = False,
    fresh: Fresh = False,
    width: WidthOption = None,
    height: HeightOption = None,
) -> None:
    """Sweep the renderer's knobs against converged references in double precision.

    Stopped with Ctrl-C it goes on where it was when it is started again.
    """
    _measure("rendering", (scene, preset, mesh, sky), out, quick=quick, fresh=fresh, size=(width, height))


@app.command()
def simulation(
    scene: SceneFile = None,
    out: Out = Path("report/simulation"),
    preset: PresetOption = None,
    mesh: MeshFile = None,
    quick: Quick = False,
    fresh: Fresh = False,
) -> None:
    """Sweep integrators and step sizes on motions whose truth is known."""
    _measure("simulation", (scene, preset, mesh), out, quick=quick, fresh=fresh)


@app.command()
def streaming(
    scene: SceneFile = None,
    out: Out = Path("report/streaming"),
    preset: PresetOption = None,
    mesh: MeshFile = None,
    sky: SkyFile = None,
    quick: Quick = False,
    fresh: Fresh = False,
    width: WidthOption = None,
    height: HeightOption = None,
) -> None:
    """Sweep codecs and qualities on moving and still frames."""
    _measure("streaming", (scene, preset, mesh, sky), out, quick=quick, fresh=fresh, size=(width, height))


@app.command()
def caustics(
    scene: SceneFile = None,
    out: Out = Path("report/caustics"),
    preset: PresetOption = None,
    mesh: MeshFile = None,
    quick: Quick = False,
    fresh: Fresh = False,
) -> None:
    """Sweep the cut-off of the light that the stones throw onto a matte floor, beside photons of the same program.

    The light is a point's, then a sun's; the scene's own is out. Stopped with Ctrl-C it goes on where it was.
    """
    _measure("caustics", (scene, preset, mesh), out, quick=quick, fresh=fresh)


@app.command()
def light(
    scene: SceneFile = None,
    preset: PresetOption = None,
    mesh: MeshFile = None,
    poses: Annotated[int, typer.Option(min=1, max=1000, help="In which the stones are turned, at random.")] = 16,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Pixels of a frame.")] = 960,
    height: Annotated[int, typer.Option(min=16, max=4096, help="Pixels of a frame.")] = 540,
    cutoff: Annotated[
        list[float] | None,
        typer.Option(min=1e-6, max=1, help="Of the light, several times for several; by default 3e-3 to 1e-4."),
    ] = None,
    repeats: Annotated[int, typer.Option(min=1, max=100, help="Frames of each cut-off and pose.")] = 3,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="JSON of all figures.")] = None,
) -> None:
    """Sweep the cut-off of the light that stones throw in a moving frame: its error and what is cut of it, against the
    cost of the frame with shadows alone. Without a scene a diamond over a matte floor, under two points and a sun."""
    from culet.rendering.renderer import Renderer
    from culet.stage import Stage
    from culet.study.bench.light_bench import LIT
    from culet.study.light.live_light import CUTOFFS, measure, table

    with errors_in_one_line():
        named = scene is not None or preset is not None or mesh is not None
        stage = read_stage(scene, preset, mesh) if named else Stage.of(LIT)
        with opened(out) as file:
            with progress_bar("measuring") as advance:
                cutoffs = tuple(dict.fromkeys(cutoff)) if cutoff else CUTOFFS
                found = measure(Renderer(), stage, (width, height), cutoffs, poses, repeats, advance)
            if file is not None:
                file.truncate(0)
                file.write(found.document() + "\n")
        report_console().print(table(found))


@app.command()
def resting(
    scene: SceneFile = None,
    preset: PresetOption = None,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Pixels.")] = 960,
    height: Annotated[int, typer.Option(min=16, max=4096, help="Pixels.")] = 540,
    error: Annotated[
        float, typer.Option(metavar="RMSE", help="Refine to this, as `culet serve --rest-error`.")
    ] = 0.004,
    samples: Annotated[int, typer.Option(min=16, max=MOST_SAMPLES, help="At most, as `--rest-samples`.")] = 256,
    reference: Annotated[int, typer.Option(min=16, max=MOST_SAMPLES, help="Samples of the converged picture.")] = 1024,
    bands: Annotated[
        str | None, typer.Option(metavar="auto|3..64", help="In place of the scene's `optics.bands`.")
    ] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="JSON with every picture.")] = None,
) -> None:
    """Refine a picture at rest as the engine does: how soon is it how good, and is its estimated error right?"""
    from culet.engine.capacity.limits import REST_LEAST
    from culet.rendering.film.target import Target
    from culet.scene.patch import read_patched
    from culet.study.renderer.resting import described, measure, table

    with errors_in_one_line():
        stage = read_stage(scene, preset, None, None)
        if bands is not None:
            stage = stage.showing(read_patched(stage.scene.model_dump(mode="json"), {"optics": {"bands": bands}}))
        with opened(out) as file:
            with progress_bar("rendering") as advance:
                rest = Target(samples, error, least=min(REST_LEAST, samples))
                found = measure(stage, width, height, rest, reference, advance)
            if file is not None:
                file.truncate(0)
                file.write(found.document() + "\n")
        report_console().print(table(found))
        for line in described(found):
            typer.echo(line)


@app.command()
def motion(
    scene: SceneFile = None,
    preset: PresetOption = None,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Pixels of what is seen.")] = 1280,
    height: Annotated[int, typer.Option(min=16, max=4096, help="Pixels of what is seen.")] = 720,
    seconds: Annotated[float, typer.Option(min=0.1, max=60, help="Of the fall.")] = 3,
    moments: Annotated[int, typer.Option(min=1, max=1000, help="Of the fall that are judged.")] = 9,
    reference: Annotated[int, typer.Option(min=2, max=MOST_SAMPLES, help="Samples of the converged pictures.")] = 64,
    dearer: Annotated[
        list[float] | None,
        typer.Option(min=0.1, max=100, help="Judge too what could be held if frames took so many times as long."),
    ] = None,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="JSON of all figures.")] = None,
) -> None:
    """Judge what a viewer sees of a recorded fall against the converged pictures, by FLIP: filtered and not, at equal
    frame rates. Without a scene the preset `falling`."""
    from culet.study.stream.moving_pictures import measure, table

    with errors_in_one_line():
        stage = read_stage(scene, preset or (None if scene else "falling"), None, None)
        with opened(out) as file:
            with progress_bar("judging") as advance:
                found = measure(
                    stage, (width, height), seconds=seconds, moments=moments, samples=reference,
                    dearer=(1.0, *(dearer or ())), progress=advance,
                )  # fmt: skip
            if file is not None:
                file.truncate(0)
                file.write(found.document() + "\n")
        report_console().print(table(found))


@app.command()
def video(
    scene: SceneFile = None,
    preset: PresetOption = None,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Pixels of a frame.")] = 1280,
    height: Annotated[int, typer.Option(min=16, max=4096, help="Pixels of a frame.")] = 720,
    frames: Annotated[int, typer.Option(min=2, max=600, help="Of the fall, 30 a second.")] = 60,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="JSON of all figures.")] = None,
) -> None:
    """Encode a fall as JPEG and as video: bytes, time, PSNR, FLIP, and the fire's colour that is kept. Needs PyAV."""
    import json

    with _errors():
        from culet.rendering.renderer import Renderer
        from culet.study.stream.video_study import described, measure, table

        stage = read_stage(scene, preset, None, None)
        with opened(out) as file:
            with progress_bar("encoding") as advance:
                found = measure(Renderer(), stage.scene, (width, height), frames, advance)
            if file is not None:
                file.truncate(0)
                file.write(json.dumps(found.document(), indent=2) + "\n")
        report_console().print(table(found))
        for line in described(found):
            typer.echo(line)


@app.command()
def growth(out: Out = Path("report/growth"), quick: Quick = False, fresh: Fresh = False) -> None:
    """Fit how cost grows with pixels, facets, bounces, wavelengths, stones, lights, contacts, sessions and viewers.

    Stopped with Ctrl-C it goes on where it was.
    """
    with _errors(), _interruptible(out):
        from culet.study.studies import study_growth

        _tell(study_growth(out, _progress, quick=quick, fresh=fresh), out)


@app.command()
def gallery(
    out: Annotated[
        Path, typer.Option("-o", "--out", metavar="FOLDER", help="Gets gallery.md and its pictures.")
    ] = Path("docs/reference"),
    thumbnails: Annotated[
        Path | None,
        typer.Option(metavar="FOLDER", help="Gets the presets' small pictures too, as the page shows them."),
    ] = None,
) -> None:
    """Draw every preset, and measure whether it looks as it should; fails if one does not."""
    from culet.rendering.renderer import Renderer
    from culet.study.galleries.gallery import ShownPreset, make_thumbnails
    from culet.study.galleries.gallery import gallery as all_presets
    from culet.study.galleries.gallery_page import write_gallery

    with errors_in_one_line():
        renderer, seen = Renderer(), list[ShownPreset]()
        for each in all_presets(renderer):
            typer.echo(f"{each.preset.name}: {', '.join(each.failures) or 'as it should be'}")
            seen.append(each)
        typer.echo(write_gallery(out, seen))
        if thumbnails is not None:
            for file in make_thumbnails(renderer, thumbnails):
                typer.echo(file)
    if any(each.failures for each in seen):
        raise typer.Exit(1)


@app.command()
def cuts(
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FOLDER", help="Gets cuts.md and its pictures.")] = Path(
        "docs/reference"
    ),
) -> None:
    """Draw every cut, and list its proportions."""
    from culet.rendering.renderer import Renderer
    from culet.study.galleries.cut_pages import write_cuts

    with errors_in_one_line():
        for file in write_cuts(out, Renderer()):
            typer.echo(file)


@app.command()
def contacts(
    out: Out = Path("report/contacts"),
    quick: Quick = False,
    fresh: Fresh = False,
    into: Annotated[
        Path | None, typer.Option(metavar="simulation.md", help="Write the table between the marks of this file too.")
    ] = None,
) -> None:
    """Hold several stones to what is known: one by itself, pairs, heaps, extremes, and what they cost.

    Fails if they do not keep to a limit. Stopped with Ctrl-C it goes on where it was when it is started again.
    """
    from culet.study.contacts.table import MARKS, measured, written
    from culet.study.findings.headline import write_into

    with _errors(), _interruptible(out):
        found = measured(out, typer.echo, quick=quick, fresh=fresh)
        text = written(found)
        (out / "contacts.md").write_text(text, encoding="utf-8")
        if into is not None:
            write_into(into, text, MARKS)
        typer.echo(out / "contacts.md")
    if not all(finding.held for finding in found):
        raise typer.Exit(1)


@app.command()
def governor(
    scene: SceneFile = None,
    preset: PresetOption = None,
    seconds: Annotated[float, typer.Option(min=5, help="Of the stones that fall in a scene that stays.")] = 60,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Pixels that the viewer asks for.")] = 1280,
    height: Annotated[int, typer.Option(min=16, max=4096, help="Pixels that the viewer asks for.")] = 720,
    exactness: Annotated[float, typer.Option(min=0, max=1, help="Of the balance: 0 many frames, 1 good ones.")] = 0.5,
    changes: Annotated[bool, typer.Option(help="Change walls, sky, floor and camera afterwards.")] = True,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE", help="JSON with every frame's header.")
    ] = None,
) -> None:
    """Let all stones fall again and again, then change things around them: what does a viewer get, and how soon."""
    from culet.study.serving.governor_study import described, document, measure, rate_of

    with errors_in_one_line():
        stage, size = read_stage(scene, preset, None, None), (width, height)
        if not stage.shapes:
            raise SceneError("stones: expected a scene with a stone, got none: nothing can fall", "stones")
        with opened(out) as file:
            measured = asyncio.run(measure(stage.scene, seconds, size, exactness, changes=changes))
            if file is not None:
                file.truncate(0)
                file.write(document(measured, size, rate_of(exactness)) + "\n")
        typer.echo(described(measured, size, rate_of(exactness)))


@app.command()
def memory(
    scene: SceneFile = None,
    preset: PresetOption = "heap",
    sessions: Annotated[int, typer.Option(min=1, max=256, help="That are watched at a time.")] = 10,
    seconds: Annotated[float, typer.Option(min=2, help="Of falling, and of being refined.")] = 30,
    width: Annotated[int, typer.Option(min=16, max=4096, help="Pixels that each viewer asks for.")] = 960,
    height: Annotated[int, typer.Option(min=16, max=4096, help="Pixels that each viewer asks for.")] = 540,
    final: Annotated[bool, typer.Option(help="Wait until all pictures at rest are as good as they become.")] = True,
    out: Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="JSON with every sample.")] = None,
) -> None:
    """Watch many sessions whose stones fall, anew every 4 s, and then come to rest: how much memory has the engine?"""
    from culet.study.serving.memory_study import described, document, measure

    with errors_in_one_line():
        stage, size = read_stage(scene, None if scene is not None else preset, None, None), (width, height)
        with opened(out) as file:
            measured = asyncio.run(measure(stage.scene, sessions, size, seconds, final=final))
            if file is not None:
                file.truncate(0)
                file.write(document(measured, sessions, size) + "\n")
        typer.echo(described(measured))


@app.command()
def diff(before: ReportFile, after: ReportFile) -> None:
    """Compare two reports of the same study, as ratios after / before."""
    from culet.study.findings.comparison import compare_reports
    from culet.study.report import Report

    with _errors():
        _print_difference(compare_reports(Report.read(before), Report.read(after)))


@app.command("compare-bench")
def compare_bench(before: BenchFile, after: BenchFile) -> None:
    """Compare the last lines of two files of `culet bench -o`, as ratios after / before. Fails on no ratio."""
    from culet.study.bench.baseline import last_line
    from culet.study.bench.tables import print_comparison

    with _errors():
        print_comparison(report_console(), last_line(before), last_line(after))


@app.command()
def headline(
    report: ReportFile,
    into: Annotated[
        Path | None, typer.Option(metavar="study.md", help="Write it between the marks of this file instead.")
    ] = None,
) -> None:
    """Print a report's numbers in short, as a table of a document."""
    from culet.study.findings.headline import headline_markdown, write_into
    from culet.study.report import Report

    with _errors():
        text = headline_markdown(Report.read(report))
        if into is None:
            typer.echo(text, nl=False)
        else:
            write_into(into, text)


def _measure(
    study: Study,
    named: tuple[Path | None, str | None, Path | None] | tuple[Path | None, str | None, Path | None, Path | None],
    out: Path,
    *,
    quick: bool,
    fresh: bool,
    size: tuple[int | None, int | None] = (None, None),
) -> None:
    """Of the stage that the user named: a scene, a preset, a mesh, a sky."""
    from culet.study.measuring import measure_stage

    with _errors(), _interruptible(out):
        width, height = size
        _tell(
            measure_stage(
                study, read_stage(*named), out, _progress, quick=quick, fresh=fresh, width=width, height=height
            ),
            out,
        )


@contextlib.contextmanager
def _errors() -> Iterator[None]:
    from culet.study.measuring import needs_of_studies

    with errors_in_one_line(), needs_of_studies():
        yield


@contextlib.contextmanager
def _interruptible(out: Path) -> Iterator[None]:
    try:
        yield
    except KeyboardInterrupt:
        typer.echo(f"culet: interrupted; what is measured is kept in {out}: the same command goes on", err=True)
        raise typer.Exit(130) from None


@contextlib.contextmanager
def _progress(stage: str, steps: int) -> Iterator[Callable[[str, int], None]]:
    """A bar on a terminal with the time that is left; elsewhere a line a stage."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    console = Console(stderr=True)
    if not console.is_terminal:
        typer.echo(f"{stage}: {steps}", err=True)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeRemainingColumn())
    with Progress(*columns, console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(stage, total=steps)

        def advance(label: str, done: int) -> None:
            bar.update(task, completed=done, description=f"{stage}: {label}" if label else stage)

        yield advance


def _tell(report: Report, out: Path) -> None:
    for line in report.headlines:
        typer.echo(f"{line.name}: {line.value:.3g} {line.unit}")
    for note in report.notes:
        typer.echo(note, err=True)
    typer.echo(f"{out / 'report.html'}: {len(report.points)} points")


def _print_difference(difference: Difference) -> None:
    from culet.study.findings.comparison import medians

    for warning in difference.warnings:
        typer.echo(f"note: {warning}", err=True)
    typer.echo(f"{'median ratio':>14}  figure")
    for name, ratio in medians(difference.ratios).items():
        typer.echo(f"{ratio:14.3f}  {name}")
    changed = [each for each in difference.ratios if each.ratio != 1]
    changed.sort(key=lambda each: -abs(math.log(each.ratio)) if 0 < each.ratio < math.inf else -math.inf)
    typer.echo(f"\n{len(changed)} of {len(difference.ratios)} figures differ; those that changed most:")
    for each in changed[:SHOWN_RATIOS]:
        typer.echo(f"{each.ratio:14.3f}  {each.label}: {each.figure} {each.before:.4g} -> {each.after:.4g}")
    for words, keys in (("before", difference.only_before), ("after", difference.only_after)):
        if keys:
            typer.echo(f"{len(keys)} points only {words}: {', '.join(keys[:3])}{' ...' if len(keys) > 3 else ''}")
