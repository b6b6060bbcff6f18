"""What there is to choose from: presets, materials, cuts, skies, integrators."""

from __future__ import annotations

from functools import cache
from typing import Any, Literal

from fastapi import APIRouter, Response

from culet.gateway.answers.picture_response import picture_answers
from culet.optics.dispersion import RGB_NANOMETRES, channel_indices
from culet.optics.materials import MATERIALS
from culet.scene import PRESETS, Scene
from culet.scene.cuts import CUTS, TITLES, CutName, summary
from culet.scene.fields import Model
from culet.scene.presets import Group
from culet.scene.thumbnails import thumbnail_of

router = APIRouter(tags=["catalogue"])

WEBP = "image/webp"
SKIES = {
    "light-box": (
        "Light box",
        "A photographer's light box: bright above, softer at the sides, dark below.",
    ),
    "ring-lights": (
        "Ring lights",
        "Three thin bright rings, as around a lens: much fire.",
    ),
    "aset": (
        "ASET",
        "The Angular Spectrum Evaluation Tool's colours by elevation: green, red, blue.",
    ),
    "ideal-scope": (
        "Ideal-Scope",
        "The Ideal-Scope's: red from above, black where the eye is, white from below.",
    ),
}
"""What people call each, and a sentence. Made by the renderer, which the gateway does not load; a test compares the
names."""
INTEGRATORS = {
    "rkmk4": (
        "Runge-Kutta on rotations",
        "Munthe-Kaas's Runge-Kutta on the rotations, of fourth order.",
    ),
    "rk4": (
        "Runge-Kutta",
        "The classical Runge-Kutta on quaternions, of fourth order.",
    ),
    "midpoint": (
        "Midpoint",
        "The Lie midpoint rule, of second order.",
    ),
    "splitting": (
        "Turns in a row",
        "Exact turns about the three principal axes in a row, of second order.",
    ),
    "symmetric_top": (
        "Symmetric top",
        "As a body of revolution, exactly, and the rest split off: of second order.",
    ),
    "euler": (
        "Euler (the report's)",
        "The report's, of first order.",
    ),
}
"""What people call each, and a sentence. A test compares the names with the scene's."""


class Preset(Model):
    """A named scene."""

    name: str
    title: str
    """What people call it."""
    summary: str
    """One sentence."""
    group: Group
    thumbnail: str
    """Address of a small picture of it."""
    scene: Scene


class Presets(Model):
    """All presets."""

    presets: tuple[Preset, ...]


class Material(Model):
    """A named material: where its numbers come from, and how far they can be trusted."""

    name: str
    title: str
    """What people call it."""
    summary: str
    source: str
    confidence: Literal["measured", "weak source", "as set"]
    ray: Literal["ordinary ray"] | None
    """Which of two rays is traced, in a crystal that has two."""
    span_nm: tuple[float, float]
    """Wavelengths for which the source gives the index; outside, the nearer end's counts."""
    indices: tuple[float, float, float]
    coloured: bool
    """Whether it absorbs by a spectrum of its own: at the scene's `millimetres`, by default about a carat's."""


class Materials(Model):
    """All named materials; `indices` are refractive indices at `nanometres`."""

    nanometres: tuple[float, float, float]
    materials: tuple[Material, ...]


class Cut(Model):
    """A named cut; `proportions` is the JSON schema of what it can be told, with what is `usual`."""

    name: CutName
    title: str
    """What people call it."""
    summary: str
    proportions: dict[str, Any]


class Cuts(Model):
    """All cuts."""

    cuts: tuple[Cut, ...]


class Sky(Model):
    """A named panorama; `environment.image` of a scene takes the name."""

    name: str
    title: str
    """What people call it."""
    summary: str


class Skies(Model):
    """All named panoramas."""

    skies: tuple[Sky, ...]


class IntegratorDescription(Model):
    """A way to follow a free rotation; `simulation.integrator` of a scene takes the name."""

    name: str
    title: str
    """What people call it."""
    summary: str


class Integrators(Model):
    """All integrators."""

    integrators: tuple[IntegratorDescription, ...]


@router.get("/api/presets")
async def presets() -> Presets:
    """Scenes to begin with."""
    return Presets(
        presets=tuple(
            Preset(
                name=preset.name,
                title=preset.title,
                summary=preset.summary,
                group=preset.group,
                thumbnail=f"presets/{preset.name}/thumbnail.webp",
                scene=preset.scene,
            )
            for preset in PRESETS.values()
        )
    )


@router.get(
    "/api/presets/{name}/thumbnail.webp", response_class=Response, responses=picture_answers(WEBP, rendered=False)
)
async def thumbnail(name: str) -> Response:
    """A small picture of a preset."""
    return Response(thumbnail_of(name), media_type=WEBP, headers={"Cache-Control": "max-age=3600"})


@router.get("/api/materials")
async def materials() -> Materials:
    """Materials that a stone can name."""
    return Materials(
        nanometres=RGB_NANOMETRES,
        materials=tuple(
            Material(
                name=name,
                title=material.title,
                summary=material.summary,
                source=material.source,
                confidence=material.confidence,
                ray=material.ray,
                span_nm=material.span_nm,
                indices=channel_indices(name),
                coloured=material.absorption is not None,
            )
            for name, material in MATERIALS.items()
        ),
    )


@router.get("/api/cuts")
async def cuts() -> Cuts:
    """Cuts that a stone can have, with their proportions, limits and defaults."""
    return _all_cuts()


@cache  # schemas take some 0.1 s of the loop that all streams go through
def _all_cuts() -> Cuts:
    return Cuts(
        cuts=tuple(
            Cut(
                name=cut().name,
                title=TITLES[name],
                summary=summary(name),
                proportions=cut.model_json_schema()["properties"],
            )
            for name, cut in CUTS.items()
        )
    )


@router.get("/api/skies")
async def skies() -> Skies:
    """Panoramas of the studio; POST adds others."""
    return Skies(skies=tuple(Sky(name=name, title=title, summary=said) for name, (title, said) in SKIES.items()))


@router.get("/api/integrators")
async def integrators() -> Integrators:
    """Ways to follow the rotation of a stone in flight (model `rigid`)."""
    return Integrators(
        integrators=tuple(
            IntegratorDescription(name=name, title=title, summary=said) for name, (title, said) in INTEGRATORS.items()
        )
    )
