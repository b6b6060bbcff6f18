"""A camera's way through a scene: cameras at times, and those between."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, TypeAdapter, ValidationError, model_validator
from scipy.interpolate import PchipInterpolator

from culet.errors import SceneError
from culet.scene.camera import Camera
from culet.scene.fields import Model, Vector
from culet.scene.refusal import scene_error

MOST_STATIONS = 10_000


class Station(Model):
    """A camera on its way; what it does not say is as in the scene."""

    time: Annotated[float, Field(ge=0)] | None = Field(None, description="s; said by all, or by none.")
    position: Vector | None = None
    target: Vector | None = None
    up: Vector | None = None
    fov_degrees: Annotated[float, Field(ge=1e-3, le=170)] | None = None
    height: Annotated[float, Field(ge=1e-6, le=1e9)] | None = None


class Way(Model):
    """Where a camera is when."""

    cameras: Annotated[tuple[Station, ...], Field(min_length=1, max_length=MOST_STATIONS)]

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        times = [station.time for station in self.cameras]
        told = [time for time in times if time is not None]
        if told and len(told) < len(times):
            raise ValueError("expected a time of each camera or of none")
        if any(later <= earlier for earlier, later in pairwise(told)):
            raise ValueError("expected times that grow from camera to camera")
        return self

    @classmethod
    def read(cls, data: Any) -> Way:  # noqa: ANN401 - whatever JSON held
        """Of a list of cameras, or of an object with such a list; SceneError names the first that cannot be used."""
        try:
            return _WAY.validate_python({"cameras": data} if isinstance(data, list) else data)
        except ValidationError as error:
            raise scene_error(error, cls) from error


_WAY: TypeAdapter[Way] = TypeAdapter(Way)


def along(way: Way, camera: Camera, seconds: float, times: Sequence[float]) -> list[Camera]:
    """The cameras at those times, s: on smooth curves through the stations, which do not overshoot them (PCHIP: Fritsch
    and Butland, SIAM Journal on Scientific and Statistical Computing 5, 1984); at rest before the first and after the
    last. Stations without times are spread evenly over the seconds. SceneError for a way on which a camera looks
    nowhere."""
    stations = [
        [*_of(each.position, camera.position), *_of(each.target, camera.target), *_of(each.up, camera.up),
         camera.fov_degrees if each.fov_degrees is None else each.fov_degrees,
         camera.height if each.height is None else each.height]
        for each in way.cameras
    ]  # fmt: skip
    at = [each.time for each in way.cameras if each.time is not None]
    when = np.array(at) if at else np.linspace(0, seconds, len(stations))
    if len(stations) == 1:
        found = np.repeat([stations[0]], len(times), axis=0)
    else:
        found = PchipInterpolator(when, np.array(stations))(np.clip(times, when[0], when[-1]))
    cameras = []
    for time, values in zip(times, found.tolist(), strict=True):
        position, target, up, (fov, height) = values[:3], values[3:6], values[6:9], values[9:]
        document = {
            "kind": camera.kind, "position": position, "target": target, "up": up, "fov_degrees": fov, "height": height,
        }  # fmt: skip
        try:
            cameras.append(Camera.model_validate(document))
        except ValidationError as error:
            raise SceneError(f"cameras: at {time:g} s: {scene_error(error, Camera)}", "cameras") from error
    return cameras


def _of(said: Vector | None, otherwise: Vector) -> Vector:
    return otherwise if said is None else said
