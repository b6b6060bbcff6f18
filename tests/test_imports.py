"""What each part may not load: the gateway no device, the engine no web server, the clients nothing of the server; and
that what a part needs never needs that part."""

from __future__ import annotations

import ast
import importlib.metadata
import re
import subprocess
import sys
import tomllib
from collections.abc import Callable, Iterator
from graphlib import CycleError, TopologicalSorter
from importlib.util import find_spec
from pathlib import Path

import pytest

NOT_LOADED = {
    "culet.gateway.serve": ("pyopencl", "scipy", "culet.rendering", "culet.engine"),
    "culet.service.serve": ("pyopencl", "culet.rendering", "culet.engine", "fastapi", "uvicorn"),
    "culet.engine.process.serve": ("fastapi", "uvicorn"),
    "culet.engine.library.upload_reader": ("pyopencl",),
    "culet": ("numpy", "pydantic", "pyopencl", "importlib.metadata", "culet.scene", "culet.stills"),
    "culet_client.connection": ("culet", "pyopencl", "numpy", "fastapi"),
    "culet_client.view": ("culet", "pyopencl", "numpy", "fastapi"),
    "culet_client.stream": ("culet", "pyopencl", "numpy", "fastapi"),
}
"""Module -> packages that importing it leaves alone."""


@pytest.mark.parametrize("module", NOT_LOADED)
def test_a_part_does_not_load_what_belongs_to_another(module: str) -> None:
    run = subprocess.run(
        [sys.executable, "-c", f"import sys, {module}; print(*sys.modules)"], capture_output=True, text=True, check=True
    )
    loaded = run.stdout.split()
    assert module in loaded
    assert [name for name in loaded if f"{name}.".startswith(tuple(f"{each}." for each in NOT_LOADED[module]))] == []


NOT_RENDERED_BY = (
    *("culet.engine", "culet.gateway", "culet.simulation", "culet.study", "culet.grading", "culet.batch"),
    *(
        "fastapi",
        "uvicorn",
        "zmq",
        "dask",
        "distributed",
        "pandas",
        "matplotlib",
        "trimesh",
        "av",
        "simplejpeg",
        "OpenEXR",
    ),
    *("scipy.ndimage", "scipy.stats", "scipy.interpolate", "scipy.integrate", "scipy.signal"),
)
"""Packages that a picture of a stone needs nothing of."""
PICTURE = """
import sys
from culet.cli import app
app(["render", "--width", "8", "--height", "8", "--samples", "1", "-o", sys.argv[1]], standalone_mode=False)
print(*sys.modules)
"""


def test_a_picture_loads_nothing_of_what_it_does_not_need(tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-c", PICTURE, str(tmp_path / "stone.png")], capture_output=True, text=True, check=True
    )
    loaded = run.stdout.splitlines()[-1].split()
    assert "culet.rendering.renderer" in loaded
    assert [name for name in loaded if f"{name}.".startswith(tuple(f"{each}." for each in NOT_RENDERED_BY))] == []


PACKAGES = ("culet", "culet_kernels", "culet_protocol", "culet_client")


def sources(package: str) -> dict[str, Path]:
    """Files by module."""
    spec = find_spec(package)
    assert spec is not None
    assert spec.origin is not None
    folder = Path(spec.origin).parent
    found = {}
    for file in folder.rglob("*.py"):
        parts = (package, *file.relative_to(folder).with_suffix("").parts)
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = file
    return found


