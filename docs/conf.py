"""How the documentation is built: `make docs`. Warnings are errors there, and nothing is fetched."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from sphinx.ext.napoleon.docstring import GoogleDocstring

from culet.gateway.document import document
from culet.version import __version__

if TYPE_CHECKING:
    from sphinx.application import Sphinx

HERE = Path(__file__).parent
MADE = HERE / "_build"
"""What pages are made of that nobody writes, and the site itself."""

project = "culet"
author = "the authors of culet"
version = release = __version__
language = "en"
html_show_copyright = False
default_role = "literal"  # of docstrings, whose names stand in single backticks

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "sphinx_copybutton",
    "sphinxcontrib.openapi",
]
exclude_patterns = ["_build"]
nitpicky = True
nitpick_ignore_regex = [
    # What belongs to other projects, whose lists of names would have to be fetched.
    (r"py:.*", r"(numpy|np|pydantic|pydantic_core|annotated_types|PIL|collections|pathlib|typing|os|zmq|enum)\..*"),
    (r"py:.*", r"culet\.(simulation|study)\..*|OnePath|SeveralPaths|Study|Report|Progress|Scene"),  # described in words
    (r"py:.*", r"culet_protocol\.messages\..*"),  # listed as a whole
    (r"py:.*", r"(Path|NDArray|Mapping|Callable|Sequence|PathLike|ModelWrapValidatorHandler|InitErrorDetails)"),
]

myst_enable_extensions = ["colon_fence"]
myst_heading_anchors = 4
suppress_warnings = ["myst.header"]  # notes of releases begin where they begin

autodoc_member_order = "bysource"
autodoc_typehints = "signature"
autodoc_preserve_defaults = True

copybutton_exclude = ".linenos, .gp"

html_theme = "furo"
html_title = f"culet {release}"
html_theme_options = {"source_edit_link": ""}
html_copy_source = False
html_show_sphinx = False


def readable(described: dict[str, Any]) -> dict[str, Any]:
    """The document in the words that sphinxcontrib.openapi has: no sum of a type and null, which for a parameter means
    that it may be left out; no status `default`; bodies by their examples."""
    schemas = described["components"]["schemas"]
    for operation in (operation for path in described["paths"].values() for operation in path.values()):
        operation["responses"].pop("default", None)
        for parameter in operation.get("parameters", []):
            schema = parameter["schema"]
            kinds = [kind for kind in schema.get("anyOf", []) if kind.get("type") != "null"]
            if kinds:
                parameter["schema"] = schema | kinds[0]
            parameter.setdefault("description", parameter["schema"].get("description", ""))
        for kind, content in operation.get("requestBody", {}).get("content", {}).items():
            operation["description"] += f"\n\nThe body is `{kind}`{_such_as(content['schema'], schemas)}."
    return described


def _such_as(schema: dict[str, Any], schemas: dict[str, Any]) -> str:
    """Examples of a body, or its fields."""
    parts = [
        schemas[part["$ref"].rpartition("/")[2]] if "$ref" in part else part for part in schema.get("anyOf", [schema])
    ]
    examples = [f"`{json.dumps(example)}`" for part in parts for example in part.get("examples", [])]
    if examples:
        return f", such as {', or '.join(examples)}"
    return f" with {', '.join(f'`{name}`' for part in parts for name in part.get('properties', {}))}"


def notebook_text(notebook: dict[str, Any]) -> str:
    """Its cells as Markdown, without the title."""
    cells = [(cell["cell_type"], "".join(cell["source"])) for cell in notebook["cells"]]
    text = "\n\n".join(f"```python\n{source}\n```" if kind == "code" else source for kind, source in cells)
    return text.partition("\n")[2]


def write_references(_app: Sphinx) -> None:
    """What the interfaces say of themselves: REST as `/openapi.json` answers, the commands as their `--help` does. And
    the notebook as a page."""
    MADE.mkdir(exist_ok=True)
    notebook = json.loads((HERE / "tutorial" / "notebook.ipynb").read_text(encoding="utf-8"))
    (MADE / "notebook.md").write_text(notebook_text(notebook), encoding="utf-8")
    (MADE / "openapi.json").write_text(json.dumps(readable(document())), encoding="utf-8")
    typer = [sys.executable, "-m", "typer", "culet.cli", "utils", "docs", "--name", "culet"]
    subprocess.run([*typer, "--output", MADE / "commands.md"], check=True, stdout=subprocess.DEVNULL)  # noqa: S603


def read_sections(_app: Sphinx, what: str, _name: str, _of: object, _options: object, lines: list[str], /) -> None:
    """`Args:` and `Raises:` of docstrings. napoleon itself would take what stands before the colon of
    `(N, 3), R: the centres of mass` for a type."""
    if what in ("function", "method", "class", "exception"):
        lines[:] = GoogleDocstring(lines).lines()


def setup(app: Sphinx) -> None:
    """Called by Sphinx."""
    app.connect("autodoc-process-docstring", read_sections)
    app.connect("builder-inited", write_references)
