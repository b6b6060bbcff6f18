"""What README.md and the pages of docs/ say is so: the default scene, the keys, the commands, the files they link to.

Their examples run; those of REST are run by the end-to-end tests.
"""

from __future__ import annotations

import json
import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest
import typer

from culet.cli import app
from culet.scene import PRESETS, Scene
from culet.scene.cuts import BrilliantCut
from documents.pages import DOCUMENTS, ROOT, blocks, read, run, size_and_format

PRINTED = {"←": "arrowleft", "→": "arrowright", "↑": "arrowup", "↓": "arrowdown"}
SCENE, KEYS, COMMANDS = "docs/reference/scene.md", "docs/reference/page.md", "docs/how-to/command-line.md"


def test_the_default_scene_is_written_out_in_full() -> None:
    default = Scene().model_dump(mode="json")
    assert json.loads(blocks(SCENE, "json")[0]) == default, "make format writes it"


def test_the_default_cut_is_written_out_in_full() -> None:
    (written,) = re.findall(r"^\| `cut` \| `(.*)` \|$", read(SCENE), re.MULTILINE)
    assert json.loads(written) == BrilliantCut().model_dump(mode="json")


def test_the_table_of_keys_names_the_keys_of_the_page_and_no_others() -> None:
    table = re.findall(r"^\| (.*?) \|", read(KEYS), re.MULTILINE)
    keys = {key for row in table for key in re.findall(r"`([^`]+)`", row)}
    written = {PRINTED.get(key, key.lower()) for key in keys if len(key) == 1}
    actions = (ROOT / "client/web/src/input/actions.ts").read_text(encoding="utf-8")
    page = {key.lower() for key in re.findall(r'(?:letter|plain)\("\w+", "(\w)"', actions)}
    page |= {key.lower() for key in re.findall(r'move\("\w+", "(\w+)"', actions)}
    page |= set(re.findall(r'select\("\w+", "(\w)"', actions))
    page |= set(re.findall(r'key\("\w+", "(\W)"', actions))
    assert len(page) >= 24
    assert written == page
    chords = {key.lower().replace(" ", "+") for key in keys if key.startswith("Ctrl")}
    assert chords == set(re.findall(r'edit\("\w+", "(.+?)"', actions))


def test_every_command_and_option_is_one_that_exists() -> None:
    commands = [command for document in DOCUMENTS for command in re.findall(r"`(culet [a-z][^`]*)`", read(document))]
    blocks_of_shell = [block for document in DOCUMENTS for block in blocks(document, "sh")]
    commands += [part for block in blocks_of_shell for part in re.findall(r"(?<![\w/.-])culet [a-z].*", block)]
    assert len(commands) >= 60
    for command in commands:
        known, words = typer.main.get_command(app), shlex.split(command, comments=True)[1:]
        while words and hasattr(known, "get_command"):  # `culet study rendering`
            known = known.get_command(None, words.pop(0))
            assert known is not None, command
        options = {option for parameter in known.params for option in (*parameter.opts, *parameter.secondary_opts)}
        named = {word.partition("=")[0] for word in words if re.match(r"-{1,2}[a-z]", word)}
        assert named <= options | {"-h", "--help"}, command


def test_every_file_that_is_linked_to_is_there() -> None:
    for document in DOCUMENTS:
        links = [link for link in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", read(document)) if "://" not in link]
        assert [link for link in links if not ((ROOT / document).parent / link).is_file()] == [], document


def test_every_folder_and_target_named_is_there() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    targets = {target for document in DOCUMENTS for target in re.findall(r"`make ([a-z-]+)", read(document))}
    assert {target for target in targets if f"\n{target}:" not in makefile} == set()
    folders = re.findall(r"^\| `([a-z/]+/)` \|", read("docs/explanation/how-it-works.md"), re.MULTILINE)
    assert len(folders) == 5
    assert [folder for folder in folders if not (ROOT / folder).is_dir()] == []


def test_every_preset_that_an_example_names_exists() -> None:
    for document in DOCUMENTS:
        named = set(re.findall(r'preset[= ](\w[\w-]*)|"preset": "(\w[\w-]*)"', "\n".join(blocks(document, "sh"))))
        assert {name for pair in named for name in pair if name} <= set(PRESETS), document


def test_the_figures_of_the_readme_are_of_the_last_study() -> None:
    """`culet study headline --into docs/explanation/study.md` writes that one's."""
    study = read("docs/explanation/study.md")
    figures = re.findall(r"^\| .* \| [\d.]+ m?s \|$", read("README.md"), re.MULTILINE)
    assert len(figures) == 4
    assert [line for line in figures if line not in study] == []


def test_the_examples_of_the_command_line_run(tmp_path: Path) -> None:
    (tmp_path / "tetrahedron.obj").write_text(
        "v 1 1 1\nv -1 -1 1\nv -1 1 -1\nv 1 -1 -1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    )
    run(blocks(COMMANDS, "sh")[0], tmp_path)
    assert size_and_format(tmp_path / "matte.png") == ((320, 180), "PNG")
    assert size_and_format(tmp_path / "tetrahedron.tga") == ((640, 360), "TGA")
    assert (tmp_path / "wide-table.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01", "OpenEXR's magic number"
    assert (tmp_path / "path.csv").read_text().count("\n") > 3 / (1 / 30), "a line for every step, and a header"


def test_the_commands_of_the_readme_run(tmp_path: Path) -> None:
    (block,) = (block for block in blocks("README.md", "sh") if block.startswith("culet "))
    run(block, tmp_path)
    assert size_and_format(tmp_path / "ruby.png") == ((320, 240), "PNG")
    assert (tmp_path / "path.csv").is_file()


@pytest.mark.parametrize("document", ["README.md", "docs/how-to/python.md"])
def test_the_examples_of_python_run(tmp_path: Path, document: str) -> None:
    """In one process, in their order."""
    examples = blocks(document, "python")
    assert examples
    done = subprocess.run(
        [sys.executable, "-c", "\n".join(examples)], cwd=tmp_path, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    made, kind = {"README.md": ("sapphire.webp", "WEBP"), "docs/how-to/python.md": ("in-the-air.png", "PNG")}[document]
    assert size_and_format(tmp_path / made) == ((320, 240), kind)
