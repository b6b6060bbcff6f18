"""How long a step of the render kernel takes, and so how many make a launch of a given time."""

from __future__ import annotations

import math

FIRST_STEP = 20e-6
"""s. A step that nobody has timed yet: dearer than nearly all are, so that a first launch is too short rather than too
long."""
LAUNCH = 2e-4
"""s. Of a launch, besides its steps: it would make the steps of a short one look dear."""
MEMORY = 0.2
"""Weight of the latest launch in the expected time, if it was quicker. One that was slower counts in full: the next
launch is at the same part of the picture, and parts differ by a factor of ten."""
LEAST_STEPS = 32
"""Of a launch. Fewer would take less time than the launch itself."""
MOST_STEPS = 2**31 - 1
"""That the kernel's argument can hold."""


class KernelPace:
    """Of one program and one size of stone; shared by pictures, since every moving frame is a picture of its own."""

    def __init__(self) -> None:
        """Not known yet."""
        self._step: float | None = None

    def steps(self, seconds: float) -> int:
        """For a launch of so many seconds; infinity asks for one launch, whatever it takes."""
        if math.isinf(seconds):
            return MOST_STEPS
        step = FIRST_STEP if self._step is None else self._step
        return int(min(max(seconds / step, LEAST_STEPS), MOST_STEPS))

    def made(self, steps: int, seconds: float) -> None:
        """A launch has made so many steps in so many seconds; 0 steps, as of an empty picture, say nothing."""
        if steps == 0:
            return
        step = max(seconds - LAUNCH, 1e-9) / steps
        if self._step is None or step > self._step:
            self._step = step
        else:
            self._step += MEMORY * (step - self._step)
