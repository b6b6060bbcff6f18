"""What can be rendered: one validated, immutable model, the same for REST, sessions, command line and tests."""

from culet.scene.camera import Camera
from culet.scene.emitters import PointLight
from culet.scene.fields import Vector
from culet.scene.model import Scene
from culet.scene.presets import PRESETS, preset
from culet.scene.room import Plane
from culet.scene.sky import Environment
from culet.scene.stone import StoneSettings

__all__ = ["PRESETS", "Camera", "Environment", "Plane", "PointLight", "Scene", "StoneSettings", "Vector", "preset"]
