"""Why a scene, or a message about one, cannot be used: pydantic's findings as one line that names the field."""

from __future__ import annotations

from typing import get_args

from pydantic import BaseModel, ValidationError

from culet.errors import SceneError
from culet.scene.backdrop import Backdrop
from culet.scene.sky import Environment
from culet.scene.wording import at_its_tag, expected, unknown_field

_KINDS = {
    name: frozenset(get_args(kind.model_fields["kind"].annotation)[0] for kind in get_args(get_args(union)[0]))
    for name, union in (("environment", Environment), ("backdrop", Backdrop))
}


def field_of(location: tuple[int | str, ...]) -> str:
    """The place in the JSON: without the names that pydantic gives to the alternatives of a union."""
    parts = [str(part) for part in location]
    return ".".join(
        part
        for before, part in zip(["", *parts], parts, strict=False)
        if not (part.startswith("<") or part in _KINDS.get(before, ()))
    )


def scene_error(error: ValidationError, root: type[BaseModel] = BaseModel) -> SceneError:
    """The first finding of pydantic as one line: the field, what was expected, what came.

    `root` is the model that was read, of whose fields an unknown one was probably meant; of BaseModel nothing is said.
    """
    first = at_its_tag(error.errors(include_url=False)[0])
    field = field_of(first["loc"])
    more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
    if first["type"] == "extra_forbidden":
        return SceneError(f"{field}: {unknown_field(first['loc'], root)}{more}", field)
    came = f"a list of {len(first['input'])}" if first["type"] == "too_long" else repr(first["input"])
    shown = came if len(came) <= 80 else came[:77] + "..."
    return SceneError(f"{field or 'scene'}: {expected(first)}; got {shown}{more}", field or None)
