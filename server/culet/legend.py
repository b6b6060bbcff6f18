"""What the colours of an instrument mean, and from where the stone is seen, for a corner of the picture."""

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

Colour = tuple[int, int, int]

RED, GREEN, BLUE, WHITE, BLACK = (255, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 255), (0, 0, 0)
ASIDE = 45
"""Degrees of elevation below which ASET is green."""
SMALLEST = 10
"""Pixels of text, which is a thirtieth of the picture's height."""


@dataclass(frozen=True)
class Line:
    """Of a legend."""

    text: str
    colour: Colour | None = None
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


def _aset(head: float) -> list[Line]:
    edge = f"{90 - head:g}"
    return [
        Line(f"from above, {ASIDE}\u00b0 to {edge}\u00b0", RED),
        Line(f"from aside, 0\u00b0 to {ASIDE}\u00b0", GREEN),
        Line(f"from the head, {edge}\u00b0 to 90\u00b0", BLUE),
        Line("leak", BLACK),
    ]


def _ideal_scope(head: float) -> list[Line]:
    return [
        Line(f"comes back, 0\u00b0 to {90 - head:g}\u00b0", RED),
        Line(f"the head, {90 - head:g}\u00b0 to 90\u00b0", BLACK),
        Line("leak", WHITE),
    ]


def tilt_words(camera: Camera) -> str:
    """How far from straight above the camera is, and on which side: degrees from +z, the picture's lower edge face up,
    toward +x, its right edge."""
    x, y, z = (p - t for p, t in zip(camera.position, camera.target, strict=True))
    tilt = math.degrees(math.acos(max(-1.0, min(1.0, y / math.hypot(x, y, z)))))
    if tilt < 0.05:
        return "face up"
    return f"tilted {tilt:.1f}\u00b0 toward {math.degrees(math.atan2(x, z)) % 360:.0f}\u00b0"


def drawn(rgb: NDArray[np.uint8], lines: list[Line]) -> NDArray[np.uint8]:
    """The picture (height, width, 3 or 4) with the lines in its lower left corner; InputError if it has no room."""
    height, width = rgb.shape[:2]
    size = max(SMALLEST, height // 30)
    font = ImageFont.load_default(size)
    wide = max(font.getlength(line.text) for line in lines) + 3 * size
    pitch = round(1.5 * size)
    if wide > width or pitch * len(lines) + size > height:
        raise InputError(
            f"legend: expected a picture of at least {math.ceil(wide)} x {pitch * len(lines) + size} pixels for it, "
            f"got {width} x {height}", "legend",
        )  # fmt: skip
    picture = Image.fromarray(rgb)
    pen = ImageDraw.Draw(picture)
    opaque = (255,) * (rgb.shape[2] - 3)
    top = height - size // 2 - pitch * len(lines)
    pen.rectangle((0, top - size // 2, wide, height), fill=(24, 24, 24, *opaque))
    for number, line in enumerate(lines):
        y = top + pitch * number
        if line.colour is not None:
            box = (size // 2, y + size // 6, size // 2 + size, y + size // 6 + size)
            pen.rectangle(box, fill=(*line.colour, *opaque), outline=(160, 160, 160, *opaque))
        pen.text((2 * size, y), line.text, fill=(235, 235, 235, *opaque), font=font)
    return np.asarray(picture)
