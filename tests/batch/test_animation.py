"""Animations: frames are the stills that they are alone, there whole or not at all, and made once."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from culet.batch.animation import JOURNAL, Animation, FrameTask, RenderedFrame, fall, render_frames, times_of, turntable
from culet.batch.film import check_film, write_film
from culet.errors import InputError
from culet.scene import Scene
from culet.stage import Stage
from culet.stills import render_stage
from video_extra import needs_av

DEFAULT = Stage.of(Scene())
SIZE = 48, 27


def film(frames: int = 3, samples: int = 2) -> Animation:
    return Animation(turntable(DEFAULT, times_of(1, frames)), *SIZE, samples)


def narrowed(scene: Scene) -> Scene:
    return scene.model_copy(update={"camera": scene.camera.model_copy(update={"fov_degrees": 20.0})})


def files_in(folder: Path) -> dict[str, bytes]:
    return {file.name: file.read_bytes() for file in sorted(folder.iterdir())}


def test_each_frame_is_the_still_of_its_scene(tmp_path: Path) -> None:
    asked = film()
    assert list(render_frames(asked, tmp_path / "new" / "f"))[-1] == 1
    files = sorted((tmp_path / "new" / "f").glob("*.png"))
    assert [file.name for file in files] == ["frame-000001.png", "frame-000002.png", "frame-000003.png"]
    for file, stage in zip(files, asked.stages, strict=True):
        assert np.array_equal(np.asarray(Image.open(file)), render_stage(stage, *SIZE, samples=2).rgb)
    assert asked.stages[0].scene == DEFAULT.scene
    assert asked.stages[1].scene.camera != DEFAULT.scene.camera


def test_an_animation_that_was_interrupted_goes_on_and_renders_no_frame_twice(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    list(render_frames(film(4), tmp_path / "whole"))
    rendered = []
    render = FrameTask.__call__

    def counting(task: FrameTask, item: tuple[int, Scene]) -> RenderedFrame:
        rendered.append(item[0])
        if rendered == [0, 1, 2]:
            raise KeyboardInterrupt
        return render(task, item)

    monkeypatch.setattr(FrameTask, "__call__", counting)
    folder = tmp_path / "f"
    with pytest.raises(KeyboardInterrupt):
        list(render_frames(film(4), folder))
    (folder / "frame-000001.png").unlink()
    (folder / "frame-000002.png").write_bytes(b"cut off")
    assert list(render_frames(film(4), folder)) == [0, 0.25, 0.5, 0.75, 1]
    assert rendered == [0, 1, 2, 0, 1, 2, 3], "what is not there as it was written is rendered again"
    made, whole = files_in(folder), files_in(tmp_path / "whole")
    assert {name: data for name, data in made.items() if name != JOURNAL} == {
        name: data for name, data in whole.items() if name != JOURNAL
    }
    assert list(render_frames(film(4), folder)) == [1]


def test_another_animation_is_refused_unless_it_begins_anew(tmp_path: Path) -> None:
    list(render_frames(film(3), tmp_path))
    was = files_in(tmp_path)
    wide = film(3)
    narrow = tuple(stage.showing(narrowed(stage.scene)) for stage in wide.stages)
    for other, said in (
        (film(2), r"\(frames 3, now 2; motion.digest \w+\.\.\., now \w+\.\.\.\)"),
        (film(3, samples=3), r"\(samples 2, now 3\)"),
        (replace(wide, stages=narrow), r"\(scene\.camera\.fov_degrees 13\.5, now 20\.0\)"),
        (replace(wide, stages=wide.stages[:1] * 3), r"\(motion\.moving \[.*, now \[\]; motion\.digest "),
    ):
        with pytest.raises(InputError, match=rf"of another animation {said}.* --fresh"):
            list(render_frames(other, tmp_path))
        assert files_in(tmp_path) == was
    list(render_frames(film(2), tmp_path, fresh=True))
    assert list(files_in(tmp_path)) == ["frame-000001.png", "frame-000002.png", JOURNAL], (
        "no frame of the other is left"
    )


def test_a_fall_has_the_stone_where_it_is_at_each_frames_time() -> None:
    stages = fall(DEFAULT, times_of(0.5, 10))
    heights = [stage.scene.stones[0].position[1] for stage in stages]
    assert len(heights) == 5
    assert heights[2] == pytest.approx(heights[0] - 9.81 * 0.2**2 / 2, abs=0.02)  # to a step of the simulation


def test_no_frames_or_too_many_are_refused() -> None:
    for seconds, rate in ((0.001, 30), (1e6, 1000), (math.inf, 30), (math.nan, 30)):
        with pytest.raises(InputError, match="expected 1 to 100000 frames"):
            times_of(seconds, rate)


@needs_av
def test_a_film_has_every_frame_for_its_time(tmp_path: Path) -> None:
    import av

    asked, folder, out = film(3), tmp_path / "turn.frames", tmp_path / "turn.mp4"
    list(render_frames(asked, folder))
    write_film(asked, folder, out, 3, lambda part: None)
    with av.open(str(out)) as file:
        pictures = list(file.decode(video=0))
        assert file.duration is not None
        assert float(file.duration / av.time_base) == pytest.approx(
            1, abs=0.03
        )  # measured 1.025: the end is a picture too
    starts = [picture.time for picture in pictures]
    assert starts[:3] == pytest.approx([0, 1 / 3, 2 / 3], abs=1e-3)
    with Image.open(folder / "frame-000002.png") as frame:
        seen = pictures[1].to_ndarray(format="rgb24").astype(float)
        assert abs(seen - np.asarray(frame)).mean() < 4  # measured 1.3: nearly lossless, colour not halved
    assert not list(tmp_path.glob(".*.part"))


def test_a_film_that_could_not_be_made_is_refused_before_it_is_rendered(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("culet.batch.film.find_spec", lambda name: name)
    with pytest.raises(InputError, match="fps: expected at most 120"):
        check_film(tmp_path / "a.mp4", 240, "png")
    with pytest.raises(InputError, match="format: expected one of png, webp, tga for a film, got exr"):
        check_film(tmp_path / "a.mp4", 30, "exr")
    with pytest.raises(InputError, match="there is no folder"):
        check_film(tmp_path / "b" / "a.mp4", 30, "png")
    monkeypatch.setattr("culet.batch.film.find_spec", lambda name: None)
    with pytest.raises(InputError, match="a film needs PyAV"):
        check_film(tmp_path / "a.mp4", 30, "png")
