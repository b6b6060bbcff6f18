"""What pydantic finds, in the words of someone who writes JSON and has never heard of pydantic."""

from __future__ import annotations

import difflib
from collections.abc import Iterator, Mapping
from typing import Any, get_args

from pydantic import BaseModel

_WHOLE = {
    "extra_forbidden": "unknown field",
    "missing": "expected a value, found none",
    "model_type": "expected an object",
    "model_attributes_type": "expected an object",
    "dict_type": "expected an object",
    "tuple_type": "expected a list",
    "list_type": "expected a list",
    "too_long": "expected a list of at most {max_length}",
    "too_short": "expected a list of at least {min_length}",
    "float_parsing": "expected a number",
    "int_parsing": "expected a whole number",
    "int_from_float": "expected a whole number",
    "string_pattern_mismatch": "expected text that matches {pattern}",
    "union_tag_invalid": "expected one of {expected_tags}",
    "union_tag_not_found": "expected a value, found none",
}
"""By pydantic's type of the finding, with its own numbers. Others say it well enough, in the words below."""

SINCE_2 = {
    "lights": "`emitters` of shape `point`",
    "lamps": "the scene's `emitters`",
    "size_mm": "the scene's `millimetres`",
    "mass": "a `mass` for each stone",
    "spin": "a `spin` for each stone",
    "velocity": "a `velocity` for each stone",
}
"""What took the place of fields that only version 1 knew."""

_PHRASES = {
    "Value error, ": "",
    "Input should be a valid ": "expected a ",
    "Input should be ": "expected ",
    "greater than or equal to": "at least",
    "less than or equal to": "at most",
}


def at_its_tag(finding: Mapping[str, Any]) -> Mapping[str, Any]:
    """The finding, but of an object's `kind` where that chooses none of a union's forms: pydantic names the object."""
    tag, came = finding.get("ctx", {}).get("discriminator", "").strip("'"), finding.get("input")
    if not tag or not isinstance(came, Mapping):
        return finding
    # Without the tag the whole object is shown, as for any other field that is missing.
    return {**finding, "loc": (*finding["loc"], tag), "input": came.get(tag, came)}


def expected(finding: Mapping[str, Any]) -> str:
    """What a finding of pydantic's `errors()`, with its context, wanted: `expected at most 1`."""
    if finding["type"] in _WHOLE:
        return _WHOLE[finding["type"]].format(**finding.get("ctx", {}))
    message: str = finding["msg"]
    for theirs, ours in _PHRASES.items():
        message = message.replace(theirs, ours)
    return message


def unknown_field(location: tuple[int | str, ...], root: type[BaseModel]) -> str:
    """That a field does not exist, and which one was probably meant; `location` is pydantic's, `root` what it read."""
    known = _fields_beside(location, root)
    if not known:
        return "unknown field"
    name = str(location[-1])
    if name in SINCE_2 and name not in known:
        return f"unknown field; version 2 of the scene has {SINCE_2[name]}"
    close = difflib.get_close_matches(name, known, n=1) or [other for other in known if other.startswith(name)]
    return f"unknown field; did you mean `{close[0]}`?" if close else f"unknown field; there are: {', '.join(known)}"


def _fields_beside(location: tuple[int | str, ...], root: type[BaseModel]) -> list[str]:
    """Names that may stand where the location's last one does: of every form that may stand there."""
    models = [root]
    for part in location[:-1]:
        inner = [
            model
            for outer in models
            if part in outer.model_fields
            for model in _models_in(outer.model_fields[str(part)].annotation)
        ]
        models = inner or [model for model in models if _is_form(model, str(part))] or models
    return sorted({name for model in models for name in model.model_fields})


def _models_in(annotation: object) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


def _is_form(model: type[BaseModel], tag: str) -> bool:
    """Whether a tag in a location, `light` or `<ior>`, chose that form of a union."""
    name = tag.strip("<>")
    choices = (
        model.model_fields[field].annotation for field in ("kind", "shape", "name") if field in model.model_fields
    )
    return name in model.model_fields or any(name in get_args(choice) for choice in choices)
