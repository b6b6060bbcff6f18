"""A mesh from the user's disk becomes the stone, or is refused with what is wrong with it."""

from __future__ import annotations

from pathlib import Path

import pytest

from e2e.conftest import WITH_PANEL, ViewOf
from e2e.server import Server
from e2e.view import View, difference

CORNERS = ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))
OCTAHEDRON = ((0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5))

FLAT = ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))
"""A tetrahedron, closed, with all corners in the plane z = 0."""


def ply(faces: tuple[tuple[int, int, int], ...]) -> str:
    """An ASCII .ply of those triangles between the corners."""
    header = (
        "ply", "format ascii 1.0", f"element vertex {len(CORNERS)}", *(f"property float {axis}" for axis in "xyz"),
        f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header",
    )  # fmt: skip
    lines = [*(" ".join(map(str, corner)) for corner in CORNERS), *("3 " + " ".join(map(str, face)) for face in faces)]
    return "\n".join([*header, *lines, ""])


@pytest.fixture
def wide_view(view_of: ViewOf) -> View:
    """With the panel, whose buttons open files."""
    return view_of(viewport=WITH_PANEL).open()


def test_a_mesh_becomes_the_stone_and_its_findings_are_shown(wide_view: View, server: Server, tmp_path: Path) -> None:
    view = wide_view
    material = view.scene["stones"][0]["material"]
    file = tmp_path / "octahedron.ply"
    file.write_text(ply(OCTAHEDRON))
    told: list[str] = []

    def open_the_mesh() -> None:
        view.open_file("Open a mesh", file)
        told.append(view.page.locator(".toast.finding").inner_text())  # now: it goes by itself

    before, after = view.change(open_the_mesh)
    assert told[0].startswith("octahedron.ply:")
    assert "8 facets" in told[0]
    stone = server.session(view.session)["scene"]["stones"][0]
    assert stone["mesh"] == view.scene["stones"][0]["mesh"]
    assert stone["material"] == material
    assert difference(before.pixels, after.pixels) > 1
    assert view.problems == []


@pytest.mark.parametrize(
    ("name", "text", "complaint"),
    [
        pytest.param("open.ply", ply(OCTAHEDRON[:-1]), "the surface is open: 3 boundary edges", id="open"),
        pytest.param("flat.ply", ply(FLAT), "flat", id="flat"),
        pytest.param("empty.ply", "", "the file is empty", id="empty"),
        pytest.param("photo.ply", "\x00\x01 not a mesh", "expected a PLY header", id="no-mesh"),
        pytest.param(
            "stone.jpg",
            "no mesh at all",
            "expected a name that ends with one of .obj, .off, .stl, .ply, .glb, .asc, .gem, .gcs",
            id="ending",
        ),
    ],
)
def test_a_broken_mesh_is_refused_with_what_is_wrong(
    wide_view: View, tmp_path: Path, name: str, text: str, complaint: str
) -> None:
    view = wide_view
    view.refusals.add(422)
    before = view.scene
    file = tmp_path / name
    file.write_text(text)
    view.open_file("Open a mesh", file)
    toast = view.page.locator(".toast.problem")
    toast.wait_for()
    assert toast.inner_text().startswith(f"{name}: ")
    assert complaint in toast.inner_text()
    assert view.scene == before
    view.page.keyboard.press("m")
    view.until("() => culet.state.scene.floor.kind === 'mirror'")  # the session goes on
