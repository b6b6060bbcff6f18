"""Every approximation of the renderer as a knob, and the settings that a study measures."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import product
from typing import NamedTuple

from culet.rendering.chains import bands_seen
from culet.rendering.features import Geometry, features_of
from culet.scene.model import Scene
from culet.scene.optics import Optics
from culet.stage import Stage
from culet.study.report import Knob


@dataclass(frozen=True)
class Knobs:
    """One setting of all of them."""

    estimator: str
    end: str
    cutoff: float
    max_bounces: int
    bands: int
    polarised: bool
    fresnel: str
    samples: int = 1
    """Of each pixel."""
    scale: float = 1.0
    """Rows and columns, as part of the full picture's; what is smaller is enlarged before it is judged."""
    precision: str = "single"
    lanes: int = 16
    relaxed_maths: bool = True
    """-cl-fast-relaxed-math and -cl-mad-enable."""
    geometry: str = "half-spaces"

    @property
    def key(self) -> str:
        """All of them in words."""
        return " ".join(f"{name}={_text(value)}" for name, value in self.values().items())

    def values(self) -> dict[str, Knob]:
        """By name."""
        return asdict(self)

    def applied_to(self, scene: Scene) -> Scene:
        """The scene with these optics."""
        own = {name: getattr(self, name) for name in Optics.model_fields if hasattr(self, name)}
        optics = Optics.model_validate({**scene.optics.model_dump(), **own})
        return scene.model_copy(update={"optics": optics})

    def differences(self, base: Knobs) -> str:
        """What tells these settings from the base, in words; `base` if nothing does."""
        own, others = self.values(), base.values()
        return ", ".join(f"{_name(n)} {_text(v)}" for n, v in own.items() if v != others[n]) or "base"


class KnobSetting(NamedTuple):
    """Something to measure."""

    group: str
    knobs: Knobs
    pictured: bool = False
    """Whether the report shows what it looks like."""


def base_knobs(stage: Stage, lanes: int) -> Knobs:
    """The stage's own optics, as the server renders a frame that moves: one sample, single precision."""
    optics = stage.scene.optics
    return Knobs(
        estimator=optics.estimator,
        end=optics.end,
        cutoff=optics.cutoff,
        max_bounces=optics.max_bounces,
        bands=bands_seen(stage.scene, 1),
        polarised=optics.polarised,
        fresnel=optics.fresnel,
        lanes=lanes,
        geometry="half-spaces" if features_of(stage).geometry == Geometry.HULL else "triangles",
    )


CUTOFFS = (0.3, 0.1, 0.05, 0.02, 0.01, 0.003, 0.001, 0.0001)
BOUNCES = (2, 4, 8, 16, 32, 64, 128)
BANDS = (8, 16, 32)
LANES = (1, 4, 8, 16)
SCALES = (0.75, 0.5, 0.25)
SAMPLES = (2, 4, 8, 16, 32, 64)
PICTURED = frozenset({"cutoff 0.1", "max bounces 8", "estimator classic", "scale 0.5", "bands 16", "samples 16"})


def settings_of(base: Knobs, *, quick: bool) -> list[KnobSetting]:
    """One knob at a time, then combinations of those that trade most; each setting once, the base first.

    `quick` leaves out the finest steps and most combinations.
    """
    found: dict[str, KnobSetting] = {}
    for group, knobs in _sweeps(base, quick=quick):
        pictured = knobs == base or knobs.differences(base) in PICTURED
        found.setdefault(knobs.key, KnobSetting(group, knobs, pictured))
    return list(found.values())


def _sweeps(base: Knobs, *, quick: bool) -> Iterator[tuple[str, Knobs]]:
    yield "base", base
    cutoffs = CUTOFFS[1:-1:2] if quick else CUTOFFS
    bounces = BOUNCES[1::2] if quick else BOUNCES
    bands = BANDS[:2] if quick else BANDS
    samples = SAMPLES[1:-1:2] if quick else SAMPLES
    yield from (("cutoff", replace(base, cutoff=cutoff)) for cutoff in cutoffs)
    yield from (("max bounces", replace(base, max_bounces=count)) for count in bounces)
    yield from (("end", replace(base, end=end)) for end in ("cut", "roulette", "sky"))
    yield from (("estimator", replace(base, estimator=estimator)) for estimator in ("chain", "classic"))
    yield from (("bands", replace(base, bands=count)) for count in (3, *bands))
    yield from (("polarised", replace(base, polarised=value)) for value in (False, True))
    yield from (("fresnel", replace(base, fresnel=kind)) for kind in ("exact", "schlick"))
    yield from (("precision", replace(base, precision=precision)) for precision in ("single", "double"))
    yield from (("lanes", replace(base, lanes=lanes)) for lanes in LANES)
    yield from (("relaxed maths", replace(base, relaxed_maths=value)) for value in (True, False))
    yield "geometry", replace(base, geometry="triangles")
    yield from (("scale", replace(base, scale=scale)) for scale in SCALES)
    yield from (("samples", replace(base, samples=count)) for count in samples)
    coarse = CUTOFFS[1:5:2] if quick else CUTOFFS[:6]
    yield from (
        ("combination", replace(base, cutoff=cutoff, samples=count))
        for cutoff, count in product(coarse, samples)
        if count <= 16
    )
    yield from (
        ("combination", replace(base, scale=0.5, cutoff=cutoff, samples=count))
        for cutoff, count in product(coarse, (1, 4))
    )
    yield from (
        ("combination", replace(base, bands=count, polarised=polarised, samples=number))
        for count, polarised, number in product(bands, (False, True), samples)
        if number <= (4 if quick else 64)
    )
    if not quick:
        yield from (("combination", replace(base, end="roulette", samples=count)) for count in samples)


def _name(knob: str) -> str:
    return knob.replace("_", " ")


def _text(value: Knob) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:g}" if isinstance(value, float) else str(value)
