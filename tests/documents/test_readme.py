"""What README.md says is so: the default scene, the keys, the commands, the files it links to; its command lines run.

The end-to-end tests run its examples of REST.
"""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer
from PIL import Image

from culet.cli import app
from culet.scene import PRESETS, Scene
from culet.scene.stone import BrilliantCut

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PRINTED = {"←": "arrowleft", "→": "arrowright", "↑": "arrowup", "↓": "arrowdown"}


def block(heading: str, language: str) -> str:
    """The first code block of that language under a heading."""
    section = README.split(f"\n## {heading}\n")[1].split("\n## ")[0]
    found = re.search(rf"```{language}\n(.*?)```", section, re.DOTALL)
    assert found, f"no {language} under {heading}"
    return found[1]


def test_the_default_scene_is_written_out_in_full() -> None:
    default = Scene().model_dump(mode="json")
    assert json.loads(block("The scene", "json")) == default, "make format writes it"


def test_the_default_cut_is_written_out_in_full() -> None:
    (written,) = re.findall(r"^\| `cut` \| `(.*)` \|$", README, re.MULTILINE)
    assert json.loads(written) == BrilliantCut().model_dump(mode="json")


def test_the_table_of_keys_names_the_keys_of_the_page_and_no_others() -> None:
    table = re.findall(r"^\| (.*?) \|", README.split("\n## Keys\n")[1].split("\n## ")[0], re.MULTILINE)
    keys = {key for row in table for key in re.findall(r"`([^`]+)`", row)}
    written = {PRINTED.get(key, key.lower()) for key in keys if len(key) == 1}
    actions = (ROOT / "client/web/src/actions.ts").read_text(encoding="utf-8")
    page = {key.lower() for key in re.findall(r'(?:letter|plain)\("\w+", "(\w)"', actions)}
    page |= {key.lower() for key in re.findall(r'move\("\w+", "(\w+)"', actions)}
    page |= set(re.findall(r'select\("\w+", "(\w)"', actions))
    page |= set(re.findall(r'key: "(\W)"', actions))
    assert len(page) == 24
    assert written == page
    chords = {key.lower().replace(" ", "+") for key in keys if key.startswith("Ctrl")}
    assert chords == set(re.findall(r'edit\("\w+", "(.+?)"', actions))


def test_every_command_is_one_that_exists() -> None:
    commands = re.findall(r"`(culet [a-z][^`]*)`", README)
    commands += [part for line in block("Command line", "sh").splitlines() for part in re.findall(r"culet .*", line)]
    group = typer.main.get_command(app)
    assert len(commands) >= 8
    for command in commands:
        _, name, *rest = shlex.split(command, comments=True)
        known = group.get_command(None, name)  # type: ignore[attr-defined]
        assert known is not None, command
        if rest:
            known.make_context(name, rest)


def test_every_file_that_is_linked_to_is_there() -> None:
    links = [link for link in re.findall(r"\]\(([^)]+)\)", README) if "://" not in link]
    assert len(links) >= 5
    assert [link for link in links if not (ROOT / link).is_file()] == []


def test_every_folder_and_target_named_is_there() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"`make ([a-z-]+)", README))
    assert {target for target in targets if f"\n{target}:" not in makefile} == set()
    folders = re.findall(r"^\| `([a-z/]+/)` \|", README, re.MULTILINE)
    assert len(folders) == 5
    assert [folder for folder in folders if not (ROOT / folder).is_dir()] == []


def test_every_preset_that_an_example_names_exists() -> None:
    named = set(re.findall(r'preset[= ](\w[\w-]*)|"preset": "(\w[\w-]*)"', README))
    assert {name for pair in named for name in pair if name} <= set(PRESETS)


def run(script: str, folder: Path) -> None:
    """Run an example as a reader would, with this environment's commands."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path}
    command = ["sh", "-e", "-u", "-c", script]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


def size_and_format(file: Path) -> tuple[tuple[int, int], str | None]:
    """What Pillow takes a file for."""
    with Image.open(file) as image:
        return image.size, image.format


def test_the_examples_of_the_command_line_run(tmp_path: Path) -> None:
    (tmp_path / "tetrahedron.obj").write_text(
        "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    run(block("Command line", "sh"), tmp_path)
    assert size_and_format(tmp_path / "matte.png") == ((320, 180), "PNG")
    assert size_and_format(tmp_path / "tetrahedron.tga") == ((640, 360), "TGA")
    assert (tmp_path / "wide-table.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01", "OpenEXR's magic number"
    assert (tmp_path / "path.csv").read_text().count("\n") > 3 / (1 / 30), "a line for every step, and a header"


@pytest.mark.parametrize("document", ["README.md", "docs/how-to/python.md"])
def test_the_examples_of_python_run(tmp_path: Path, document: str) -> None:
    """In one process, in their order."""
    text = (ROOT / document).read_text(encoding="utf-8")
    examples = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert examples
    done = subprocess.run(
        [sys.executable, "-c", "\n".join(examples)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    if document == "README.md":
        assert size_and_format(tmp_path / "ruby.webp") == ((320, 240), "WEBP")
        assert size_and_format(tmp_path / "in-the-air.png") == ((320, 240), "PNG")
