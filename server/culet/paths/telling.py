"""From what the kernel wrote down to what a reader wants: steps at which chains go together, angles, names, shares."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from typing import assert_never

import numpy as np
from numpy.typing import NDArray

from culet.optics.observer import LUMINANCE, linear_srgb
from culet.paths.answer import Chain, Channel, Kind, Met, Part, Pass, Path, Pose, Step, Vector
from culet.paths.recorder import KINDS, PixelRecord
from culet.paths.surface_optics import cosine_in_air, cosine_in_stone, critical_degrees, degrees, reflectance
from culet.paths.surroundings import WALLS, RaySurroundings, side_of
from culet.rendering.chains import GROUPS, chains_of_stones
from culet.rendering.renderer import jitter
from culet.rendering.stones.placed_stone import PlacedStone
from culet.scene.emitters import PointLight

Array = NDArray[np.float64]

KIND: dict[int, Kind] = {
    KINDS["ENTERS"]: "enters",
    KINDS["MEETS"]: "meets",
    KINDS["SEES"]: "sees",
    KINDS["LANDS"]: "lands",
    KINDS["ENDS"]: "ends",
    KINDS["CHANCE"]: "chance",
}
CHANNELS: tuple[Channel, ...] = ("red", "green", "blue")
FAR = 3.0
"""R at which a ray to the sky is drawn to end."""
SHORT = 0.25
"""R at which one is that is dropped."""
ROUNDED = 4e-6
"""Part of a ray's light below which what sources leave over is single precision's rounding, and no light of the sky."""

EndSource = tuple[Met, int | None]


def path_of(record: PixelRecord, *, pixel: bool = True) -> Path:
    """All that happened, told; without `pixel` of a ray that was given as such."""
    return _Teller(record).path(pixel=pixel)


@dataclass
class _Draft:
    """A step under way."""

    number: int
    parent: int | None
    kind: Kind
    stone: PlacedStone | None
    facet: int | None
    inside: bool
    passes: list[Pass] = field(default_factory=list)
    light: dict[EndSource, Array] = field(default_factory=dict)


class _Teller:
    def __init__(self, record: PixelRecord) -> None:
        self._record = record
        self._scene = record.stage.scene
        self._origin = record.projection.origin
        self._surroundings = RaySurroundings(self._scene, record.parameters)
        self._camera_ray = _camera_ray(record)
        self._sets = chains_of_stones(self._scene)[0]
        self._rows = _rows(record)
        self._number_of_row = {row: number for number, row in enumerate(self._rows)}
        self._facets: dict[tuple[int, bytes], int] = {}
        self._total = float(record.value @ LUMINANCE)

    def path(self, *, pixel: bool) -> Path:
        record = self._record
        steps = self._steps()
        parts: dict[EndSource, Array] = {}
        for step in steps:
            for source, light in step.light.items():
                parts[source] = parts.get(source, np.zeros(3)) + light
        if record.left_out:
            parts["untold", None] = record.value - sum(parts.values(), np.zeros(3))
        whole = sorted(self._parts(parts), key=lambda part: -part.share)
        eye, direction = self._camera_ray
        return Path(
            pixel=record.pixel if pixel else None,
            origin=_vector(eye),
            direction=_vector(direction),
            value=_vector(record.value),
            cut=record.cut,
            chains=self._chains(),
            steps=tuple(self._told(step) for step in steps),
            parts=tuple(whole),
            left_out=record.left_out,
            poses={each.id: Pose(each.position, each.orientation, each.scale) for each in self._scene.stones},
            polarised=record.polarised,
        )

    def _chains(self) -> tuple[Chain, ...]:
        record, told = self._record, []
        for row in self._rows:
            indices = {stone.settings.id: self._index(stone, row) for stone in record.stones}
            if record.wavelengths is None:
                told.append(Chain(None, CHANNELS[row], _vector(np.eye(3)[row]), indices))
            else:
                wavelength = record.wavelengths[row]
                colour = np.clip(linear_srgb(wavelength), 0, None)
                brightest = colour.max()
                shown = colour / brightest if brightest > 0 else np.ones(3)
                told.append(Chain(wavelength, None, _vector(shown), indices))
        return tuple(told)

    def _index(self, stone: PlacedStone, row: int) -> float:
        """Of refraction, of a chain in a stone."""
        rows = int(self._record.parameters["chains"])
        return float(self._record.chains["eta"][self._sets[stone.number] * rows + row])

    def _steps(self) -> list[_Draft]:
        """Events of several chains that come from one step and happen at one facet are one step."""
        steps: list[_Draft] = []
        known: dict[object, _Draft] = {}
        of_event: list[_Draft] = []
        points: list[Array] = []
        for event in self._record.events:
            before = int(event["parent"])
            parent = of_event[before] if before >= 0 else None
            parent_number = None if parent is None else parent.number
            start = points[before] if before >= 0 else self._camera_ray[0]
            kind = KIND[int(event["kind"])]
            stone = self._record.stones[int(event["stone"])] if kind in ("enters", "meets") else None
            point = self._point(kind, event, start)
            facet = None if stone is None else self._facet(stone, point, event["normal"])
            inside = kind in ("ends", "chance") and self._is_inside(event, parent, before)
            surface = int(event["surface"]) if kind == "lands" else None
            # What the camera sees of the room, it sees before a stone parts the chains.
            key = (parent_number, kind, stone and stone.number, facet, surface, inside)
            step = known.get(key)
            if step is None:
                step = known[key] = _Draft(len(steps), parent_number, kind, stone, facet, inside)
                steps.append(step)
            of_event.append(step)
            points.append(point)
            chain = int(event["chain"])
            step.passes.append(self._pass(kind, event, stone, chain, start, point))
            for source, light in self._sources(kind, event, chain).items():
                step.light[source] = step.light.get(source, np.zeros(3)) + light
        return steps

    def _point(self, kind: Kind, event: np.void, start: Array) -> Array:
        """Of the world, where an event is."""
        here, direction = event["point"].astype(float), event["direction"].astype(float)
        match kind:
            case "enters" | "meets":
                return np.asarray(here + self._origin)
            case "lands":  # the kernel says where the ray comes from
                surface = self._record.parameters["surface"][int(event["surface"])].astype(float)
                way = (surface[3] - surface[:3] @ here) / (surface[:3] @ direction)
                return np.asarray(here + way * direction + self._origin)
            case "sees":
                return np.asarray(start + FAR * direction)
            case "ends":
                return np.asarray(start + SHORT * direction)
            case "chance":
                return start
            case _:
                assert_never(kind)

    def _is_inside(self, event: np.void, parent: _Draft | None, before: int) -> bool:
        """Whether a chain ends in a stone: said by the kernel, but for one that ends as it enters."""
        if event["inside"]:
            return True
        if parent is None or parent.kind != "enters":
            return False
        return float(event["direction"] @ self._record.events[before]["normal"]) < 0

    def _facet(self, stone: PlacedStone, point: Array, normal: NDArray[np.floating]) -> int:
        """The facet of that normal, outward, at that point of the world."""
        own, planes = stone.own(point), stone.planes
        key = stone.number, np.round(np.append(normal, own @ normal), 4).tobytes()
        found = self._facets.get(key)
        if found is None:
            turned = ((planes[:, :3] - normal) ** 2).sum(axis=1)
            found = self._facets[key] = int((turned + (planes[:, :3] @ own - planes[:, 3]) ** 2).argmin())
        return found

    def _pass(
        self, kind: Kind, event: np.void, stone: PlacedStone | None, chain: int, start: Array, point: Array
    ) -> Pass:
        direction, normal = event["direction"].astype(float), event["normal"].astype(float)
        before, weight = (float(part) for part in event["weight"])
        polarisation = float(np.linalg.norm(event["polarisation"]))
        told = Pass(
            chain=None if chain < 0 else self._number_of_row[chain],
            start=_vector(start),
            point=_vector(point),
            direction=_vector(direction),
            weight_before=before,
            weight=weight,
            kept=float(event["kept"]),
            light=_vector(event["light"]),
            polarisation=min(polarisation, 1.0) if self._record.polarised and chain >= 0 else None,
            cut=float(event["cut"]) / 3,
        )
        if stone is None:
            return told
        index, cosine = self._index(stone, chain), min(abs(float(direction @ normal)), 1.0)
        inside = kind == "meets"
        in_air = cosine_in_air(cosine, index) if inside else cosine
        in_stone = cosine if inside else cosine_in_stone(cosine, index)
        beyond = in_air if inside else in_stone
        return replace(
            told,
            length=float(event["length"]) if inside else None,
            incidence_degrees=degrees(cosine),
            refraction_degrees=degrees(beyond) if beyond > 0 else None,
            critical_degrees=critical_degrees(index) if inside else None,
            reflectance=reflectance(in_air, in_stone, index),
        )

    def _sources(self, kind: Kind, event: np.void, chain: int) -> dict[EndSource, Array]:
        """What an event's light comes from: sums to it."""
        light = event["light"].astype(float)
        if not light.any():
            return {}
        match kind:
            case "lands":
                return {(WALLS[int(event["surface"])], None): light}
            case "sees":
                return self._seen(event, chain, light)
            case "ends":  # a dropped chain that shows the sky in its place
                return {("cut", None): light}
            case "enters" | "meets" | "chance":
                return {}
            case _:
                assert_never(kind)

    def _seen(self, event: np.void, chain: int, light: Array) -> dict[EndSource, Array]:
        if chain < 0 and self._scene.backdrop.kind != "none":
            return {("backdrop", None): light}
        weight = float(event["weight"][1]) * (np.ones(3) if chain < 0 else self._record.chains["share"][chain])
        found: dict[EndSource, Array] = {}
        for met, number, radiance in self._surroundings.radiance_by_source(
            event["direction"].astype(float), by_stone=chain >= 0
        ):
            found[met, number] = weight * radiance
        sky = light - sum(found.values(), np.zeros(3))
        if found and abs(sky).max() <= ROUNDED * abs(light).max():
            brightest = max(found, key=lambda source: float(abs(found[source]).max()))
            found[brightest] = found[brightest] + sky
        else:
            found["sky", None] = sky
        return found

    def _told(self, step: _Draft) -> Step:
        first = step.passes[0]
        stone = step.stone
        name = None
        if stone is not None and step.facet is not None and stone.shape.names:
            name = stone.shape.names[step.facet]
        return Step(
            number=step.number,
            parent=step.parent,
            kind=step.kind,
            passes=tuple(step.passes),
            stone=None if stone is None else stone.settings.id,
            facet=step.facet,
            facet_name=name.name or None if name else None,
            tier=name.tier if name else None,
            inside=step.inside,
            elevation_degrees=90 - degrees(first.direction[1]) if step.kind == "sees" else None,
            parts=tuple(sorted(self._parts(step.light), key=lambda part: -part.share)),
        )

    def _parts(self, light: dict[EndSource, Array]) -> Iterable[Part]:
        for (met, number), own in light.items():
            share = float(own @ LUMINANCE) / self._total if self._total > 0 else 0.0
            side = None
            lamp = None if number is None else self._scene.emitters[number]
            if lamp is not None and not isinstance(lamp, PointLight):
                side = side_of(
                    np.array(lamp.direction, dtype=float),
                    self._camera_ray[1],
                    np.array(self._scene.camera.up, dtype=float),
                )
            yield Part(met, number, side, _vector(own), share)


def _camera_ray(record: PixelRecord) -> tuple[Array, Array]:
    """Of the world: the eye, or where parallel rays begin, and the unit direction of the pixel's ray."""
    column, row, _, _ = record.pixel
    projection = record.projection
    x, y = jitter(0, record.stage.scene.sampling.filter)
    pixel = np.array([1.0, column + x, row + y])
    foot, direction = pixel @ projection.foot, pixel @ projection.direction
    eye = foot - projection.reach * direction + projection.origin
    return eye, direction / np.linalg.norm(direction)


def _rows(record: PixelRecord) -> list[int]:
    """Of the chains of this pixel, in a set of the table."""
    rows = int(record.parameters["chains"])
    if record.wavelengths is None:
        return list(range(rows))
    column, row, _, _ = record.pixel
    group = ((column & 1) + 2 * (row & 1)) % GROUPS  # of the first sample: groups_of of tile.cl
    return list(range(group, rows, GROUPS))


def _vector(of: Sequence[float] | NDArray[np.floating]) -> Vector:
    x, y, z = (float(component) for component in of)
    return x, y, z
