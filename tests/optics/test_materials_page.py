"""The page of tables is what the code says."""

from __future__ import annotations

from pathlib import Path

from culet.optics.materials import MATERIALS
from culet.optics.materials_page import page

DOCUMENT = Path(__file__).parents[2] / "docs" / "reference" / "materials.md"


def test_the_document_is_up_to_date() -> None:
    """If not: python -m culet.optics.materials_page > docs/reference/materials.md"""
    assert DOCUMENT.read_text(encoding="utf-8") == page()


def test_every_material_stands_in_it_with_its_source() -> None:
    text = page()
    for name, material in MATERIALS.items():
        assert f"| {name} | " in text
        assert material.source in text
