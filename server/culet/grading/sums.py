"""Sums over parallel rays through a convex stone, made on the device: what all grades are ratios of."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pyopencl as cl
from numpy.typing import NDArray

from culet.errors import MeshError
from culet.geometry.shape import Shape
from culet.grading.optics import StoneOptics
from culet.grading.rules import Rules
from culet.rendering.features import by_half_spaces
from culet.rendering.opencl.device import Device, Real
from culet.rendering.opencl.layout import constants
from culet.rendering.programs.build import Variant, build
from culet.rendering.stones.facet_rows import facet_rows

Array = NDArray[np.float64]

KERNEL = constants("grade.cl")
NUMBERS = KERNEL["ELEVATIONS"] + KERNEL["DEGREES"]
"""What grade.cl sums for each work-item."""
UP = (0.0, 1.0, 0.0)
"""Of a shape: the table's normal."""
FIRE_DEGREES = 0.69
"""A pupil of 3 mm at 250 mm: colours further apart do not enter it together."""


@dataclass(frozen=True)
class DomeView:
    """Parallel rays from a viewer, under a dome."""

    toward: tuple[float, float, float] = UP
    """The viewer, of unit length."""
    axis: tuple[float, float, float] | None = None
    """Of the dome; without one the viewer's direction, so that dome and head stay where they are if the stone tilts."""

    @classmethod
    def tilted(cls, degrees: float, azimuth: float) -> DomeView:
        """Of a stone that is tilted so that the viewer sees it from that azimuth, degrees from +x towards +z."""
        tilt, around = math.radians(degrees), math.radians(azimuth)
        return cls((math.sin(tilt) * math.cos(around), math.cos(tilt), math.sin(tilt) * math.sin(around)))


class LightSums:
    """Makes the sums. One thread at a time may ask."""

    def __init__(self, device: Device, real: Real = np.float32) -> None:
        """DeviceError if the program does not build."""
        self._device = device
        self._variant = Variant(lanes=device.lanes_for(real), real=real)
        self._kernel = cl.Kernel(build(device, "grade.cl", self._variant.options), "grade")

    def of(
        self,
        shape: Shape,
        optics: StoneOptics,
        rules: Rules,
        views: Sequence[DomeView],
        *,
        batches: int,
        rays: int,
        seed: int = 0,
        crown_alone: bool = False,
        fire: bool = False,
    ) -> Array:
        """(V, batches, NUMBERS). Each batch has `rays` rays, rounded up to whole packets, at places of its own.

        MeshError for a stone that is not convex, or has more facets than are followed by half-spaces.
        """
        if not by_half_spaces(shape):
            raise MeshError(f"{shape.name}: expected a convex stone of at most 1500 facets to grade; got another")
        rows, real = facet_rows(shape), self._variant.real
        facets = np.column_stack([rows.planes[:, :3] @ rows.axes, rows.planes[:, 3]])
        table = _table(shape, views, rules)
        table[:, :3] = table[:, :3] @ rows.axes
        items = len(views) * batches
        packets = math.ceil(rays / self._variant.lanes)
        shifts = np.random.default_rng(seed).integers(0, 2**32, (items, 2), np.uint32)
        result = np.zeros((items, NUMBERS))
        kind = {"all": KERNEL["EVERY_GLARE"], "crown": KERNEL["CROWN_GLARE"], "none": 0}[rules.glare]
        kind |= KERNEL["CROWN_ALONE"] * crown_alone | KERNEL["WITH_FIRE"] * fire
        context, queue = self._device.context, self._device.queue
        found = cl.Buffer(context, cl.mem_flags.WRITE_ONLY, result.nbytes)

        def upload(array: NDArray[np.generic]) -> cl.Buffer:
            flags = cl.mem_flags.READ_ONLY | cl.mem_flags.COPY_HOST_PTR
            return cl.Buffer(context, flags, hostbuf=np.ascontiguousarray(array))

        self._kernel(
            queue, (items,), (1,),
            upload(facets.astype(real)), np.int32(len(facets)), upload(rows.data(real).astype(real)),
            upload(np.array(rows.ends, np.int32)), upload(table.astype(real)), np.int32(batches), upload(shifts),
            np.int32(packets), real(optics.index), real(optics.blue_index), real(optics.red_index),
            real(optics.absorption), real(rules.cutoff), np.int32(rules.bounces), real(FIRE_DEGREES), np.int32(kind),
            found,
        )  # fmt: skip
        cl.enqueue_copy(queue, result, found)
        return result.reshape(len(views), batches, NUMBERS)


def _table(shape: Shape, views: Sequence[DomeView], rules: Rules) -> Array:
    """The kernel's five rows of each view, in the shape's axes."""
    right, up, toward = frames_of(views)
    axis = np.array([view.toward if view.axis is None else view.axis for view in views])
    head = math.cos(math.radians(rules.head_degrees)) if rules.head_degrees > 0 else 2.0
    (across, high), (middle, height) = _spans(shape, right, up)
    rows = np.stack([right, up, toward, axis, np.broadcast_to(UP, axis.shape)], axis=1)
    last = np.stack([across / 2, high / 2, middle, height, np.full(len(axis), head)], axis=1)
    return np.concatenate([rows, last[:, :, None]], axis=2).reshape(-1, 4)


def _spans(shape: Shape, right: Array, up: Array) -> tuple[tuple[Array, Array], tuple[Array, Array]]:
    """Width and height of the shape as so many viewers see it, and where their middles are."""
    seen = [shape.vertices @ side.T for side in (right, up)]
    across, high = (np.ptp(places, axis=0) for places in seen)
    middle, height = ((places.max(axis=0) + places.min(axis=0)) / 2 for places in seen)
    return (across, high), (middle, height)


def frames_of(views: Sequence[DomeView]) -> tuple[Array, Array, Array]:
    """Of each view unit vectors to the right, up, and toward the viewer: (V, 3)."""
    toward = np.array([view.toward for view in views])
    other = np.eye(3)[abs(toward).argmin(axis=1)]
    right = np.cross(other, toward)
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    return right, np.cross(toward, right), toward


def seen_areas(shape: Shape, views: Sequence[DomeView]) -> Array:
    """(V,) R^2, of the rectangles that the rays of views fill."""
    right, up, _ = frames_of(views)
    (across, high), _ = _spans(shape, right, up)
    return across * high
