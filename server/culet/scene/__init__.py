"""What can be rendered: one validated, immutable model, the same for REST, sessions, command line and tests."""

from culet.scene.model import Camera, Environment, Light, Plane, Scene, StoneSettings, Vector
from culet.scene.presets import PRESETS, preset

__all__ = ["PRESETS", "Camera", "Environment", "Light", "Plane", "Scene", "StoneSettings", "Vector", "preset"]
