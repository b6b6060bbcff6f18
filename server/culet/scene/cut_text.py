"""A cut as a command line has it: `oval`, or `emerald,length_to_width=1.6`."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from culet.errors import SceneError
from culet.scene.cuts import CUTS, AnyCut
from culet.scene.refusal import scene_error


def cut_from_text(text: str) -> AnyCut:
    """A cut by its name, then proportions that are not the usual ones.

    SceneError for a name or a proportion that does not exist, or a proportion out of range.
    """
    name, *changes = (part.strip() for part in text.split(","))
    kind = next((kind for known, kind in CUTS.items() if known == name), None)
    if kind is None:
        raise SceneError(f"cut: expected one of {', '.join(CUTS)}; got {name!r:.40}", "cut")
    said: dict[str, Any] = {"name": name}
    for change in changes:
        proportion, equals, value = change.partition("=")
        if not equals:
            raise SceneError(f"cut: expected proportion=number after {name}, got {change!r:.40}", "cut")
        said[proportion.strip()] = value.strip()
    try:
        return kind.model_validate(said)
    except ValidationError as error:
        found = scene_error(error, kind)
        raise SceneError(f"cut.{found}", f"cut.{found.field}") from error