def imported(text: str) -> Iterator[tuple[str, str | None]]:
    """Modules, and what is taken of them, wherever a file imports them."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from ((alias.name, None) for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module is not None:
            yield from ((node.module, alias.name) for alias in node.names)


def graph() -> dict[str, set[str]]:
    """What each module of ours imports of ours."""
    files = {module: file for package in PACKAGES for module, file in sources(package).items()}
    needs: dict[str, set[str]] = {}
    for module, file in files.items():
        names = {
            f"{of}.{name}" if f"{of}.{name}" in files else of for of, name in imported(file.read_text(encoding="utf-8"))
        }
        needs[module] = {name for name in names if name in files and name != module}
    return needs


def part(module: str) -> str:
    """The part of the server that a module belongs to, such as `culet.rendering`; of other packages, all of it."""
    name, *rest = module.split(".")
    return ".".join((name, *rest[:1])) if name == "culet" else name


def room(module: str) -> str:
    """The room of a part, such as `culet.rendering.film`, or else the module itself; of other packages, all of it."""
    name, *rest = module.split(".")
    return ".".join((name, *rest[:2])) if name == "culet" else name


def imports_of(place: Callable[[str], str]) -> dict[str, set[str]]:
    """What each part or room imports."""
    needs: dict[str, set[str]] = {}
    for module, modules in graph().items():
        needs.setdefault(place(module), set()).update({place(other) for other in modules} - {place(module)})
    return needs


def circle(needs: dict[str, set[str]]) -> list[str]:
    """One, if there is any."""
    try:
        TopologicalSorter(needs).prepare()
    except CycleError as error:
        found: list[str] = error.args[1]
        return found
    return []


def test_no_module_needs_what_needs_it() -> None:
    needs = graph()
    assert "culet.optics.panoramas" in needs["culet.stage"], "or nothing would be seen here"
    assert circle(needs) == []


def test_no_part_needs_what_needs_it() -> None:
    needs = imports_of(part)
    assert {"culet.rendering", "culet.gateway", "culet.engine"} <= needs.keys()
    assert circle(needs) == []


def test_no_room_needs_what_needs_it() -> None:
    needs = imports_of(room)
    assert {"culet.rendering.film", "culet.gateway.routes", "culet.engine.session"} <= needs.keys()
    assert circle(needs) == []


def test_every_room_says_what_it_is_for() -> None:
    folders = {file.parent for package in PACKAGES for file in sources(package).values()}
    silent = [
        folder for folder in folders if not ast.get_docstring(ast.parse((folder / "__init__.py").read_text("utf-8")))
    ]
    assert silent == []


def test_no_module_of_the_page_needs_what_needs_it() -> None:
    folder = Path(__file__).parents[1] / "client" / "web" / "src"
    files = {file.stem: file for file in folder.glob("*.ts")}
    assert "main" in files
    imports = re.compile(r'from "\./([\w.-]+)"')
    assert circle({name: set(imports.findall(file.read_text(encoding="utf-8"))) for name, file in files.items()}) == []


def test_a_circle_is_found_wherever_it_is_closed() -> None:
    assert set(circle({"a": {"b"}, "b": {"c"}, "c": {"a"}, "d": set()})) == {"a", "b", "c"}
    inside = "def late():\n    from culet.rendering.programs import program\n"
    assert list(imported(inside)) == [("culet.rendering.programs", "program")]


def declared(requirements: list[str]) -> set[str]:
    """Names of distributions, as the index writes them."""
    return {re.sub(r"[-_.]+", "-", re.split(r"[^\w.-]", each, maxsplit=1)[0]).lower() for each in requirements}


OF_VIDEO = {"culet.engine.painting.video", "culet_client.film", "culet_client.video"}
"""Nothing else needs PyAV, and these do without until they are asked for video."""
OF_WORKERS = {"culet.batch.cluster"}
"""Nothing else needs Dask."""


def test_whatever_is_imported_is_declared() -> None:
    """Another package may need it today, and not tomorrow."""
    project = tomllib.loads((Path(__file__).parents[1] / "pyproject.toml").read_text())["project"]
    always = declared(project["dependencies"])
    for_studies = always | declared(project["optional-dependencies"]["study"] + ["mitsuba"])
    for_workers = always | declared([*project["optional-dependencies"]["batch"], "dask"])  # distributed needs its dask
    for_video = always | declared(project["optional-dependencies"]["video"])
    own = {*PACKAGES, *sys.stdlib_module_names}
    distributions = importlib.metadata.packages_distributions()
    missing = set()
    for module, file in [item for package in PACKAGES for item in sources(package).items()]:
        allowed = for_studies if part(module) == "culet.study" else for_video if module in OF_VIDEO else always
        allowed = for_workers if module in OF_WORKERS else allowed
        for name in {of.partition(".")[0] for of, _ in imported(file.read_text(encoding="utf-8"))} - own:
            if not declared(distributions.get(name, [name])) & allowed:
                missing.add((name, module))
    assert missing == set()
