"""Makes the pictures of simulation.md: plot and contact sheet.

python docs/explanation/simulation_figures.py [plot] [sheet]
"""

from __future__ import annotations

import sys
from pathlib import Path

from PIL import Image, ImageDraw, ImageFont

from culet.rendering.renderer import Renderer
from culet.scene import Scene
from culet.scene.camera import Camera
from culet.scene.motion import MotionLaws
from culet.scene.room import Plane
from culet.simulation import Simulation, record
from culet.simulation.recording.plot import plot
from culet.stage import Stage

HERE = Path(__file__).parent
START = (0.0, 1.5, 0.0)
TILT = (0.9238795325112867, 0.3826834323650898, 0.0, 0.0)
TIMES = (0.2, 0.6, 0.8, 1.0, 1.3, 1.8, 6.0)
"""s."""


def scene_of(**settings: object) -> Scene:
    scene = Scene(floor=Plane(kind="matte"), simulation=MotionLaws.model_validate(settings))
    return scene.moved((START, TILT))


def sheet(file: Path) -> None:
    """The same drop in both models, row by row; the camera stands still."""
    renderer, width, height = Renderer(), 240, 200
    picture = Image.new("RGB", (width * len(TIMES), 2 * height), "white")
    draw, font = ImageDraw.Draw(picture), ImageFont.load_default(size=14)
    for row, model in enumerate(("classic", "rigid")):
        scene = scene_of(model=model).model_copy(
            update={"camera": Camera(position=(0, 2.2, 7), target=(0, 0.3, 0), fov_degrees=34)}
        )
        stage = Stage.of(scene)
        moving = Simulation.of(stage)
        for column, moment in enumerate(TIMES):
            while moving.state.time < moment - 1e-9:
                moving.step()
            pose = moving.state.position, moving.state.orientation
            still = renderer.picture(stage.posed([pose]), width, height)
            still.refine(4)
            picture.paste(Image.fromarray(still.rgb()), (column * width, row * height))
            draw.text((column * width + 6, row * height + 4), f"{model}, {moment} s", "white", font)
    picture.save(file)


def main(what: list[str]) -> None:
    if not what or "plot" in what:
        plot(record(Stage.of(scene_of()), 8), HERE / "drop.png")
    if not what or "sheet" in what:
        sheet(HERE / "drops.png")


if __name__ == "__main__":
    main(sys.argv[1:])
