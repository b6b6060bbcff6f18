"""The studio's quantities as the kernels read them: lamps, boxes, head, backdrop and floor."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import assert_never
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from culet.geometry.shape import Shape
from culet.remembered import remembered
from culet.rendering.stones.placed_stone import PlacedStone
from culet.scene.backdrop import Backdrop, GradientBackdrop, NoBackdrop, PlainBackdrop
from culet.scene.emitters import AnyEmitter, BoxLamp, boxes, discs
from culet.scene.model import Scene
from culet.scene.room import FLOOR_Y, StudioFloor

Array = NDArray[np.float64]


def set_studio(p: NDArray[np.void], scene: Scene, origin: Array, width: int, height: int) -> None:
    """Fill in what the scene has of it."""
    for name, values in _lamp_columns(scene.shown_lamps).items():
        p[name][: len(values)] = values
    p["lamps"], p["boxes"] = len(discs(scene.shown_lamps)), len(boxes(scene.shown_lamps))
    if scene.head is not None:
        p["has_head"] = True
        p["head"] = towards_observer(scene, origin)
        p["head_rim"], p["head_slope"] = disc_edge(scene.head.half_angle_degrees, scene.head.softness)
        p["head_radiance"] = scene.head.radiance
    _set_backdrop(p, scene.backdrop, width, height)
    if isinstance(scene.floor, StudioFloor):
        _set_floor(p, scene.floor)


@remembered
def _lamp_columns(lamps: tuple[AnyEmitter, ...]) -> dict[str, Array]:
    """Of lamps that the sky shows, by the parameters' names, a row each. Lamps seldom change, and are asked for in each
    picture."""
    round_ones, soft_boxes = discs(lamps), boxes(lamps)
    columns: dict[str, Array] = {}
    if round_ones:
        columns["lamp"] = np.array([_unit(lamp.direction) for lamp in round_ones])
        edges = np.array([disc_edge(lamp.half_angle_degrees, lamp.softness) for lamp in round_ones])
        columns["lamp_rim"], columns["lamp_slope"] = edges.T
        columns["lamp_radiance"] = np.array([lamp.radiance for lamp in round_ones])
    if soft_boxes:
        for name, parts in zip(
            ("box", "box_edge", "box_level"), zip(*map(_box_form, soft_boxes), strict=True), strict=True
        ):
            columns[name] = np.array(parts)
        columns["box_radiance"] = np.array([box.radiance for box in soft_boxes])
    return columns


@lru_cache(maxsize=256)
def disc_edge(half_angle_degrees: float, softness: float) -> tuple[float, float]:
    """Rim and slope: a disc's share is smoothstep(rim - slope (squared distance of unit vectors)).

    That is smoothstep((rim - x) / (rim - full)), where x = 1 - cosine = 2 sin^2(angle / 2), and rim and full are its
    values at the disc's rim and where it has its full radiance.
    """
    rim, full = 2 * np.sin(np.radians(half_angle_degrees * np.array([1, 1 - softness])) / 2) ** 2
    return float(rim / (rim - full)), float(0.5 / (rim - full))


def box_axes(box: BoxLamp) -> tuple[Array, Array, Array]:
    """The ways to a box, across it and up, of unit length. The box of the zenith has -z up."""
    to_box = _unit(box.direction)
    across = np.cross(to_box, (0, 1, 0))
    length = float(np.linalg.norm(across))
    across = across / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    up = np.cross(across, to_box)
    turn = np.radians(box.turn_degrees)
    return to_box, np.cos(turn) * across + np.sin(turn) * up, np.cos(turn) * up - np.sin(turn) * across


def towards_observer(scene: Scene, origin: Array) -> Array:
    """The unit vector from the stones' middle to the camera; of parallel rays, against them."""
    camera = scene.camera
    back = np.subtract(camera.position, camera.target)
    from_stone = np.subtract(camera.position, origin)
    far = camera.kind == "orthographic" or not np.linalg.norm(from_stone) > 1e-6
    return _unit(back if far else from_stone)


