"""How light is followed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from culet.scene.fields import Model

MOST_BANDS = 64


def _form_of_bands(value: object) -> str | None:
    if value == "auto":
        return "<auto>"
    return "<number>" if not isinstance(value, str) or value.strip().isdigit() else None


BandCount = Annotated[
    Annotated[Literal["auto"], Tag("<auto>")] | Annotated[int, Field(ge=3, le=MOST_BANDS), Tag("<number>")],
    Discriminator(
        _form_of_bands,
        custom_error_type="bands",
        custom_error_message=f"Input should be 'auto' or a whole number from 3 to {MOST_BANDS}",
    ),
]
"""Of the two forms only the one that was meant is judged. The tags are told from fields by their brackets."""


class Optics(Model):
    """How light is followed."""

    fresnel: Literal["exact", "schlick"] = "exact"
    bands: BandCount = Field(
        3,
        description="3: an index for each channel. More: that many sampled wavelengths for each pixel and sample. "
        "auto: 3 while things move and for the first sample of a picture at rest, then wavelengths if a stone "
        "disperses.",
    )
    polarised: bool = Field(
        False, description="Carry polarisation along each path, with the phases of total reflection; else average it."
    )
    cutoff: Annotated[float, Field(ge=1e-9, lt=1)] = Field(
        0.01, description="A chain whose weight falls below this ends; what it carried is counted as cut."
    )
    max_bounces: Annotated[int, Field(ge=1, le=65536)] = Field(
        256, description="Interior segments of a chain, at most."
    )
    end: Literal["cut", "roulette", "sky"] = Field(
        "cut",
        description="Of a chain below the cut-off: dropped, continued by chance without bias, or replaced by the sky.",
    )
    glare: bool = Field(
        True,
        description="Whether the stone's surface shows what it reflects outside. Without it the picture is not "
        "physical: it shows what comes out of the stone, as a polarising filter does in part.",
    )
    caustics: Literal["on", "off"] = Field(
        "on",
        description="Whether matte surfaces show the light that stones throw; a studio floor shows that of points and "
        "of lamps of at most 1 degree. Without it stones throw their shadows alone.",
    )
    caustics_cutoff: Annotated[float, Field(ge=1e-9, le=1)] = Field(
        1.7e-4,
        description="Flux at which a beam of that light ends, R^2 times the light's irradiance; what it carried is "
        "counted as cut.",
    )
    estimator: Literal["chain", "classic"] = "chain"


SPECTRAL_AT_REST = Optics(bands="auto")
"""Of presets that are looked at for their fire. A document that names no bands keeps its three: it shows what it has
shown ever since, to the last bit."""
