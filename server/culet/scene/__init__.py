"""What can be rendered: one validated, immutable model, the same for REST, sessions, command line and tests."""

from culet.scene.fields import Vector
from culet.scene.model import Camera, Environment, Light, Plane, Scene, StoneSettings
from culet.scene.presets import PRESETS, preset

__all__ = ["PRESETS", "Camera", "Environment", "Light", "Plane", "Scene", "StoneSettings", "Vector", "preset"]
