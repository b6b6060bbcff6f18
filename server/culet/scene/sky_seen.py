"""A scene under another sky, which the camera sees: behind a studio's backdrop and floor nothing of it would show."""

from __future__ import annotations

from culet.scene.fields import Model
from culet.scene.model import Environment, Floor, Plane, Scene
from culet.scene.studio import Backdrop, NoBackdrop, StudioFloor


class Surroundings(Model):
    """What a sky was seen with, or was hidden by."""

    backdrop: Backdrop
    floor: Floor

    @classmethod
    def of(cls, scene: Scene) -> Surroundings:
        """A scene's."""
        return cls(backdrop=scene.backdrop, floor=scene.floor)


def under(scene: Scene, environment: Environment) -> Scene:
    """The scene under that sky, without a backdrop.

    A studio's floor goes as well: a panorama has a ground of its own; the report's skies have none, and are seen in the
    report's mirror.
    """
    changes: dict[str, object] = {"environment": environment, "backdrop": NoBackdrop()}
    if isinstance(scene.floor, StudioFloor):
        changes["floor"] = Plane(kind="none" if environment.kind == "image" else "mirror")
    return scene.model_copy(update=changes)


def back_under(scene: Scene, environment: Environment, before: Surroundings | None) -> Scene:
    """The scene under a sky that it had, with what `under` took away, where nothing else was put there since."""
    changes: dict[str, object] = {"environment": environment}
    if before is not None and scene.backdrop.kind == "none":
        changes["backdrop"] = before.backdrop
    if before is not None and isinstance(before.floor, StudioFloor) and scene.floor.kind in ("none", "mirror"):
        changes["floor"] = before.floor
    return scene.model_copy(update=changes)
