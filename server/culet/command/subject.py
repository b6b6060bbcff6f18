"""What a command judges: a scene, a design, a mesh or a cut, by what the user calls it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from culet.command.stage import read_stage
from culet.errors import SceneError

if TYPE_CHECKING:
    from culet.grading.rules import Rules
    from culet.stage import Stage

Subject = Annotated[
    str | None,
    typer.Argument(
        metavar="[SCENE.json|DESIGN|MESH|CUT]",
        help="Scene, design (.asc .gem .gcs) or mesh; or a cut, as emerald,length_to_width=1.6; without one the "
        "default scene.",
    ),
]
StoneOption = Annotated[str | None, typer.Option("--stone", metavar="ID", help="Which stone; without it the first.")]
MaterialOption = Annotated[str | None, typer.Option(metavar="NAME", help="In place of the stone's own.")]
IndexOption = Annotated[
    float | None,
    typer.Option(min=1.0, max=10.0, help="Refractive index, in place of a material; then there is no fire."),
]
HeadOption = Annotated[
    float | None, typer.Option(min=0.0, max=90.0, help="Half the angle of the viewer's head, degrees; 10.")
]
RulesName = Annotated[
    str, typer.Option("--as", metavar="culet|gemray", help="By whose rules: gemray follows ten facets alone.")
]
Coloured = Annotated[
    bool, typer.Option("--coloured", help="Count what the material absorbs at 589.3 nm; else the stone is clear.")
]
GradeError = Annotated[
    float, typer.Option(min=0.001, max=10.0, metavar="POINTS", help="Twice the standard error of ISO.")
]


def rules_named(name: str, head_degrees: float | None) -> Rules:
    """The rules of that name; SceneError for one that there is not."""
    from culet.grading.rules import rules_of

    match name:
        case "culet" | "gemray":
            return rules_of(name, head_degrees)
        case _:
            raise SceneError(f"as: expected culet or gemray, got {name!r:.40}", "as")


def subject(what: str | None, preset: str | None) -> Stage:
    """The stage; InputError says what cannot be used."""
    from culet.scene.cuts import CUTS

    if what is not None and what.partition(",")[0] in CUTS and not Path(what).exists():
        return read_stage(None, preset, None, None, what)
    if what is None or what == "-" or what.lower().endswith(".json"):
        return read_stage(None if what is None else Path(what), preset, None)
    return read_stage(None, preset, Path(what))


def with_material(stage: Stage, name: str | None, index: float | None) -> Stage:
    """The stage with its stones of that material or index, if one is given; SceneError for both."""
    from culet.scene import Scene

    if name is not None and index is not None:
        raise SceneError("expected a material or an index, got both", "material")
    if name is None and index is None:
        return stage
    changed: dict[str, Any] = {"material": name if name is not None else {"ior": [index] * 3}}
    data = stage.scene.model_dump(mode="json")
    data["stones"] = [each | changed for each in data["stones"]]
    return stage.showing(Scene.read(data))