@lru_cache(maxsize=256)
def _box_form(box: BoxLamp) -> tuple[Array, Array, Array]:
    """See add_boxes in sky.cl: (3, 3) the ways to a box, across it and up, scaled so that a share of 1 is where it
    fades no more, and (2,) edge and (2,) level."""
    halves = np.radians([box.half_width_degrees, box.half_height_degrees])
    fades = np.sin(box.softness * halves)
    to_box, across, up = box_axes(box)
    reach = np.cos(halves) / fades
    form = np.array([to_box, reach[0] * across, reach[1] * up])
    # 1 at the upper edge, where the way up is reach sin(half height), and 1 - fade at the lower
    level = np.array([1 - box.fade / 2, box.fade / 2 / (reach[1] * np.sin(halves[1]))])
    return form, np.sin(halves) / fades, level


def _set_backdrop(p: NDArray[np.void], backdrop: Backdrop, width: int, height: int) -> None:
    match backdrop:
        case PlainBackdrop(colour=colour):
            p["backdrop_centre"] = p["backdrop_edge"] = colour
        case GradientBackdrop(centre=centre, edge=edge, focus=focus, size=size):
            p["backdrop_centre"], p["backdrop_edge"] = centre, edge
            p["backdrop_focus"] = width / 2 + focus[0] * height, height / 2 - focus[1] * height
            p["backdrop_scale"] = 1 / (size[0] * height), 1 / (size[1] * height)
        case NoBackdrop():
            pass
        case _:
            assert_never(backdrop)
    p["has_backdrop"] = backdrop.kind != "none"


def _set_floor(p: NDArray[np.void], floor: StudioFloor) -> None:
    p["floor_colour"] = floor.colour
    p["floor_reflectance"], p["floor_fade"] = floor.reflectance, floor.fade
    p["floor_roughness"] = floor.roughness


def contact_forms(stones: Sequence[PlacedStone]) -> Array:
    """(N, 3, 3) of each stone det S S^-1 in its own measure: x' S^-1 x = 1 is the ellipsoid of even density that has
    the stone's second moments, which are S / 5."""
    rotations = np.array([stone.rotation for stone in stones]).reshape(-1, 3, 3)
    forms = np.array([_form_of(stone.shape)[0] for stone in stones]).reshape(-1, 3, 3)
    return np.asarray(rotations @ forms @ rotations.transpose(0, 2, 1))


_FORMS: WeakKeyDictionary[Shape, tuple[Array, float]] = WeakKeyDictionary()


def _form_of(shape: Shape) -> tuple[Array, float]:
    """The same in the shape's own axes, and its largest axis; made once."""
    form = _FORMS.get(shape)
    if form is None:
        inertia = shape.mass.inertia
        spread = 5 * (np.trace(inertia) / 2 * np.eye(3) - inertia)
        adjugate = np.asarray(np.linalg.det(spread) * np.linalg.inv(spread))
        form = _FORMS[shape] = adjugate, float(np.linalg.eigvalsh(adjugate).max())
    return form


LEAST_SHADE = 1 / 1024
"""Part of the floor's light below which one of several stones takes none of it: a fourth of the least step of a shown
picture."""


def least_shade(stones: int) -> float:
    """That part, in a scene of so many stones: one alone shades the whole floor."""
    return LEAST_SHADE if stones > 1 else 0.0


def shade_reach(stones: Sequence[PlacedStone]) -> Array:
    """(N,) radii of each stone within which its contact shadow takes more: it falls at least as height sqrt(s) /
    distance^3, where s is the largest axis of the contact form."""
    if len(stones) < 2:
        return np.full(len(stones), FAR_REACH)
    heights = np.array([(stone.settings.position[1] - FLOOR_Y) / stone.scale for stone in stones])
    axes = np.array([_form_of(stone.shape)[1] for stone in stones])
    return np.asarray(np.cbrt(np.maximum(heights, 0) * np.sqrt(axes) / LEAST_SHADE))


FAR_REACH = 1e9
"""R. Beyond all that a scene may hold; its square is a number in single precision."""


def _unit(vector: object) -> Array:
    direction = np.asarray(vector, dtype=float)
    return np.asarray(direction / np.linalg.norm(direction))
