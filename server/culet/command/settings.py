"""Options of a command that are the fields of settings, so that a new field is an option without another word."""

from __future__ import annotations

import functools
import inspect
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import typer
from annotated_types import Ge, Gt, Le, Lt
from pydantic import ByteSize
from pydantic.fields import FieldInfo

from culet.command.config import CONFIG, read_config
from culet.command.terminal import errors_in_one_line
from culet.settings import Settings, option, shown, variable

Command = Callable[..., None]


def options_of(**panels: type[Settings]) -> Callable[[Command], Command]:
    """Give a command the options of settings, under these titles of its help.

    The command gets those that its user gave as `given`, by field: `Settings.read` checks them and adds the
    environment's. A field that several settings share is one option. Its own parameters keep their names. All of them
    can be said by a file too, which the option `--config` names.
    """

    def decorate(command: Command) -> Command:
        signature = inspect.signature(command, eval_str=True)
        own = {name: parameter for name, parameter in signature.parameters.items() if name != "given"}
        generated: dict[str, inspect.Parameter] = {}
        for title, settings in panels.items():
            for name, parameter in _parameters(title, settings):
                if name not in own:
                    generated.setdefault(name, parameter)

        @functools.wraps(command)
        def run(**arguments: Any) -> None:  # noqa: ANN401 - typer gives what the signature below says
            arguments.pop(CONFIG)  # read when it was parsed
            given = {name: arguments.pop(name) for name in generated}
            command(**arguments, given={name: value for name, value in given.items() if value not in (None, [])})

        parameters = [*own.values(), _config_parameter(), *generated.values()]
        keyword_only = [parameter.replace(kind=inspect.Parameter.KEYWORD_ONLY) for parameter in parameters]
        vars(run)["__signature__"] = inspect.Signature(keyword_only)  # where inspect.signature looks first
        run.__annotations__ = {parameter.name: parameter.annotation for parameter in parameters}
        return run

    return decorate


def _read_config(ctx: typer.Context, file: Path | None) -> None:
    """What the file says becomes the defaults of this command."""
    if file is None:
        return
    options = {
        word[2:].replace("-", "_"): each for each in ctx.command.params for word in each.opts if word[:2] == "--"
    }
    with errors_in_one_line():
        found = read_config(file, {name: getattr(each, "multiple", False) for name, each in options.items()})
        ctx.default_map = {str(options[name].name): value for name, value in found.items()}
    os.environ.pop(variable(CONFIG), None)  # processes that this one starts are told all by their command lines


def _config_parameter() -> inspect.Parameter:
    default = typer.Option(
        None,
        "--config",
        metavar="FILE",
        envvar=variable(CONFIG),
        is_eager=True,
        callback=_read_config,
        help='Options in a file, as TOML: `max_sessions = 20`, `allow_host = ["gems.example"]`. The command line '
        "counts first, then variables, then the file.",
    )
    return inspect.Parameter(CONFIG, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=Path | None)


def _parameters(title: str, settings: type[Settings]) -> Iterator[tuple[str, inspect.Parameter]]:
    for name, field in settings.model_fields.items():
        if field.is_required():  # endpoints, which each command names by itself
            continue
        kind, metavar = _kind(field)
        notes = [variable(name), *_bounds(field)]
        if field.default is not None:
            notes.append(f"default {shown(field.default)}")
        help_text = f"{field.description} ({'; '.join(notes)})"
        negated = f"/--no-{option(name)[2:]}" if kind == bool | None and not name.startswith("no_") else ""
        names = [option(name) + negated]
        default = typer.Option(None, *names, metavar=metavar, help=help_text, show_default=False, rich_help_panel=title)
        yield name, inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=kind)


def _kind(field: FieldInfo) -> tuple[Any, str | None]:
    """What typer reads, and what the help calls it. Text, but for switches: pydantic reads it, as from a variable."""
    annotation: Any = field.annotation
    inner = [part for part in get_args(annotation) if part is not type(None)]
    if get_origin(annotation) is Literal:
        return str | None, "|".join(map(str, inner))
    if get_origin(annotation) is tuple:
        return list[str] | None, "TEXT"
    if type(None) in get_args(annotation):
        (annotation,) = inner
    if annotation is bool:
        return bool | None, None
    metavars: dict[Any, str] = {int: "NUMBER", float: "NUMBER", ByteSize: "BYTES", Path: "PATH"}
    return str | None, metavars.get(annotation, "TEXT")


def _bounds(field: FieldInfo) -> Iterator[str]:
    """In words: `at least 1 and at most 8192`."""
    is_size = ByteSize in (field.annotation, *get_args(field.annotation))
    words = []
    for bound in field.metadata:
        match bound:
            case Ge(ge=limit):
                words.append(f"at least {shown(ByteSize(limit)) if is_size and isinstance(limit, int) else limit}")
            case Gt(gt=limit):
                words.append(f"over {limit}")
            case Le(le=limit):
                words.append(f"at most {limit}")
            case Lt(lt=limit):
                words.append(f"under {limit}")
    if words:
        yield " and ".join(words)
