"""`culet sweep`."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path
from typing import Annotated

import typer

from culet.command.crew import Scheduler, TlsCa, TlsCert, TlsKey, Workers, crew_of
from culet.command.options import PresetOption
from culet.command.single import single_command
from culet.command.subject import (
    Coloured,
    GradeError,
    HeadOption,
    IndexOption,
    MaterialOption,
    RulesName,
    StoneOption,
    Subject,
    rules_named,
    subject,
    with_material,
)
from culet.command.terminal import errors_in_one_line, progress_bar
from culet.places import check_place
from culet.scene.film import MOST_SAMPLES

app = single_command()


@app.command()
def sweep(
    what: Subject = None,
    preset: PresetOption = None,
    vary: Annotated[
        list[str] | None,
        typer.Option(
            metavar="FIELD=FROM:TO:STEP",
            help="Field of the scene, or of its first stone, as cut.crown_degrees=30:36:0.5 or material=diamond,ruby; "
            "given several times, all combinations.",
        ),
    ] = None,
    metric: Annotated[
        list[str] | None,
        typer.Option(
            metavar="NAME",
            help="What is measured: any grade, as iso, fire, leak or contrast; radiance (mean, of the stone), error or "
            "seconds of a picture. iso without one.",
        ),
    ] = None,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE.csv", help="Table to write.")] = Path("sweep.csv"),
    stone: StoneOption = None,
    material: MaterialOption = None,
    index: IndexOption = None,
    head: HeadOption = None,
    rules: RulesName = "culet",
    coloured: Coloured = False,
    error: GradeError = 0.1,
    width: Annotated[int, typer.Option(min=1, max=8192, help="Pixels of pictures.")] = 320,
    height: Annotated[int, typer.Option(min=1, max=8192, help="Pixels of pictures.")] = 180,
    samples: Annotated[int, typer.Option(min=2, max=MOST_SAMPLES, help="Samples per pixel of pictures.")] = 16,
    workers: Workers = None,
    scheduler: Scheduler = None,
    tls_ca: TlsCa = None,
    tls_cert: TlsCert = None,
    tls_key: TlsKey = None,
    fresh: Annotated[bool, typer.Option("--fresh", help="Forget what an earlier sweep has left there.")] = False,
) -> None:
    """Measure a scene while fields of it vary, into a table.

    Stopped with Ctrl-C, the same command goes on where it was. Scenes that cannot be have their reason in the table.
    """
    from culet.batch.metrics import MetricEffort, check_metrics
    from culet.batch.sweep import Sweep, run
    from culet.batch.variation import variation
    from culet.errors import InputError

    with errors_in_one_line():
        check_place(out, "out", ["csv"])
        if not vary:
            raise InputError("vary: expected at least one FIELD=FROM:TO:STEP, got none", "vary")
        metrics = tuple(metric or ["iso"])
        check_metrics(metrics)
        variations = tuple(variation(text) for text in vary)
        stage = with_material(subject(what, preset), material, index)
        effort = MetricEffort(rules_named(rules, head), error, stone, coloured, width, height, samples)
        done = already = 0
        with crew_of(workers, scheduler, tls_ca, tls_cert, tls_key) as crew:
            steps = run(Sweep(stage, variations, metrics, effort), out, fresh=fresh, crew=crew)
            with closing(steps), progress_bar(f"sweeping {out.name}") as advance:
                for number, (done, count) in enumerate(steps):
                    already = already if number else done
                    advance(done / count)
        earlier = f", {already} of them measured before" if already else ""
        typer.echo(f"{out}: {done} points{earlier}")
