"""The package's description: README.md, with links that lead somewhere from wherever it is shown."""

from __future__ import annotations

import importlib.util
import re
from types import ModuleType

import pytest

from documents.pages import ROOT, read


@pytest.fixture(scope="module")
def build() -> ModuleType:
    spec = importlib.util.spec_from_file_location("hatch_build", ROOT / "hatch_build.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_with_a_home_every_link_is_absolute(build: ModuleType) -> None:
    shown = build.readme(read("README.md"), "https://git.example/culet/blob/main/")
    links = re.findall(r"\]\(([^)]+)\)", shown)
    assert "https://git.example/culet/blob/main/docs/how-to/rest.md" in links
    assert [link for link in links if not link.startswith("https://")] == []


def test_without_a_home_there_are_words_and_no_dead_links(build: ModuleType) -> None:
    shown = build.readme(read("README.md"), None)
    assert [link for link in re.findall(r"\]\(([^)]+)\)", shown) if not link.startswith("https://")] == []
    assert "![" not in shown
    assert "your first stone, a notebook" in shown
