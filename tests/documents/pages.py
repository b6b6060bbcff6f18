"""The documents, and their examples as a reader would run them."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[2]
DOCUMENTS = ("README.md", *sorted(str(page.relative_to(ROOT)) for page in (ROOT / "docs").glob("*/*.md")))
"""Their names; what is built is deeper down, in docs/_build."""


def read(document: str) -> str:
    """The text of one, by its name from the root."""
    return (ROOT / document).read_text(encoding="utf-8")


def blocks(document: str, language: str) -> list[str]:
    """Its code blocks of that language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", read(document), re.DOTALL | re.MULTILINE)


def run(script: str, folder: Path, shell: str = "sh") -> None:
    """Run an example as a reader would, with this environment's commands."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    environment = os.environ | {"PATH": path}
    command = [shell, "-e", "-u", "-c", script]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"


def size_and_format(file: Path) -> tuple[tuple[int, int], str | None]:
    """What Pillow takes a file for."""
    with Image.open(file) as image:
        return image.size, image.format
