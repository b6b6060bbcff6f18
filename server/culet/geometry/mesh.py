"""A mesh file, made into a shape or refused.

Files are untidy, and a picture of the wrong stone looks like a picture of the right one. So each step either proves
what the renderer relies on (one closed body, wound outward, not crossing itself, convex or not), repairs it and says so
in the shape's findings, or refuses with the defect's name.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from culet.errors import MeshError
from culet.geometry.assembly import Centre, assemble
from culet.geometry.closing import closed_bodies
from culet.geometry.convexity import Polyhedron, convex_form
from culet.geometry.crossing import crossing_triangles
from culet.geometry.facets import FLATNESS, facets_of, planes_of
from culet.geometry.flat_regions import retriangulated
from culet.geometry.formats import Soup, read_triangles
from culet.geometry.mass import surface_area
from culet.geometry.shape import Shape
from culet.geometry.surface import Points, SurfacePieces, Triangles, weld

MAX_TRIANGLES = 200_000
MAX_BYTES = 64 << 20

SMALLEST = 1e-8
"""A body smaller than this part of the mesh's extent is refused: double precision keeps less than 8 digits of it."""

FLAT = 1e-5
"""Mean thickness 3 V / A below which a body is flat, in units of R: a wafer of 1000:1 has 1.5e-3, a sheet in single
precision 1e-7."""


def shape_from_mesh(
    data: bytes,
    file_type: str,
    *,
    max_triangles: int = MAX_TRIANGLES,
    max_bytes: int = MAX_BYTES,
    centre: Centre = "mass",
    name: str = "mesh",
) -> Shape:
    """The shape in a mesh file: of several closed bodies the largest, scaled to circumradius 1.

    `file_type` is obj, off, stl, ply or glb. `centre` chooses the origin: the centre of mass, or the mean of the body's
    distinct vertices as in the report's program. Whether the stone is convex is decided and said in the findings, as is
    every repair. MeshError names the defect if there is no such stone; TooLargeError names the limit.
    """
    soup = read_triangles(data, file_type, max_triangles=max_triangles, max_bytes=max_bytes)
    findings = list(soup.findings)
    if soup.objects > 1:
        findings.append(f"The file shows {soup.objects} meshes; they were joined.")
    vertices = _scaled(soup.vertices[np.unique(soup.triangles)], soup.vertices)
    unused = len(vertices) - len(np.unique(soup.triangles))
    if unused:
        findings.append(f"{_number(unused, 'vertex', 'vertices')} that no face uses left out.")
    try:
        body, source = _largest_body(vertices, soup, findings)
        return _finished(name, body, source, centre, findings)
    except MeshError as error:
        if soup.doubt is None:
            raise
        raise MeshError(f"{error}; {soup.doubt}") from error


@dataclass(frozen=True, eq=False)
class _Body:
    """One closed, outward wound surface of about unit radius."""

    vertices: Points
    triangles: Triangles
    volume: float


def _scaled(used: Points, vertices: Points) -> Points:
    """Into the cube from -1 to 1, so that every later step may square and cube."""
    low, high = used.min(axis=0), used.max(axis=0)
    half = float((high / 2 - low / 2).max())
    if half == 0:
        raise MeshError("the mesh is flat: all its vertices are one point")
    if half < 1e-300:
        raise MeshError(f"the mesh has an extent of {2 * half:.3g}; expected 1e-300 or more")
    middle = low / 2 + high / 2
    with np.errstate(all="ignore"):  # vertices that no face uses may be anything
        scaled: Points = (vertices - middle) / half
    return scaled


def _largest_body(vertices: Points, soup: Soup, findings: list[str]) -> tuple[_Body, int]:
    """The closed body of the largest volume, and how many triangles the file had."""
    given = len(np.unique(soup.triangles))
    points, triangles = weld(vertices, soup.triangles)
    closed = closed_bodies(points, triangles, given)
    findings += closed.notes
    taken = int(np.argmax(closed.bodies.volume))
    _tell_others(closed.bodies, taken, findings)
    return _cut_out(closed.points, closed.bodies, taken, findings), len(soup.triangles)


