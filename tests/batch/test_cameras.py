"""A camera's way: it passes its stations at their times, and never overshoots them."""

from __future__ import annotations

from typing import Any

import pytest

from culet.batch.cameras import Way, along
from culet.errors import SceneError
from culet.scene import Camera

CAMERA = Camera()


def test_stations_without_times_are_passed_evenly() -> None:
    way = Way.read([{"position": [0, 3, 8]}, {"position": [4, 3, 8], "fov_degrees": 30}, {"position": [4, 3, 2]}])
    cameras = along(way, CAMERA, 2, [0, 0.5, 1, 1.5, 2, 9])
    assert cameras[0].position == pytest.approx((0, 3, 8))
    assert cameras[0].target == CAMERA.target
    assert [*cameras[2].position, cameras[2].fov_degrees] == pytest.approx([4, 3, 8, 30])
    assert [*cameras[4].position, *cameras[5].position] == pytest.approx([4, 3, 2] * 2)
    assert 0 < cameras[1].position[0] < 4
    assert all(camera.position[0] <= 4 for camera in cameras), "a curve that overshoots would pass 4"


def test_stations_are_passed_at_their_times() -> None:
    way = Way.read({"cameras": [{"time": 1, "height": 2}, {"time": 3, "height": 4}]})
    assert [camera.height for camera in along(way, CAMERA, 4, [0, 1, 2, 3, 4])] == pytest.approx([2, 2, 3, 4, 4])


def test_one_station_is_a_camera_that_stands() -> None:
    cameras = along(Way.read([{"position": [0, 3, 8]}]), CAMERA, 1, [0, 0.5])
    assert [camera.position for camera in cameras] == [pytest.approx((0, 3, 8))] * 2


@pytest.mark.parametrize(
    ("document", "said"),
    [
        ([], "cameras"),
        ([{"tme": 1}], "cameras.0.tme: unknown field; did you mean `time`"),
        ([{"time": 1}, {}], "a time of each camera or of none"),
        ([{"time": 1}, {"time": 1}], "times that grow"),
        ([{"position": [0, 1]}], "cameras.0.position"),
        (7, "expected an object"),
    ],
)
def test_a_way_that_is_none_is_refused(document: Any, said: str) -> None:  # noqa: ANN401 - of JSON
    with pytest.raises(SceneError, match=said):
        Way.read(document)


def test_a_camera_that_would_look_nowhere_on_its_way_is_told_with_its_time() -> None:
    way = Way.read([{"position": [0, 0, 5], "target": [0, 0, 0]}, {"position": [0, 0, -5], "target": [0, 0, 0]}])
    with pytest.raises(SceneError, match=r"cameras: at 0\.5 s: .*the same point"):
        along(way, CAMERA, 1, [0, 0.5, 1])
