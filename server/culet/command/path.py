"""`culet path`."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict
from typing import TYPE_CHECKING, Annotated, assert_never

import typer

from culet.command.options import CutText, MeshFile, PresetOption, SceneFile, SkyFile
from culet.command.single import single_command
from culet.command.stage import read_stage
from culet.command.terminal import errors_in_one_line, report_console
from culet.errors import SceneError

if TYPE_CHECKING:
    from culet.paths import answer

app = single_command()

CHANNEL_LETTERS = {"red": "R", "green": "G", "blue": "B"}
HEADINGS = (
    "step", "from", "light", "what happens", "angle", "critical", "R s, p, mean", "weight", "length, R", "of the whole",
)  # fmt: skip
MET_WORDS = {
    "sky": "the sky",
    "head": "the observer's head",
    "backdrop": "the backdrop",
    "floor": "the floor",
    "left-wall": "the left wall",
    "middle-wall": "the middle wall",
    "right-wall": "the right wall",
    "cut": "what stands for dropped light",
    "untold": "what was too much to tell",
}
SIDE_WORDS = {
    "above": "overhead",
    "below": "below",
    "left": "at the left",
    "right": "at the right",
    "ahead": "ahead",
    "behind": "behind the viewer",
}


@app.command()
def path(
    scene: SceneFile = None,
    pixel: Annotated[
        str | None, typer.Option(metavar="X,Y", help="Of the picture, from its upper left corner; its middle.")
    ] = None,
    ray: Annotated[
        str | None,
        typer.Option(metavar="X,Y,Z:X,Y,Z", help="Origin and direction in the world, in place of a pixel."),
    ] = None,
    width: Annotated[int, typer.Option(min=1, max=8192, help="Of the picture, pixels.")] = 640,
    height: Annotated[int, typer.Option(min=1, max=8192, help="Of the picture, pixels.")] = 360,
    wavelengths: Annotated[
        str | None, typer.Option(metavar="NM,...", help="Follow these, in place of the scene's own; at most 16.")
    ] = None,
    as_json: Annotated[bool, typer.Option("--json", help="Print all as JSON, as POST /api/path answers.")] = False,
    preset: PresetOption = None,
    mesh: MeshFile = None,
    sky: SkyFile = None,
    cut: CutText = None,
) -> None:
    """Tell all that becomes of the light of one pixel: each facet that it meets, and each end with its share."""
    from culet.paths.answer import MOST_WAVELENGTHS, WAVELENGTHS
    from culet.paths.asked import Pixel, Ray, answered
    from culet.paths.recorder import PathRecorder
    from culet.rendering.opencl.device import open_device

    with errors_in_one_line():
        if pixel is not None and ray is not None:
            raise SceneError("expected a pixel or a ray, got both", "pixel")
        asked: Pixel | Ray
        if ray is not None:
            origin, _, direction = ray.partition(":")
            asked = Ray(_vector(origin, "ray"), _vector(direction, "ray"))
        else:
            x, y = (width // 2, height // 2) if pixel is None else map(int, _numbers(pixel, "pixel", 2))
            asked = Pixel(x, y, width, height)
        lines = () if wavelengths is None else _numbers(wavelengths, "wavelengths", None)
        if len(lines) > MOST_WAVELENGTHS or any(not WAVELENGTHS[0] <= line <= WAVELENGTHS[1] for line in lines):
            low, high = WAVELENGTHS
            raise SceneError(
                f"wavelengths: expected at most {MOST_WAVELENGTHS} from {low:g} to {high:g} nm, got {wavelengths:.60}",
                "wavelengths",
            )
        stage = read_stage(scene, preset, mesh, sky, cut)
        told = answered(PathRecorder(open_device()), stage, asked, wavelengths=lines)
        if as_json:
            typer.echo(json.dumps(asdict(told), indent=2))
        else:
            _print(told)


def _numbers(text: str, name: str, count: int | None) -> tuple[float, ...]:
    try:
        numbers = tuple(float(part) for part in text.split(","))
    except ValueError:
        numbers = ()
    if not numbers or (count is not None and len(numbers) != count):
        wanted = "numbers" if count is None else f"{count} numbers"
        raise SceneError(f"{name}: expected {wanted} with commas between them, got {text!r:.60}", name)
    return numbers


def _vector(text: str, name: str) -> tuple[float, float, float]:
    x, y, z = _numbers(text, name, 3)
    return x, y, z


def _print(told: answer.Path) -> None:
    from rich.table import Table

    console = report_console()
    table = Table(*HEADINGS, box=None)
    for step in told.steps:
        table.add_row(*_row(told, step))
    console.print(table)
    console.print()
    red, green, blue = told.value
    console.print(
        f"the pixel's value: {red:.6g} red, {green:.6g} green, {blue:.6g} blue; {_percent(told.cut)} was cut off"
    )
    for sentence in sentences(told):
        console.print(sentence)


def sentences(told: answer.Path) -> Iterator[str]:
    """Where the pixel's light comes from, the brightest first."""
    whose = "this ray" if told.pixel is None else "this pixel"
    for part in told.parts:
        yield f"{_percent(part.share)} of {whose} comes from {met_words(part)}"


