"""The light maps of a device: kept while neither stones nor emitters change."""

from __future__ import annotations

import pickle
import sys
import threading
from collections.abc import Callable
from dataclasses import replace
from typing import Any, NamedTuple

import pyopencl as cl

import culet_kernels
from culet.rendering.chains import band_count
from culet.rendering.emitters.light_map import BoundMap, frame_of
from culet.rendering.emitters.open_sky import is_known
from culet.rendering.emitters.panorama_light import is_summed, panorama_light
from culet.rendering.emitters.sources import mapped_surfaces, rays_of
from culet.rendering.emitters.unshaded import sky_light
from culet.rendering.light.beams import Beams
from culet.rendering.light.illumination import Illumination
from culet.rendering.light.passes import Passes
from culet.rendering.light.photons import Photons, needed
from culet.rendering.light.solids import FEW, takes_only_beams
from culet.rendering.opencl import kernel_cache
from culet.rendering.opencl.apart import run_apart
from culet.rendering.opencl.compiling import compiling
from culet.rendering.opencl.device import Device
from culet.rendering.opencl.making import alone, lacks
from culet.rendering.programs.build import recipe
from culet.rendering.room.surfaces import shown
from culet.stage import Stage

KEPT = 2**25
"""Bytes of maps that are kept, the latest used last: five of a floor, of 6 MiB each, or one of floor and walls, of 24.
One of a moving picture is kept until one is made of the same stones elsewhere: each frame has its own, of which only
the last may be shown again, at rest. Pictures keep theirs besides."""
APART = (sys.executable, "-m", "culet.rendering.light.precompile")
"""The process that compiles programs of light, which takes a stage."""
COARSEST = 1.0
"""A cut-off at which hardly anything is followed."""


class Lighting:
    """Of one device. One thread at a time makes maps."""

    def __init__(self, device: Device, allocate: Callable[[int], Any], *, apart: bool = False) -> None:
        """`allocate` makes a buffer of so many bytes on the device, for maps. `apart`: `make_ready` has programs that
        the driver's cache does not have compiled by a process of its own."""
        self.device = device
        self.passes = Passes(device, allocate)
        self._apart = apart
        self._allocate = allocate
        self._kept: dict[_Key, Illumination] = {}
        self._warm: set[BeamPrograms] = set()
        """Kinds of stages for whose beams there is machine code."""
        self._making_ready = threading.Lock()

    def of(self, stage: Stage) -> Illumination | None:
        """What there is, or will be, of a stage's map; None where no surface has one."""
        if not mapped_surfaces(stage):
            return None
        key = _key(stage)
        known = self._kept.pop(key, None)
        if known is None:
            before = [other for other, each in list(self._kept.items()) if each.provisional and other[1:] == key[1:]]
            for other in before:
                self._kept.pop(other, None)  # another thread may have given it back
            frame = frame_of(stage)
            known = Illumination(self.passes, stage, BoundMap(frame, self._allocate))
        self._kept[key] = known
        held = 0
        for other, each in reversed(list(self._kept.items())):
            held += each.bound.frame.nbytes
            if held > KEPT and each is not known:
                self._kept.pop(other, None)
        return known

    def is_ready(self, stage: Stage) -> bool:
        """Whether a picture's light can be had without waiting for a compiler, for a panorama's sum, or for what a room
        leaves of the sky."""
        room = shown(stage.scene)
        if stage.panorama is not None and room and not is_summed(stage.panorama):
            return False
        if not is_known(room):
            return False
        if not mapped_surfaces(stage):
            return True
        return beams_of(stage) in self._warm if takes_only_beams(stage) else self.passes.photons.is_ready(stage)

    def make_ready(self, stage: Stage) -> None:
        """Have the programs that are needed compiled, in any thread, and one after the other: a compiler takes some
        100 MiB, and so does the pass."""
        if stage.panorama is not None and shown(stage.scene):
            panorama_light(stage.panorama)
        sky_light(stage)
        with self._making_ready:
            if self.is_ready(stage):
                return
            cache, program = kernel_cache.folder(), self._recipe(stage)
            # The stage is sent to that process; a panorama, which may have hundreds of MiB, is not.
            if self._apart and stage.panorama is None and lacks(cache, program):
                run_apart(APART, {}, pickle.dumps(stage))
            with alone(cache, program):
                self._compile(stage)

    def _recipe(self, stage: Stage) -> str:
        """Of the programs that `_compile` asks for."""
        if takes_only_beams(stage):
            return recipe(self.device, "beams.cl", culet_kernels.source("light_sum.cl"), beams_of(stage))
        return recipe(self.device, "photons.cl", "and launched", needed(stage))

    def _compile(self, stage: Stage) -> None:
        """By a pass of next to no light in a queue of its own, since machine code is made at the first launch."""
        device = replace(self.device, queue=cl.CommandQueue(self.device.context))
        frame = frame_of(stage)
        target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
        rays = rays_of(stage, 0)
        with compiling():
            if takes_only_beams(stage):
                Beams(device).make(stage, rays, frame, target, cutoff=COARSEST)
                self._warm.add(beams_of(stage))
            else:
                photons = Photons(device)
                for _ in photons.maps(stage, frame).pieces(target, rays[:1], number=0, photons=1):
                    pass
                self.passes.photons.prepare(stage)

    def forget(self) -> None:
        """All maps; pictures that are being made of them go on."""
        self._kept.clear()

    def release(self) -> None:
        """Give back what is kept for the next pass, the maps of moving frames, and passes that nobody waits for.
        Pictures and passes that are under way have their own. While no picture is refined."""
        self.passes.release()
        self.forget_provisional()

    def forget_provisional(self) -> None:
        """Give back the maps of moving frames that no picture has. From any thread, also while pictures are refined."""
        for key, each in list(self._kept.items()):
            if each.provisional:
                self._kept.pop(key, None)


class BeamPrograms(NamedTuple):
    """Which programs the beams of a stage need."""

    many_facets: bool
    several: bool
    """Stones."""
    polarised: bool
    points: bool
    lamps: bool


def beams_of(stage: Stage) -> BeamPrograms:
    """Those of a stage."""
    points = [ray.position is not None for ray in rays_of(stage, 0)]
    return BeamPrograms(
        any(len(shape.planes) > FEW for shape in stage.shapes),
        len(stage.shapes) > 1,
        stage.scene.optics.polarised,
        any(points),
        not all(points),
    )


class _Key(NamedTuple):
    """What a map depends on."""

    stones: object
    shapes: tuple[int, ...]
    light: object
    room: tuple[str, str]
    optics: tuple[object, ...]


def _key(stage: Stage) -> _Key:
    scene = stage.scene
    optics = scene.optics
    return _Key(
        scene.stones,
        tuple(map(id, stage.shapes)),
        (scene.emitters, scene.environment, id(stage.panorama)),
        (scene.floor.kind, scene.walls.kind),
        (optics.fresnel, band_count(scene), optics.polarised, optics.caustics, optics.max_bounces, scene.millimetres),
    )
