"""A recorded path as a picture: three curves over time, drawn with Pillow alone."""

from __future__ import annotations

import math
import pathlib

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from culet.errors import InputError
from culet.simulation.recording.paths import StonePath
from culet.simulation.recording.several_paths import SeveralPaths

WIDTH, PANEL = 960, 200
"""Pixels; the height of one of the panels."""
LEFT, RIGHT, TOP, BOTTOM = 84, 16, 26, 22
INK, FAINT, CURVE = (32, 32, 36), (214, 214, 220), (36, 98, 178)
TICKS = 4


def plot(path: StonePath | SeveralPaths, file: pathlib.Path) -> None:
    """Write height, energy and angular speed over time as a .png; InputError for another ending or a bad place."""
    if file.suffix.lower() != ".png":
        raise InputError(f"plot: expected a name that ends in .png; got {file.name!r}", "plot")
    panels: list[tuple[str, NDArray[np.float64]]] = [
        ("height of the centre of mass, R", path.position[..., 1]),
        ("energy, mass R^2/s^2", path.energy),
        ("angular speed, rad/s", np.linalg.norm(path.angular_velocity, axis=-1)),
    ]
    image = Image.new("RGB", (WIDTH, PANEL * len(panels) + BOTTOM), "white")
    draw, font = ImageDraw.Draw(image), ImageFont.load_default(size=13)
    for number, (title, values) in enumerate(panels):
        _panel(draw, font, number * PANEL, title, path.time, values)
    _rest(draw, font, path)
    try:
        image.save(file)
    except OSError as error:
        raise InputError(f"plot: {file} cannot be written: {error.strerror}", "plot") from error


def _panel(
    draw: ImageDraw.ImageDraw,
    font: ImageFont.FreeTypeFont | ImageFont.ImageFont,
    top: int,
    title: str,
    time: NDArray[np.float64],
    values: NDArray[np.float64],
) -> None:
    step, low, high = _ticks(float(values.min()), float(values.max()))
    bottom = top + PANEL - 8

    def row(value: float) -> float:
        return bottom - (value - low) / (high - low) * (PANEL - TOP - 8)

    for number in range(round((high - low) / step) + 1):
        value = low + number * step
        draw.line([(LEFT, row(value)), (WIDTH - RIGHT, row(value))], FAINT)
        draw.text((LEFT - 6, row(value)), f"{value:.4g}", INK, font, anchor="rm")
    draw.text((LEFT, top + 4), title, INK, font)
    columns = _columns(time).tolist()
    for curve in values.reshape(len(time), -1).T.tolist():  # a stone each
        draw.line([(x, row(value)) for x, value in zip(columns, curve, strict=True)], CURVE, 2)


def _rest(
    draw: ImageDraw.ImageDraw, font: ImageFont.FreeTypeFont | ImageFont.ImageFont, path: StonePath | SeveralPaths
) -> None:
    """The axis of time, and where all stones have fallen asleep."""
    bottom = draw.im.size[1] - BOTTOM + 4
    step, low, high = _ticks(0.0, float(path.time[-1]))
    for value in np.arange(low, high + step / 2, step).tolist():
        if value <= path.time[-1]:
            draw.text((float(_columns(path.time, value)[0]), bottom), f"{value:.4g} s", INK, font, anchor="ma")
    asleep = path.asleep.reshape(len(path.time), -1).all(axis=1)
    if asleep.any():
        x = float(_columns(path.time)[int(asleep.argmax())])
        draw.line([(x, TOP), (x, bottom - 4)], INK)
        draw.text((x - 4, TOP), "asleep", INK, font, anchor="ra")


def _columns(time: NDArray[np.float64], *at: float) -> NDArray[np.float64]:
    last = max(float(time[-1]), 1e-300)
    return LEFT + (np.array(at) if at else time) / last * (WIDTH - RIGHT - LEFT - 24)


def _ticks(low: float, high: float) -> tuple[float, float, float]:
    """A step of 1, 2 or 5 times a power of ten, and the multiples of it that hold both ends."""
    span = max(high - low, 1e-9 * max(abs(low), abs(high)), 1e-12)
    power = 10.0 ** math.floor(math.log10(span / TICKS))
    step = next(factor * power for factor in (1, 2, 5, 10) if factor * power * TICKS >= span)
    first = math.floor(low / step) * step
    return step, first, max(math.ceil(high / step) * step, first + step)
