"""The help of a command with many options."""

from __future__ import annotations

from typing import Any

from typer.core import TyperCommand


class ListedHelp(TyperCommand):
    """A command whose options are listed under their titles: in a table, 80 columns cut their names."""

    def __init__(self, *arguments: Any, **options: Any) -> None:  # noqa: ANN401 - as typer's
        super().__init__(*arguments, **options | {"rich_markup_mode": None})

    def format_options(self, ctx: Any, formatter: Any) -> None:  # noqa: ANN401 - typer has the classes to itself
        """Write the options, those without a title first."""
        titled: dict[str, list[tuple[str, str]]] = {}
        for parameter in self.get_params(ctx):
            record = parameter.get_help_record(ctx)
            if record is not None:
                titled.setdefault(getattr(parameter, "rich_help_panel", None) or "Options", []).append(record)
        for title, records in titled.items():
            with formatter.section(title):
                formatter.write_dl(records)
