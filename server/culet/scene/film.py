"""From light to picture: how pixels are sampled, and what becomes of radiance on a screen."""

from __future__ import annotations

import re
from typing import Annotated, Literal

from pydantic import AfterValidator, Field

from culet.scene.fields import Model

MOST_SAMPLES = 65536
"""Of a pixel."""
STILL_ERROR = 0.01
"""Of a still, if nobody says how good: hardly a difference to less is seen at arm's length, and 640 x 360 pixels of any
preset take 2 to 24 samples."""
STILL_LEAST = 16
"""Samples of such a still whatever its error: edges, which have little part in that, are smooth then."""
STILL_SAMPLES = 256
"""Samples of such a still at most: a scene of glitter that never settles is done after some seconds."""


_BACKGROUND = "^(backdrop|transparent|#[0-9a-fA-F]{6})$"


def is_background(value: str) -> str:
    """The same; ValueError for what is none."""
    if re.fullmatch(_BACKGROUND, value) is None:
        raise ValueError("expected backdrop, transparent, or a colour of six hexadecimal digits such as #f4f1ea")
    return value


Background = Annotated[str, AfterValidator(is_background), Field(json_schema_extra={"pattern": _BACKGROUND})]


class Sampling(Model):
    """How each pixel is sampled; the first sample is the pixel's centre."""

    filter: Literal["box", "tent"] = Field(
        "box", description="Reconstruction: box averages the pixel, tent reaches to its neighbours' centres."
    )

    samples_per_pixel: int = Field(
        1,
        ge=1,
        le=MOST_SAMPLES,
        description="That pictures at rest have at least, and stills for which neither samples nor an error are given.",
    )


class Film(Model):
    """From linear radiance to what a screen shows: radiance x exposure, then the tone map."""

    background: Background = Field(
        "backdrop",
        description="What stills have behind everything, apart from what lights the stones. backdrop: what the camera "
        "sees there; transparent: nothing, with alpha in .png, .webp, .tga and .exr, white in .jpg; a colour such as "
        "#f4f1ea: exactly that on the screen (.exr: as transparent). Live pictures have the colour too, as near as the "
        "tone map comes to it, and the backdrop in place of nothing.",
    )
    exposure: Annotated[float, Field(gt=0, le=1e6)] = 1
    tone_map: Literal["srgb", "neutral", "filmic", "classic", "none"] = Field(
        "neutral",
        description="srgb: IEC 61966-2-1; neutral: as it is up to 0.8, above that a shoulder towards white, then srgb; "
        "filmic: a curve on the luminance that keeps hues, then srgb; "
        "classic: (1.2 L)^1.2 as in the report; none: linear. What is above 1 is clipped.",
    )
    gamut: Literal["desaturate", "clip"] = Field(
        "desaturate", description="What becomes of spectral colours that no screen has: towards grey, or clipped."
    )
    fireflies: Literal["keep", "hide"] = Field(
        "keep",
        description="What a screen shows of pixels that a single sample of many has made bright. hide: those samples "
        "are left out, with little of the fire; linear radiance and .exr keep them, as do stills with another "
        "background.",
    )

    @property
    def cut_out(self) -> bool:
        """Whether stills leave out what is behind everything."""
        return self.background != "backdrop"

    @property
    def behind(self) -> tuple[int, int, int] | None:
        """The colour that a screen shows behind everything, 0 to 255; None for nothing, or the backdrop."""
        if not self.background.startswith("#"):
            return None
        red, green, blue = bytes.fromhex(self.background[1:])
        return red, green, blue
