"""The shape of any cut, and why proportions make none."""

from __future__ import annotations

from collections.abc import Mapping
from functools import lru_cache
from typing import assert_never

from pydantic import ValidationError

from culet.errors import MeshError
from culet.geometry.brilliant import brilliant
from culet.geometry.cuts import outlines, princess, roses, rows, steps
from culet.geometry.cuts.brilliants import brilliant_on
from culet.geometry.cuts.heart import heart
from culet.geometry.shape import Shape
from culet.scene import cuts
from culet.scene.cuts import AnyCut

HALVINGS = 10
"""Of the way from the usual proportion to the one that was asked for, to tell how far one may go."""


@lru_cache(maxsize=64)
def shape_of_cut(cut: AnyCut) -> Shape:
    """The shape of these proportions, with each facet that is meant and no other. MeshError, which names the
    proportion, if there is none."""
    try:
        return _made(cut)
    except MeshError as error:
        if error.field is not None:
            raise
        raise _refusal(cut, error) from error


def _made(cut: AnyCut) -> Shape:
    """MeshError, too, where the numbers are so small or large that the construction divides by zero or overflows."""
    try:
        return _constructed(cut)
    except ArithmeticError as error:
        raise MeshError(f"{cut.name}: a proportion is too extreme for a stone") from error


def _constructed(cut: AnyCut) -> Shape:
    match cut:
        case cuts.BrilliantCut():
            return brilliant(cut)
        case cuts.OldEuropeanCut():
            return brilliant_on(outlines.ellipse(1), cut, culet=cut.culet_percent / 100).shape()
        case cuts.OvalCut():
            return brilliant_on(outlines.ellipse(cut.length_to_width), cut).shape()
        case cuts.CushionCut():
            return brilliant_on(outlines.pillow(cut.length_to_width, cut.squareness), cut).shape()
        case cuts.PearCut():
            return brilliant_on(outlines.drop(cut.length_to_width), cut).shape()
        case cuts.MarquiseCut():
            keel = cut.keel_percent / 100 * (cut.length_to_width - 1)
            return brilliant_on(outlines.two_arcs(cut.length_to_width), cut, keel=keel).shape()
        case cuts.TrillionCut():
            return brilliant_on(outlines.three_arcs(cut.bulge_percent / 100), cut).shape()
        case cuts.HeartCut():
            return heart(cut)
        case cuts.SingleCut():
            return roses.single(cut).shape()
        case cuts.RoseCut():
            return roses.rose(cut).shape()
        case cuts.PortugueseCut():
            return rows.portuguese(cut).shape()
        case cuts.BrioletteCut():
            return rows.briolette(cut).shape()
        case cuts.PrincessCut():
            return princess.princess(cut).shape()
        case cuts.EmeraldCut():
            return steps.step_cut(cut, cut.length_to_width, cut.corner_percent / 100).shape()
        case cuts.AsscherCut():
            return steps.step_cut(cut, 1, cut.corner_percent / 100).shape()
        case cuts.BaguetteCut():
            return steps.step_cut(cut, cut.length_to_width, 0).shape()
    assert_never(cut)


def _refusal(cut: AnyCut, error: MeshError) -> MeshError:
    """Names the proportion that can be changed alone until the cut exists, and how far; or else the strangest one."""
    usual = type(cut)()
    strange = [name for name in _numbers(cut) if getattr(cut, name) != getattr(usual, name)]
    strange.sort(key=lambda name: -_strangeness(cut, usual, name))
    for name in strange:
        wanted, known = getattr(cut, name), getattr(usual, name)
        if _is_made(cut, {name: known}):
            limit = "at most" if wanted > known else "at least"
            most = _furthest(cut, name, known, wanted)
            return MeshError(
                f"{error}; with the other proportions {name} can be {limit} about {most:.4g}, got {wanted:g}", name
            )
    changed: dict[str, float] = {}
    for name in strange:
        changed[name] = getattr(usual, name)
        if _is_made(cut, changed):
            would_do = ", ".join(f"{name} {value:g} (got {getattr(cut, name):g})" for name, value in changed.items())
            return MeshError(f"{error}; there would be one with {would_do}", strange[0])
    raise AssertionError(f"the usual proportions of {cut.name} make no stone") from error


def _furthest(cut: AnyCut, name: str, good: float, bad: float) -> float:
    """From a value that does toward one that does not."""
    whole = type(cut).model_fields[name].annotation is int
    for _ in range(HALVINGS):
        middle = (good + bad) / 2
        if whole:
            middle = round(middle)
        if middle in (good, bad):
            break
        good, bad = (middle, bad) if _is_made(cut, {name: middle}) else (good, middle)
    return good


def _numbers(cut: AnyCut) -> list[str]:
    return [name for name in type(cut).model_fields if name != "name"]


def _strangeness(cut: AnyCut, usual: AnyCut, name: str) -> float:
    """How far the proportion is from the usual one, of the usual range."""
    least, most = cuts.usual_range(cut, name)
    return float(abs(getattr(cut, name) - getattr(usual, name)) / (most - least))


def _is_made(cut: AnyCut, changed: Mapping[str, float]) -> bool:
    try:
        _made(type(cut).model_validate({**cut.model_dump(), **changed}))
    except (MeshError, ValidationError):
        return False
    return True
