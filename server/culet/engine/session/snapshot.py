"""What another engine needs, besides the scene, to go on with a session."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from culet.errors import InputError
from culet.scene import Camera, Environment
from culet.scene.refusal import scene_error
from culet.scene.sky_seen import Surroundings
from culet_protocol.messages import BALANCED, Exactness

NUMBER_GAP = 1000
"""Steps and frames that an engine may have shown after its last snapshot, many more than come in 0.05 s at the highest
rate, 240. A restored session starts beyond, since a number names one picture for ever."""

NUMBERS = 2**53
"""Numbers that there are: those that JavaScript holds exactly. A snapshot from outside may claim any; what comes after
the last is the first again."""

LARGEST_FRACTION = 1 - 2**-20
"""Just short of the next step, so that putting the time by again never takes that step."""


class SessionSnapshot(BaseModel):
    """Goes through JSON and back without loss."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    simulation: dict[str, Any] | None
    """As `Simulation.snapshot` wrote it."""
    fraction: Annotated[float, Field(ge=0, le=LARGEST_FRACTION)]
    """How far between its last two states the simulation was shown."""
    falling: bool
    home: Camera
    environment: Environment | None = None
    """The session's own, which it goes back to from the light one; None if that is the scene's."""
    surroundings: Surroundings | None = None
    """With which it goes back to that; None if the scene's are those."""
    exactness: Exactness = BALANCED
    pinned: bool = False
    step: Annotated[int, Field(ge=1, lt=2**63)]
    sequence: Annotated[int, Field(ge=0, lt=2**63)]

    def moving_part(self) -> dict[str, Any]:
        """What changes without anybody doing something, as JSON's types."""
        return self.model_dump(mode="json", include={"simulation", "fraction", "falling", "step", "sequence"})

    @classmethod
    def read(cls, data: dict[str, Any]) -> SessionSnapshot:
        """Validate; InputError names the field."""
        try:
            return cls.model_validate(data)
        except ValidationError as error:
            found = scene_error(error)
            raise InputError(f"snapshot.{found}", f"snapshot.{found.field}") from error

    @property
    def next_step(self) -> int:
        """A step number that was never used."""
        return (self.step - 1 + NUMBER_GAP) % NUMBERS + 1

    @property
    def next_sequence(self) -> int:
        """A frame number that was never used."""
        return (self.sequence + NUMBER_GAP) % NUMBERS
