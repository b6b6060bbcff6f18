"""`--config FILE`: options of a server in a file, as TOML. The command line counts first, then variables, then the
file."""

from __future__ import annotations

import difflib
import os
import tomllib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from culet.engine.capacity.limits import Limits
from culet.errors import InputError
from culet.gateway.settings import GatewaySettings
from culet.settings import Settings, variable

CONFIG = "config"
COMMANDS_OWN = frozenset({"control", "frames", "spare", "open"})
"""Options of `culet serve` and its like that are no settings."""
TOKEN = frozenset({"token", "no_token"})
"""One setting by two names: a variable of either counts before both of the file."""
ENDPOINTS = {"control": "", "frames": ""}
"""Those of GatewaySettings, which a command names by itself."""


def read_config(file: Path, options: Mapping[str, bool]) -> dict[str, Any]:
    """What a file says of the options of these names, of which some are repeatable.

    A file may be several commands': what another one has is left alone. InputError names the file, and what is wrong.
    """
    try:
        with file.open("rb") as stream:
            given = tomllib.load(stream)
    except OSError as error:
        raise InputError(f"{file}: cannot be read: {error.strerror}", CONFIG) from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"{file}: not TOML: {error}", CONFIG) from error
    known = {*GatewaySettings.model_fields, *Limits.model_fields, *COMMANDS_OWN}
    found: dict[str, Any] = {}
    for key, value in given.items():
        name = key.replace("-", "_")
        if name not in known:
            close = difflib.get_close_matches(name, known, 1)
            hint = f"; did you mean `{close[0]}`?" if close else ""
            raise InputError(f"{file}: {key}: no option of a server{hint}", key)
        if not _is_plain(value):
            raise InputError(f"{file}: {key}: expected a text, a number, true, false or a list of texts", key)
        if name in found:
            raise InputError(f"{file}: {key}: is there twice", key)
        found[name] = value
    _check(file, found)
    said = {name for name in options if os.environ.get(variable(name))}
    unsaid = {*options} - said - (TOKEN if said & TOKEN else set())
    return {
        name: _repeated(file, name, value, repeatable=options[name]) for name, value in found.items() if name in unsaid
    }


def _repeated(file: Path, name: str, value: object, *, repeatable: bool) -> object:
    """As the command line would have it: a list for what is repeatable, one value for the rest."""
    if repeatable and isinstance(value, str):
        return [word.strip() for word in value.split(",") if word.strip()]
    if isinstance(value, list) and not repeatable:
        raise InputError(f"{file}: {name}: expected one value, got a list", name)
    return value


def _is_plain(value: object) -> bool:
    if isinstance(value, list):
        return all(isinstance(word, str) for word in value)
    return isinstance(value, str | int | float)


def _check(file: Path, found: Mapping[str, Any]) -> None:
    """InputError for what settings cannot be, with the name of the file; later it would be told as an option's."""
    kinds: tuple[type[Settings], ...] = (GatewaySettings, Limits)
    for kind in kinds:
        endpoints = ENDPOINTS if kind is GatewaySettings else {}
        own = {name: value for name, value in found.items() if name not in COMMANDS_OWN}
        try:
            kind.read(own, **endpoints)
        except InputError as error:
            if error.field not in own:  # a variable's, which is told of in its turn
                continue
            raise InputError(f"{file}: {str(error).removeprefix('--')}", error.field) from error
    for name in ("spare", "open"):
        if name in found and not isinstance(found[name], bool):
            raise InputError(f"{file}: {name}: expected true or false; got {found[name]!r}", name)
    if "frames" in found and not isinstance(found["frames"], str | list):
        raise InputError(f"{file}: frames: expected an endpoint; got {found['frames']!r}", "frames")
