"""What a process of culet can be told: each setting is an option of its command and an environment variable.

A field `max_viewers` is the option `--max-viewers` and the variable `CULET_MAX_VIEWERS`; the option counts if both are
given, and an empty variable is none. `command/settings.py` makes the options out of the fields.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, ByteSize, Field, ValidationError
from pydantic_settings import BaseSettings, SettingsConfigDict

from culet.errors import InputError
from culet.logs import Level, LogFormat
from culet.scene.wording import expected

PREFIX = "CULET_"
MEBIBYTE = 1 << 20
_UNITS = (("GiB", 1 << 30), ("MiB", MEBIBYTE), ("KiB", 1 << 10))


def _listed(value: object) -> object:
    return [word.strip() for word in value.split(",") if word.strip()] if isinstance(value, str) else value


Words = Annotated[tuple[str, ...], BeforeValidator(_listed)]
"""Several: an option that is given several times, or words between commas in a variable."""


class Settings(BaseSettings):
    """Base of them: immutable, read from what a command was given and from the environment."""

    model_config = SettingsConfigDict(
        env_prefix=PREFIX,
        env_ignore_empty=True,
        enable_decoding=False,  # a list is words between commas, not JSON
        extra="forbid",
        frozen=True,
        allow_inf_nan=False,
        validate_default=True,
    )

    log_level: Level = Field("info", description="What is told on stderr: events of this level and above.")
    log_format: LogFormat = Field("text", description="How it is told: as text, or as one JSON object a line.")
    keys: Path | None = Field(
        None,
        description="Folder of keys for tcp:// endpoints, made by `culet keys`: what travels there is encrypted, and "
        "only those with keys that the engine knows are let in.",
    )
    max_sessions: int = Field(64, ge=1, description="Sessions that may be open at once.")
    max_upload_bytes: ByteSize = Field(
        ByteSize(64 * MEBIBYTE), ge=1, description="Size of one uploaded file, such as 64MiB."
    )

    @classmethod
    def read(cls, given: Mapping[str, Any], **fixed: Any) -> Self:  # noqa: ANN401 - fields of any type
        """The settings: `given` are those that the command's user gave, of this and of other settings.

        Raises InputError that names the option, or the variable, of the first that cannot be used.
        """
        own = {name: value for name, value in given.items() if name in cls.model_fields}
        try:
            return cls(**own, **fixed)
        except ValidationError as error:
            finding = error.errors(include_url=False)[0]
            name = str(finding["loc"][0])
            source = option(name) if name in own else variable(name)
            wanted = "expected a size such as 64MiB" if finding["type"].startswith("byte_size") else expected(finding)
            secret = name in cls.model_fields and not cls.model_fields[name].repr
            came = "" if secret else f"; got {str(finding['input'])!r}"
            raise InputError(f"{source}: {wanted}{came}", name) from None

    @classmethod
    def words(cls, given: Mapping[str, Any]) -> Iterator[str]:
        """The command line of a child process that is to have what was given of these settings."""
        for name, value in given.items():
            if name not in cls.model_fields:
                continue
            if isinstance(value, bool):
                yield option(name) if value else f"--no-{_dashed(name)}"
                continue
            for word in value if isinstance(value, list | tuple) else [value]:
                yield from (option(name), str(word))


def option(field: str) -> str:
    """The command line's name of a field."""
    return f"--{_dashed(field)}"


def variable(field: str) -> str:
    """The environment's name of a field."""
    return PREFIX + field.upper()


def shown(value: object) -> str:
    """A default as a user would write it."""
    match value:
        case ByteSize():
            return next((f"{value // size}{unit}" for unit, size in _UNITS if value % size == 0), str(int(value)))
        case bool():
            return "on" if value else "off"
        case float():
            return f"{value:g}"
        case Path() | str() | int():
            return str(value)
        case tuple():
            return ", ".join(map(str, value)) or "none"
    raise TypeError(f"a setting cannot be shown: {value!r}")


def _dashed(field: str) -> str:
    return field.replace("_", "-")