def met_words(part: answer.Part) -> str:
    """What gives light, and where it is."""
    if part.meets != "lamp":
        return MET_WORDS[part.meets]
    where = "" if part.side is None else f" {SIDE_WORDS[part.side]}"
    return f"the lamp{where} (number {part.number})"


def _row(told: answer.Path, step: answer.Step) -> tuple[str, ...]:
    first = step.passes[0]
    at_stone = first.reflectance is not None
    return (
        str(step.number),
        "" if step.parent is None else str(step.parent),
        _light(told, step),
        _happens(step),
        _span([each.incidence_degrees for each in step.passes], 2),
        _span([each.critical_degrees for each in step.passes], 2),
        "" if first.reflectance is None
        else f"{first.reflectance.s:.4f}, {first.reflectance.p:.4f}, {first.reflectance.unpolarised:.4f}",
        f"{first.weight:.4f}" + (f" -> {first.weight * first.kept:.4f}" if at_stone else ""),
        _span([each.length for each in step.passes], 4),
        ", ".join(f"{_percent(part.share)} {met_words(part)}" for part in step.parts),
    )  # fmt: skip


def _light(told: answer.Path, step: answer.Step) -> str:
    names = []
    for each in step.passes:
        if each.chain is None:
            return "all"
        chain = told.chains[each.chain]
        names.append(CHANNEL_LETTERS[chain.channel] if chain.channel else f"{chain.wavelength:.0f}")
    return " ".join(names) if told.chains[0].channel is None else "".join(names)


def _happens(step: answer.Step) -> str:
    kept = step.passes[0].kept
    facet = f"{step.stone}'s {step.facet_name or f'facet {step.facet}'}"
    match step.kind:
        case "enters":
            return f"enters by {facet}, {_percent(kept)} is reflected"
        case "meets":
            return f"totally reflected at {facet}" if kept == 1 else f"{_percent(kept)} reflected at {facet}"
        case "lands":
            return "lands" if kept == 0 else f"mirrored, {_percent(kept)}"
        case "sees":
            return "goes away"
        case "ends":
            return f"is dropped{' inside' if step.inside else ''}, {_percent(sum(each.cut for each in step.passes))}"
        case "chance":
            return f"goes on by chance, {kept:.3g} times as heavy"
        case _:
            assert_never(step.kind)


def _percent(share: float) -> str:
    percent = 100 * share
    return f"{percent:.0f} %" if abs(percent) >= 9.95 else f"{percent:.2g} %"


def _span(values: list[float | None], digits: int) -> str:
    """One number, or the least and the largest where they differ."""
    known = [value for value in values if value is not None]
    if not known:
        return ""
    low, high = f"{min(known):.{digits}f}", f"{max(known):.{digits}f}"
    return low if low == high else f"{low} to {high}"
