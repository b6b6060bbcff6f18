"""Puts into the wheel what is built: the page, as `culet/page`, and the solver of stones in contact, by its sources.

And README.md, whose links to files beside it would lead nowhere from an index of packages. `CULET_HOME_URL`, such as
`https://git.example/gems/culet/blob/main`, says where those files can be seen; without it the links are words.
"""

from __future__ import annotations

import importlib.util
import os
import re
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface
from hatchling.metadata.plugin.interface import MetadataHookInterface

SOLVER = "culet/simulation/solver"
_LINK = re.compile(r"(!?)\[([^\]]*)\]\((?!https?://)([^)]+)\)")


def readme(text: str, home: str | None) -> str:
    """README.md as it can be read anywhere. Without a home, paragraphs with pictures are left out."""
    if home is not None:
        return _LINK.sub(lambda link: f"{link[1]}[{link[2]}]({home.rstrip('/')}/{link[3]})", text)
    kept = [part for part in text.split("\n\n") if "![" not in part]
    return _LINK.sub(lambda link: link[2], "\n\n".join(kept))


class Description(MetadataHookInterface):
    """The package's description, and its home if that is known."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Set what pyproject.toml calls dynamic."""
        home = os.environ.get("CULET_HOME_URL")
        text = (Path(self.root) / "README.md").read_text(encoding="utf-8")
        metadata["readme"] = {"content-type": "text/markdown", "text": readme(text, home)}
        metadata["urls"] = {} if home is None else {"Homepage": home}


class BuiltParts(BuildHookInterface):
    """A wheel is built without one of them as well, and says so: a server is told where its page lies, and the solver
    is compiled when stones first move."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Before the files are gathered. An editable installation finds page and solver in the checkout."""
        if version == "editable" or self.target_name != "wheel":
            return
        page = Path(self.root) / "client" / "web" / "dist"
        if (page / "index.html").is_file():
            build_data["force_include"][str(page)] = "culet/page"
        else:
            self.app.display_warning(f"This wheel holds no page: there is none in {page}. `make wheel` builds both.")
        self._add_solver(build_data)

    def _add_solver(self, build_data: dict[str, Any]) -> None:
        """With it the wheel is of this kind of machine alone; Python's version does not matter to the library."""
        folder = Path(self.root) / "server" / SOLVER
        spec = importlib.util.spec_from_file_location("culet_solver_build", folder / "build.py")
        assert spec is not None  # noqa: S101 - of a file
        assert spec.loader is not None  # noqa: S101
        build = importlib.util.module_from_spec(spec)
        spec.loader.exec_module(build)
        library = folder / build.library_name()
        if not library.is_file():
            try:
                library = build.build(Path(self.root) / "build" / "solver")
            except build.BuildError as error:
                self.app.display_warning(f"This wheel holds no solver of stones in contact: {error}")
                return
        build_data["force_include"][str(library)] = f"{SOLVER}/{library.name}"
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{sysconfig.get_platform().replace('-', '_').replace('.', '_')}"
