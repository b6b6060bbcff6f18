"""How the samples of a picture are traced: by which program, with what it reads, and how fast."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from culet.rendering.chains import first_sample
from culet.rendering.features import Features, features_of
from culet.rendering.kernel_inputs.inputs import Inputs
from culet.rendering.pace import KernelPace
from culet.rendering.programs.build import Kernel
from culet.stage import Stage


class Tracing:
    """Of samples of one kind."""

    def __init__(self, kernel: Kernel, pace: KernelPace, make: Callable[[], Inputs]) -> None:
        self.kernel, self.pace = kernel, pace
        self._make = make
        self._inputs: Inputs | None = None

    @property
    def inputs(self) -> Inputs:
        """On the device from now on."""
        self._inputs = self._inputs or self._make()
        return self._inputs

    def release(self) -> None:
        """Take what it reads off the device, until it is asked for again."""
        self._inputs = None


class Tracings:
    """Of one picture: the first sample may be of another kind than those after it (`first_sample`). Each kind is made
    when its first sample is due, and then kept: a program that comes to be ready meanwhile might round otherwise. What
    only the first sample reads leaves the device after it: a mesh with its tree is large."""

    def __init__(self, stage: Stage, features: Features, make: Callable[[Stage, Features], Tracing]) -> None:
        """`features` of the samples after the first one."""
        first = first_sample(stage)
        changes = first is not stage
        self._kinds = (first, replace(features, spectral=0) if changes else features), (stage, features)
        self._make = make
        self._made: list[Tracing | None] = [None, None] if changes else [None]

    def of(self, sample: int) -> Tracing:
        """The one that traces that sample."""
        number = min(sample, len(self._made) - 1)
        made = self._made[number] or self._make(*self._kinds[number])
        self._made[number] = made
        first = self._made[0]
        if number > 0 and first is not None:
            first.release()
        return made

    def prepare(self, sample: int) -> None:
        """Have on the device what that sample reads."""
        self.of(sample).inputs.prepare(sample)


def needed_features(stage: Stage, samples: int) -> Features:
    """The program that the next sample of a picture needs that has so many."""
    return features_of(stage if samples > 0 else first_sample(stage))
