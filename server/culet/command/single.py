"""A command in a module of its own, which is imported when the command is used."""

from __future__ import annotations

from importlib import import_module
from typing import Any

import typer
from typer.core import TyperGroup
from typer.main import get_command

MODULES = {
    "render": "culet.command.render",
    "simulate": "culet.command.simulate",
    "bench": "culet.command.bench",
    "serve": "culet.command.serve",
    "gateway": "culet.command.gateway",
    "engine": "culet.command.engine",
    "keys": "culet.command.keys",
    "view": "culet.command.view",
    "record": "culet.command.record",
    "study": "culet.command.study",
    "design": "culet.command.design",
    "grade": "culet.command.grade",
    "sweep": "culet.command.sweep",
    "animate": "culet.command.animate",
    "path": "culet.command.path",
}
"""Where the commands are, in the order in which they are listed. Each module has an `app`."""


def single_command() -> typer.Typer:
    """For the command of a module."""
    return typer.Typer(add_completion=False, pretty_exceptions_enable=False)


class CommandsOnDemand(TyperGroup):
    """Commands whose modules are imported when they are asked for: `culet --version` and each command by itself need
    not wait for what the others need."""

    def list_commands(self, ctx: Any) -> list[str]:  # noqa: ANN401 - typer has the classes to itself
        """Their names."""
        del ctx
        return list(MODULES)

    def get_command(self, ctx: Any, cmd_name: str) -> Any:  # noqa: ANN401 - as above
        """The command of that name, or None."""
        del ctx
        if cmd_name not in MODULES:
            return None
        if cmd_name not in self.commands:
            command = get_command(import_module(MODULES[cmd_name]).app)
            command.name = cmd_name
            self.commands[cmd_name] = command
        return self.commands[cmd_name]
