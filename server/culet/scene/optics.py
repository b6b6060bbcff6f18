"""How light is followed."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import Field

from culet.scene.fields import Model


class Optics(Model):
    """How light is followed."""

    fresnel: Literal["exact", "schlick"] = "exact"
    bands: Annotated[int, Field(ge=3, le=64)] = Field(
        3, description="3: an index for each channel. More: that many sampled wavelengths for each pixel and sample."
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
        1e-3,
        description="Flux at which a beam of that light ends, R^2 times the light's irradiance; what it carried is "
        "counted as cut.",
    )
    estimator: Literal["chain", "classic"] = "chain"
