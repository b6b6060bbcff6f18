"""What the colours of an instrument mean, and from where the stone is seen, for a corner of the picture: in the words
of the page."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from culet.errors import InputError
from culet.optics.panoramas import HEADS
from culet.scene.camera import Camera
from culet.scene.model import Scene
from culet.scene.sky import ImageEnvironment

ByteColour = tuple[int, int, int]

RED, GREEN, BLUE, WHITE, BLACK = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255), (0, 0, 0)
ASIDE = 45
"""Degrees of elevation below which ASET is green."""
SMALLEST = 10
"""Pixels of text, which is a thirtieth of the picture's height."""


@dataclass(frozen=True)
class Line:
    """Of a legend."""

    text: str
    colour: ByteColour | None = None
    """Of the patch before the text."""


def legend_of(scene: Scene) -> list[Line]:
    """Lines for a scene; without an instrument and parallel rays there are none."""
    lines: list[Line] = []
    environment = scene.environment
    if isinstance(environment, ImageEnvironment) and environment.image in HEADS:
        head = HEADS[environment.image] if environment.head_degrees is None else environment.head_degrees
        lines += _aset(head) if environment.image == "aset" else _ideal_scope(head)
    if lines or scene.camera.kind == "orthographic":
        lines.append(Line(tilt_words(scene.camera)))
    return lines


def legend_for(scene: Scene, width: int, height: int) -> list[Line]:
    """Lines for a picture of so many pixels; InputError if the scene has no legend, or the picture no room for it."""
    lines = legend_of(scene)
    if not lines:
        raise InputError(
            "legend: expected an instrument's sky (aset, ideal-scope) or parallel rays, got neither", "legend"
        )
    _Layout(lines, width, height)
    return lines


def _aset(head: float) -> list[Line]:
    edge = f"{90 - head:g}"
    return [
        Line(f"From above, {ASIDE}\u00b0 to {edge}\u00b0", RED),
        Line(f"From aside, 0\u00b0 to {ASIDE}\u00b0", GREEN),
        Line(f"Your head, {edge}\u00b0 to 90\u00b0", BLUE),
        Line("Leak", BLACK),
    ]


def _ideal_scope(head: float) -> list[Line]:
    return [
        Line(f"Comes back, 0\u00b0 to {90 - head:g}\u00b0", RED),
        Line(f"Your head, {90 - head:g}\u00b0 to 90\u00b0", BLACK),
        Line("Leak", WHITE),
    ]


def tilt_words(camera: Camera) -> str:
    """How far from straight above the camera is, and on which side: degrees from +z, the picture's lower edge face up,
    toward +x, its right edge."""
    x, y, z = (p - t for p, t in zip(camera.position, camera.target, strict=True))
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, y / math.hypot(x, y, z)))))
    if tilt < 0.05:
        return "Face up"
    return f"Tilted {tilt:.1f}\u00b0 toward {math.degrees(math.atan2(x, z)) % 360:.0f}\u00b0"


class _Layout:
    """Where the lines go; InputError if a picture of so many pixels has no room for them."""

    def __init__(self, lines: list[Line], width: int, height: int) -> None:
        self.size = max(SMALLEST, height // 30)
        self.font = ImageFont.load_default(self.size)
        self.wide = max(self.font.getlength(line.text) for line in lines) + 3 * self.size
        self.pitch = round(1.5 * self.size)
        high = self.pitch * len(lines) + self.size
        if self.wide > width or high > height:
            raise InputError(
                f"legend: expected a picture of at least {math.ceil(self.wide)} x {high} pixels for it, "
                f"got {width} x {height}", "legend",
            )  # fmt: skip
        self.top = height - self.size // 2 - self.pitch * len(lines)


def drawn(rgb: NDArray[np.uint8], lines: list[Line]) -> NDArray[np.uint8]:
    """The picture (height, width, 3 or 4) with the lines in its lower left corner; InputError if it has no room."""
    height, width = rgb.shape[:2]
    layout = _Layout(lines, width, height)
    size = layout.size
    picture = Image.fromarray(rgb)
    pen = ImageDraw.Draw(picture)
    opaque = (255,) * (rgb.shape[2] - 3)
    pen.rectangle((0, layout.top - size // 2, layout.wide, height), fill=(24, 24, 24, *opaque))
    for number, line in enumerate(lines):
        y = layout.top + layout.pitch * number
        if line.colour is not None:
            box = (size // 2, y + size // 6, size // 2 + size, y + size // 6 + size)
            pen.rectangle(box, fill=(*line.colour, *opaque), outline=(160, 160, 160, *opaque))
        pen.text((2 * size, y), line.text, fill=(235, 235, 235, *opaque), font=layout.font)
    return np.asarray(picture)
