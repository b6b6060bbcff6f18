"""Which scenes a sweep is over: fields of a scene, and the values that each takes."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

from culet.errors import SceneError
from culet.scene.cuts import proportions
from culet.scene.model import Scene
from culet.scene.stone import StoneSettings

MOST_POINTS = 100_000
"""Of a sweep."""


@dataclass(frozen=True)
class Variation:
    """One field of a scene, and its values."""

    field: str
    """As errors name it: `camera.fov_degrees`, `stones.ruby.cut.crown_degrees`; one of the first stone's own fields may
    stand alone, as `cut.crown_degrees`."""
    values: tuple[Any, ...]


def variation(text: str) -> Variation:
    """Of FIELD=FROM:TO:STEP, TO among the values if a step falls on it, or of FIELD=VALUE,VALUE...; SceneError."""
    field, equals, said = text.partition("=")
    if not equals or not field.strip() or not said.strip():
        raise SceneError(f"vary: expected FIELD=FROM:TO:STEP or FIELD=VALUE,VALUE; got {text!r:.80}", "vary")
    if ":" in said:
        return Variation(field.strip(), _range(text, said.split(":")))
    return Variation(field.strip(), tuple(_value(each.strip()) for each in said.split(",")))


def _range(text: str, ends: Sequence[str]) -> tuple[float, ...]:
    try:
        least, most, step = (float(end) for end in ends)
    except ValueError:
        raise SceneError(f"vary: expected three numbers FROM:TO:STEP; got {text!r:.80}", "vary") from None
    if not (math.isfinite(least) and math.isfinite(most) and math.isfinite(step)) or step == 0:
        raise SceneError(f"vary: expected finite numbers and a step other than 0; got {text!r:.80}", "vary")
    steps = (most - least) / step
    count = math.floor(steps * (1 + 1e-12) + 1e-9) + 1 if abs(steps) <= MOST_POINTS else 0
    if not 1 <= count <= MOST_POINTS:
        raise SceneError(
            f"vary: expected 1 to {MOST_POINTS} values from FROM to TO; got {max(steps + 1, 0):.0f} of {text!r:.80}",
            "vary",
        )
    return tuple(round(least + k * step, 12) for k in range(count))


def _value(said: str) -> Any:  # noqa: ANN401 - of JSON
    """A number, true, null or a list as JSON has it, or else a word."""
    try:
        return json.loads(said, parse_constant=str)  # NaN and the infinities are words, which no number may be
    except ValueError:
        return said


def points_of(variations: Sequence[Variation]) -> list[tuple[Any, ...]]:
    """Every combination of values, the last field's first; SceneError for too many or for a field given twice."""
    fields = [each.field for each in variations]
    twice = next((field for field in fields if fields.count(field) > 1), None)
    if twice is not None:
        raise SceneError(f"vary: expected each field once, got {twice} more than once", "vary")
    count = math.prod(len(each.values) for each in variations)
    if count > MOST_POINTS:
        raise SceneError(f"vary: expected at most {MOST_POINTS} points, got {count}", "vary")
    return list(product(*(each.values for each in variations)))


def varied(scene: Scene, changes: Mapping[str, Any]) -> Scene:
    """The scene with other values in those fields; SceneError names one that there is not, or that cannot have one."""
    document = scene.model_dump(mode="json")
    for field, value in changes.items():
        _put(document, field, value)
    return Scene.read(document)


def _put(document: dict[str, Any], field: str, value: Any) -> None:  # noqa: ANN401 - of JSON
    names = field.split(".")
    if names[0] not in Scene.model_fields and names[0] in StoneSettings.model_fields:
        names = ["stones", "0", *names]
    here: Any = document
    for number, name in enumerate(names[:-1]):
        within = ".".join(names[: number + 1])
        here = _opened(here, name, within, field)
    last = names[-1]
    if isinstance(here, list):
        here[_place(here, last, field)] = value
    elif isinstance(here, dict):
        here[last] = value
    else:
        raise _nothing(field, ".".join(names[:-1]))


def _opened(here: Any, name: str, within: str, field: str) -> Any:  # noqa: ANN401 - of JSON
    """What is under a name, which becomes an object if it is a cut's name or nothing."""
    if isinstance(here, list):
        return here[_place(here, name, field)]
    if not isinstance(here, dict) or name not in here:
        raise _nothing(field, within)
    if here[name] is None:
        here[name] = {}
    elif name == "cut" and isinstance(here[name], str):
        here[name] = proportions(here[name]).model_dump(mode="json")
    return here[name]


def _place(here: list[Any], name: str, field: str) -> int:
    """Of a stone by its id, or of any entry by its number."""
    for place, each in enumerate(here):
        if isinstance(each, dict) and each.get("id") == name:
            return place
    if name.isdecimal() and int(name) < len(here):
        return int(name)
    raise SceneError(f"vary: {field}: expected a number below {len(here)} or an id, got {name!r:.40}", field)


def _nothing(field: str, within: str) -> SceneError:
    return SceneError(f"vary: {field}: the scene has no {within}", field)
