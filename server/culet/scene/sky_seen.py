"""A scene under another sky, which the camera sees: behind a studio's backdrop and floor nothing of it would show."""

from __future__ import annotations

from culet.scene.backdrop import Backdrop, NoBackdrop
from culet.scene.fields import Model
from culet.scene.model import Scene
from culet.scene.room import Floor, Plane, StudioFloor
from culet.scene.sky import SKIES_WITHOUT_LAMPS, Environment


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

    A studio's lamps and floor go as well: a sky has light of its own, and a panorama a ground. The report's skies have
    none, and are seen in the report's mirror; two of them show no lamps, which stay.
    """
    changes: dict[str, object] = {"environment": environment, "backdrop": NoBackdrop()}
    if environment.kind not in SKIES_WITHOUT_LAMPS:
        changes["emitters"] = scene.points
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
