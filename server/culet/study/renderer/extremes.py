"""`python -m culet.study.renderer.extremes`: scenes at the ends of what is allowed, and their wrong pixels.

Almost all of them are under a uniform sky of radiance 1, where a clear stone cannot be seen: a pixel and what its
chains cut are 1 together, or it is a speck, black or white. Where something is dark (an absorbing stone, a floor) a
pixel is a speck if it is brighter than anything can be there, and negative if a band must be.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from culet.geometry.polygons import edges_of_facets
from culet.geometry.shape import Shape
from culet.rendering.chains import GROUPS, chain_table, is_spectral
from culet.rendering.features import Features, Geometry, features_of
from culet.rendering.renderer import Renderer
from culet.scene.legacy import legacy
from culet.scene.model import Scene
from culet.stage import Library, Stage
from culet.study.solids import ball, box, brilliant, scaled, tetrahedron

Array = NDArray[np.float64]
SceneSettings = Mapping[str, Any]

MODES: Mapping[str, SceneSettings] = {
    "scalar": {},
    "spectral": {"bands": 8},
    "polarised": {"polarised": True},
    "triangles": {},
}
"""Name -> optics. The last one takes the stone through the tree that stones need which are not convex."""
ROUNDING = 2e-6
"""Of radiance 1 in single precision: sums of up to a thousand parts of a chain, each rounded to 6e-8."""
LOST = 10
"""Cut-offs. A chain in a convex stone ends once, with less weight than the cut-off (up to 2.6 of them, summed over the
weights of wavelengths or counted for polarisation). A pixel that cuts more has lost a ray between two facets."""


MESH = "extreme"
"""In place of the id of an upload: the shape of a case."""


@dataclass(frozen=True)
class SceneExtreme:
    """One case: a shape, a scene without it, and where to look from."""

    name: str
    shape: Callable[[], Shape]
    settings: SceneSettings = field(default_factory=dict)
    """Of the stone of this shape."""
    scene: SceneSettings = field(default_factory=dict)
    """What else is not as usual."""
    cameras: Callable[[Shape], Iterator[SceneSettings]] | None = None
    """Several small pictures instead of one from the side."""
    brightest: float | None = None
    """Where a pixel may be darker than 1: the most that it may be."""


@dataclass(frozen=True)
class PixelCount:
    """Pixels of one case in one mode."""

    pixels: int = 0
    not_finite: int = 0
    negative: int = 0
    specks: int = 0
    farthest: float = 0
    """Radiance by which a pixel goes beyond its bounds, at most; below ROUNDING it is no speck."""

    def plus(self, other: PixelCount) -> PixelCount:
        """Both together."""
        return PixelCount(
            self.pixels + other.pixels,
            self.not_finite + other.not_finite,
            self.negative + other.negative,
            self.specks + other.specks,
            max(self.farthest, other.farthest),
        )

    @property
    def wrong(self) -> int:
        """All that should not be there."""
        return self.not_finite + self.negative + self.specks


def at_vertices(shape: Shape) -> Iterator[SceneSettings]:
    """From outside and from the centre at every vertex; the middle of the picture meets it."""
    for vertex in shape.vertices:
        yield _camera(3 * vertex / np.linalg.norm(vertex) + 0.3, vertex)
        yield _camera(np.zeros(3), vertex)


def along_edges(shape: Shape) -> Iterator[SceneSettings]:
    """At the middle of every edge, from outside and from the centre, and along it."""
    for a, b in shape.vertices[edges_of_facets(shape)[:, :2]]:
        middle = (a + b) / 2
        yield _camera(3 * middle / np.linalg.norm(middle), middle)
        yield _camera(np.zeros(3), middle)
        yield _camera(a + 2 * (a - b) / np.linalg.norm(a - b), b)


def on_facets(shape: Shape) -> Iterator[SceneSettings]:
    """The eye on each facet's plane, above the stone's centre: looking out, in, and along."""
    for *normal, offset in shape.planes:
        eye, out = offset * np.array(normal), np.array(normal)
        across = np.cross(out, np.eye(3)[np.abs(out).argmin()])
        for direction in (out, -out, across):
            yield _camera(eye, eye + direction, fov_degrees=100)


def grazing(shape: Shape) -> Iterator[SceneSettings]:
    """At 89.9999 degrees from each facet's normal, on the point abreast of the stone's centre."""
    for *normal, offset in shape.planes:
        out = np.array(normal)
        across = np.cross(out, np.eye(3)[np.abs(out).argmin()])
        across /= np.linalg.norm(across)
        angle = np.radians(89.9999)
        point = offset * out
        yield _camera(point + 3 * (np.cos(angle) * out + np.sin(angle) * across), point)


def inside(_: Shape) -> Iterator[SceneSettings]:
    """Nearly all directions from the centre and from beside it."""
    for eye in ((0, 0, 0), (0.2, 0.05, -0.1)):
        for direction in (*np.eye(3), *-np.eye(3)):
            yield _camera(np.array(eye), np.array(eye) + direction, fov_degrees=110)


def far(_: Shape) -> Iterator[SceneSettings]:
    """From a million radii: the stone fills a tenth of the narrowest picture."""
    for direction in ((0.3, 0.8, 0.5196), (0, 1, 0), (1, 0, 0)):
        yield _camera(1e6 * np.array(direction), np.zeros(3))


def _camera(position: Array, target: Array, fov_degrees: float = 1e-3) -> SceneSettings:
    forward = target - position
    up = np.eye(3)[np.abs(forward).argmin()]
    return {
        "position": position.tolist(),
        "target": target.tolist(),
        "up": up.tolist(),
        "fov_degrees": fov_degrees,
    }


def _index(n: float) -> SceneSettings:
    return {"material": {"ior": [n, n, n]}}


EXTREMES = (
    SceneExtreme("index 1", brilliant, _index(1)),
    SceneExtreme("index 1 + 1e-6", brilliant, _index(1 + 1e-6)),
    SceneExtreme("index 4", brilliant, _index(4)),
    SceneExtreme("index 10", brilliant, _index(10)),
    SceneExtreme("absorption 0", brilliant),
    SceneExtreme("absorption 1e6 per R", brilliant, {"absorption": [1e6] * 3}, brightest=1),
    SceneExtreme("1e-6 in size", scaled(1e-6)),
    SceneExtreme("1e6 in size", scaled(1e6)),
    SceneExtreme("needle, 1000 : 1", box(1, 1e-3, 1e-3)),
    SceneExtreme("wafer, 1000 : 1", box(1, 1e-3, 1)),
    SceneExtreme("4 facets", tetrahedron),
    SceneExtreme("5000 facets", ball(5000)),
    SceneExtreme("rays at every vertex", brilliant, cameras=at_vertices),
    SceneExtreme("rays at and along every edge", brilliant, cameras=along_edges),
    SceneExtreme("camera inside", brilliant, cameras=inside),
    SceneExtreme("camera on every facet", brilliant, cameras=on_facets),
    SceneExtreme("camera at 1e6 radii", brilliant, cameras=far),
    SceneExtreme("grazing every facet, 89.9999 degrees", brilliant, cameras=grazing),
    SceneExtreme(
        "light inside the stone",
        brilliant,
        scene={
            "floor": {"kind": "matte"},
            "emitters": [{"shape": "point", "position": [0, 0.01, 0], "colour": [1, 1, 1]}],
        },
        brightest=0.9 * 2,  # the lighter albedo in all the light that there is: the sky's and the point's
    ),
    SceneExtreme("light at the stone's vertex", brilliant,
            scene={"floor": {"kind": "matte"}, "emitters": [{"shape": "point", "colour": [1, 1, 1],
                                                             "position": brilliant().vertices[0].tolist()}]},
            brightest=0.9 * 2),
)  # fmt: skip

_FROM_THE_SIDE: SceneSettings = {"position": [0.7, 1.6, 2.4], "target": [0, 0, 0], "fov_degrees": 40}


def count(
    renderer: Renderer,
    extreme: SceneExtreme,
    mode: str,
    cutoff: float = 1e-3,
    program: Callable[[Features], Features] = lambda needed: needed,
) -> PixelCount:
    """Render a case in a mode of MODES, by the `program` for what it needs, and judge every pixel."""
    shape = extreme.shape()
    library = Library({MESH: shape})
    cameras = extreme.cameras(shape) if extreme.cameras else iter([_FROM_THE_SIDE])
    size = (5, 5) if extreme.cameras else (96, 54)
    total = PixelCount()
    for camera in cameras:
        scene = legacy(
            {
                "floor": {"kind": "none"},
                "emitters": [],
                "environment": {"kind": "constant"},
                **extreme.scene,
                "camera": camera,
                "stones": [{"mesh": MESH, "position": [0, 0, 0], "orientation": [1, 0, 0, 0], **extreme.settings}],
                # Flecks of caustics have no bound of their own: tests hold them to what the light brings.
                "optics": {"cutoff": cutoff, "max_bounces": 65536, "caustics": "off", **MODES[mode]},
            }
        )
        stage = Stage.of(scene, library)
        features = features_of(stage)
        if mode == "triangles":
            features = replace(features, geometry=Geometry.MESH)
        picture = renderer.picture(stage, *size, features=program(features))
        picture.refine()
        pixels, cut = picture.linear().astype(np.float64), picture.cut_map().astype(np.float64)
        total = total.plus(_judged(scene, extreme.brightest, pixels, cut))
    return total


def _judged(scene: Scene, brightest: float | None, pixels: Array, cut: Array) -> PixelCount:
    """(height, width, 3) radiance and (height, width) cut weight, the mean over the channels.

    A pixel of sampled wavelengths is a sum of radiances by weights of both signs, those of each channel 1 together. So
    what is cut may make it brighter, and light from 0 to L gives it from -L times the negative weights to L times the
    positive ones.
    """
    finite = np.isfinite(pixels).all(axis=-1) & np.isfinite(cut)
    lowest, highest = 0.0, brightest or 1.0
    if is_spectral(scene):
        chains = chain_table(scene, 0, np.float64, common=False)
        by_group = [chains["share"][group::GROUPS] for group in range(GROUPS)]
        lowest = highest * min(np.minimum(share, 0).sum(axis=0).min() for share in by_group)
        highest = highest * max(np.maximum(share, 0).sum(axis=0).max() for share in by_group)
    if brightest is not None:
        beyond = np.maximum(pixels - highest, lowest - pixels).max(axis=-1)
    elif is_spectral(scene):
        beyond = (abs(pixels - 1) - 3 * cut[..., None]).max(axis=-1)
    else:
        # Of polarised light, what is counted is the most that it could have become: up to twice what is missing.
        missing, least = 1 - pixels.mean(axis=-1), cut / 2 if scene.optics.polarised else cut
        beyond = np.max([missing - cut, least - missing, (pixels - 1).max(axis=-1)], axis=0)
    if brightest is None:
        lost = cut > LOST * scene.optics.cutoff
        beyond = np.where(lost, np.maximum(beyond, cut), beyond)
    beyond = np.where(finite, np.maximum(beyond, 0), 0)
    return PixelCount(
        pixels=finite.size,
        not_finite=int((~finite).sum()),
        negative=int(((pixels < (lowest - ROUNDING if is_spectral(scene) else 0)).any(axis=-1) | (cut < 0)).sum()),
        specks=int((beyond > ROUNDING).sum()),
        farthest=float(beyond.max()),
    )


def table(renderer: Renderer) -> Iterator[str]:
    """Lines of Markdown: for each case and mode the pixels that are not finite, negative, and specks."""
    yield "| case | pixels | " + " | ".join(MODES) + " | farthest |"
    yield "|---|" + "---|" * (len(MODES) + 2)
    for extreme in EXTREMES:
        counts = [count(renderer, extreme, mode) for mode in MODES]
        cells = [f"{c.not_finite} / {c.negative} / {c.specks}" for c in counts]
        farthest = max(c.farthest for c in counts)
        yield f"| {extreme.name} | {counts[0].pixels} | " + " | ".join(cells) + f" | {farthest:.1e} |"


if __name__ == "__main__":
    for line in table(Renderer()):
        print(line, flush=True)
