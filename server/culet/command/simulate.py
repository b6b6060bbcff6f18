"""`culet simulate`."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from culet.command.options import MeshFile, PresetOption, SceneFile
from culet.command.single import single_command
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, progress_bar
from culet.places import check_place

app = single_command()


@app.command()
def simulate(
    scene: SceneFile = None,
    seconds: Annotated[float, typer.Option(min=0, help="Simulated time.")] = 5,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="FILE", help="The stones' paths: .csv .json .npz")] = Path(
        "path.csv"
    ),
    preset: PresetOption = None,
    mesh: MeshFile = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Draw height, energy and angular speed over time too: .png")
    ] = None,
) -> None:
    """Let the stones fall and write their paths, step by step: position, orientation, velocities, energy, contacts.

    A stone that stands on the floor is lifted to y = 1.5 first, several stones all together.
    """
    from culet.falls import simulate_stage
    from culet.simulation.recording.paths import ENDINGS

    with errors_in_one_line():
        check_place(out, "out", ENDINGS)
        if plot is not None:
            check_place(plot, "plot", ["png"])
        stage = read_stage(scene, preset, mesh)
        with progress_bar("simulating") as advance:
            motion = simulate_stage(stage, seconds, progress=advance)
        motion.save(out)
        if plot is not None:
            from culet.simulation.recording.plot import plot as draw

            draw(motion.path, plot)
        typer.echo(f"{out}: {len(motion.time)} states, {motion.time[-1]:g} s")
