"""Makes what simulation.md shows: plot, contact sheet and the table of extremes.

python docs/simulation_figures.py [plot] [sheet] [extremes]
"""

from __future__ import annotations

import math
import sys
import time
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from culet.geometry.load import stone_of
from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.model import Camera, Plane
from culet.scene.model import Simulation as SimulationSettings
from culet.simulation import Simulation, record, surfaces_of
from culet.simulation.plot import plot

HERE = Path(__file__).parent
START = (0.0, 1.5, 0.0)
TILT = (0.9238795325112867, 0.3826834323650898, 0.0, 0.0)
TIMES = (0.2, 0.6, 0.8, 1.0, 1.3, 1.8, 6.0)
"""s."""

EXTREMES: dict[str, dict[str, Any]] = {
    "gravity 0, thrown down": {"gravity": 0, "velocity": (0, -3, 0)},
    "gravity 1e6 R/s^2": {"gravity": 1e6},
    "gravity 1e6 R/s^2, steps of 0.25 s": {"gravity": 1e6, "time_step": 0.25},
    "mass 1e-9": {"mass": 1e-9},
    "mass 1e9": {"mass": 1e9},
    "restitution 0": {"restitution": 0},
    "restitution 1": {"restitution": 1},
    "friction 0": {"friction": 0},
    "friction 1e3": {"friction": 1e3},
    "steps of 1e-4 s": {"time_step": 1e-4},
    "steps of 0.25 s": {"time_step": 0.25},
    "spin of 1 rad a step": {"spin": (60, 90, 40)},
    "spin of 100 rad a step": {"spin": (6000, 9000, 4000)},
    "spin 1e9 rad/s": {"spin": (1e9, 1e9, -1e9)},
    "thrown at a wall, 1e4 R/s": {"velocity": (0, 0, -1e4)},
    "thrown, 1e9 R/s": {"velocity": (1e9, -1e9, -1e9)},
    "start 1 R below the floor": {"below": 1.0},
}


def scene_of(**settings: object) -> Scene:
    scene = Scene(floor=Plane(kind="matte"), simulation=SimulationSettings.model_validate(settings))
    return scene.moved(START, TILT)


def sheet(file: Path) -> None:
    """The same drop in both models, row by row; the camera stands still."""
    renderer, width, height = Renderer(), 240, 200
    stone = stone_of(Scene().stones[0], {})
    picture = Image.new("RGB", (width * len(TIMES), 2 * height), "white")
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(size=14)
    for row, model in enumerate(("classic", "rigid")):
        scene = scene_of(model=model).model_copy(
            update={"camera": Camera(position=(0, 2.2, 7), target=(0, 0.3, 0), fov_degrees=34)}
        )
        moving = Simulation(scene.simulation, stone, START, TILT, surfaces_of(scene))
        for column, moment in enumerate(TIMES):
            while moving.state.time < moment - 1e-9:
                moving.step()
            still = renderer.picture(scene.moved(moving.state.position, moving.state.orientation), stone, width, height)
            still.refine(4)
            picture.paste(Image.fromarray(still.rgb()), (column * width, row * height))
            draw.text((column * width + 6, row * height + 4), f"{model}, {moment} s", "white", font)
    picture.save(file)


def extremes() -> None:
    """One line for each extreme: the default stone with walls, for 300 steps of 1/120 s unless said."""
    stone = stone_of(Scene().stones[0], {})
    print("| case | finite | largest energy gain, relative | deepest, R | fastest point, R/s | asleep | ms a step |")
    print("|---|---|---|---|---|---|---|")
    for name, case in EXTREMES.items():
        settings = dict(case)
        below = settings.pop("below", 0.0)
        scene = scene_of(**settings).model_copy(update={"walls": Plane(kind="matte")})
        start = (START[0], -1 - below if below else START[1], START[2])
        moving = Simulation(scene.simulation, stone, start, TILT, surfaces_of(scene))
        if below:
            moving.step()  # which lifts it out
        last, gain, deepest, fastest, finite = moving.energy(), 0.0, 0.0, 0.0, True
        scale = abs(last) + scene.simulation.mass * max(scene.simulation.gravity, 1e-300)
        begun = time.process_time()
        for _ in range(300):
            moving.step()
            state, energy = moving.state, moving.energy()
            gain, last = max(gain, (energy - last) / scale), energy
            deepest = max(deepest, moving.touch().penetration)
            speed = math.hypot(*moving.body.velocity(state)) + math.hypot(*moving.body.angular_velocity(state))
            fastest, finite = max(fastest, speed), finite and bool(np.isfinite([*state.position, energy]).all())
        taken = (time.process_time() - begun) / 300 * 1e3
        print(
            f"| {name} | {'yes' if finite else 'NO'} | {gain:.1e} | {deepest:.1e} | {fastest:.3g} "
            f"| {'yes' if moving.state.asleep else 'no'} | {taken:.2g} |",
            flush=True,
        )


def main(what: list[str]) -> None:
    if not what or "plot" in what:
        stone = stone_of(Scene().stones[0], {})
        plot(record(scene_of(), stone, 8), HERE / "drop.png")
    if not what or "sheet" in what:
        sheet(HERE / "drops.png")
    if not what or "extremes" in what:
        extremes()


if __name__ == "__main__":
    main(sys.argv[1:])