def _tell_others(bodies: SurfacePieces, taken: int, findings: list[str]) -> None:
    number = len(bodies.volume)
    if number == 1:
        return
    closed = int(bodies.closed.sum())
    sizes = np.bincount(bodies.piece)
    left = [f"{_number(closed - 1, 'smaller closed body', 'smaller closed bodies')}"] if closed > 1 else []
    if number > closed:
        rest = int(sizes[~bodies.closed].sum())
        left.append(
            f"{_number(number - closed, 'surface that is', 'surfaces that are')} not closed "
            f"({_number(rest, 'triangle', 'triangles')})"
        )
    findings.append(
        f"The file has {number} bodies: the largest closed one by volume taken "
        f"({_number(int(sizes[taken]), 'triangle', 'triangles')}), {' and '.join(left)} left out."
    )


def _cut_out(points: Points, bodies: SurfacePieces, taken: int, findings: list[str]) -> _Body:
    own = bodies.triangles[bodies.piece == taken]
    turned = int(bodies.reversed_triangles[taken])
    if turned == len(own):
        findings.append("The surface was inside out: every triangle's winding reversed.")
    elif turned:
        findings.append(f"Winding repaired: {turned} of {len(own)} triangles were wound the other way.")
    used, compact = np.unique(own, return_inverse=True)
    vertices = points[used]
    vertices = vertices - (vertices.max(axis=0) + vertices.min(axis=0)) / 2
    radius = float(np.linalg.norm(vertices, axis=1).max())
    if not radius > SMALLEST:
        raise MeshError(
            f"the largest closed body is {radius:.1e} of the mesh's extent, too small to be read exactly; "
            f"expected {SMALLEST:g} or more: remove what lies far away"
        )
    body = _Body(vertices / radius, compact.reshape(-1, 3), float(bodies.volume[taken]) / radius**3)
    area = surface_area(body.vertices, body.triangles)
    thickness = 3 * body.volume / area if area > 0 else 0.0
    if not thickness > FLAT:
        raise MeshError(f"the mesh is flat: it encloses no volume (mean thickness {thickness:.1e} R)")
    return body


def _finished(name: str, body: _Body, source: int, centre: Centre, findings: list[str]) -> Shape:
    origin = body.vertices.mean(axis=0) if centre == "vertex_mean" else None
    form = convex_form(body.vertices, body.triangles, body.volume)
    if isinstance(form, Polyhedron):
        if form.dent > FLATNESS:
            findings.append(f"Dents of up to {form.dent:.1e} R filled: within what counts as convex.")
        findings.append(f"Convex: {source} triangles in the file, {len(form.planes)} facets.")
        return assemble(
            name, form.vertices, form.triangles, form.facet_of_triangle, form.planes,
            convex=True, centre=origin, findings=findings,
        )  # fmt: skip
    triangles, recut = retriangulated(body.vertices, body.triangles)
    if recut:
        findings.append(f"{_number(recut, 'flat polygon', 'flat polygons')} cut into triangles again.")
    crossing = crossing_triangles(body.vertices, triangles)
    if crossing is not None:
        where = body.vertices[triangles[crossing[0]]].mean(axis=0)
        shown = ", ".join(f"{x:.3g}" for x in where)
        raise MeshError(f"the mesh crosses itself: two of its faces meet near ({shown}) in units of its radius")
    facet = facets_of(body.vertices, triangles, FLATNESS)
    planes = planes_of(body.vertices, triangles, facet, int(facet.max()) + 1)
    if not planes[:, :3].any(axis=1).all():
        raise MeshError("the mesh has facets without area that no repair removed; clean it and export it again")
    findings.append(
        f"Not convex: dented by {form.depth:.1e} R or more; {source} triangles in the file, {len(planes)} facets."
    )
    return assemble(
        name, body.vertices, triangles.astype(np.int32), facet.astype(np.int32), planes,
        convex=False, centre=origin, findings=findings,
    )  # fmt: skip


def _number(count: int, one: str, many: str) -> str:
    return f"{count} {one if count == 1 else many}"
