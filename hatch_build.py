"""Puts the built page into the wheel, as `culet/page`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class PageInWheel(BuildHookInterface):
    """A wheel without the page is built as well, for a server that is told where the page lies; it says so."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Before the files are gathered. An editable installation finds the page in the checkout."""
        page = Path(self.root) / "client" / "web" / "dist"
        if version == "editable":
            return
        if (page / "index.html").is_file():
            build_data["force_include"][str(page)] = "culet/page"
        else:
            self.app.display_warning(f"This wheel holds no page: there is none in {page}. `make wheel` builds both.")
