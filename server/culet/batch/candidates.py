"""Designs that differ in tangent ratios and tiers' angles, graded side by side, each once.

All are graded by the same rays, so that their differences are better known than their grades. What is graded, and in
which order it stands here, does not depend on who grades, nor on how many do.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field

from culet.batch.crew import IN_PROCESS, Crew, in_turn
from culet.batch.metrics import light_sums
from culet.errors import MeshError
from culet.geometry.cutting.recut import recut_shape
from culet.geometry.shape import Shape
from culet.grading.grades import grade
from culet.grading.metrics import number_of
from culet.grading.number import Number
from culet.grading.optics import StoneOptics
from culet.grading.rules import Rules
from culet.scene.recut import Recut

BRIGHTNESS, FIRE = "iso", "fire"
"""The grades between which the front lies."""
RATIO_DECIMALS, ANGLE_DECIMALS = 4, 3
"""Of ratios, and of degrees, that are graded and told: a tenth of a minute of arc or so."""
Angles = tuple[tuple[int, float], ...]


@dataclass(frozen=True)
class TrialDesign:
    """As it is cut."""

    crown_ratio: float = 1.0
    pavilion_ratio: float = 1.0
    angles: Angles = ()
    """Tiers' numbers and degrees."""

    @staticmethod
    def of(crown: float, pavilion: float, angles: Mapping[int, float] | None = None) -> TrialDesign:
        """The one that is graded in place of it."""
        turned = ((tier, round(float(degrees), ANGLE_DECIMALS)) for tier, degrees in (angles or {}).items())
        return TrialDesign(round(float(crown), RATIO_DECIMALS), round(float(pavilion), RATIO_DECIMALS), tuple(turned))

    def recut(self) -> Recut:
        """Of the design that was given."""
        return Recut(crown_ratio=self.crown_ratio, pavilion_ratio=self.pavilion_ratio, angles=dict(self.angles))


@dataclass(frozen=True)
class Candidate:
    """A design that was graded."""

    crown_ratio: float
    pavilion_ratio: float
    grades: Mapping[str, Number]
    total: float
    """The weighted sum."""
    angles: Mapping[int, float] = field(default_factory=dict)
    """Degrees of tiers, by their numbers, besides the ratios."""


class SpentError(Exception):
    """As many designs as may be graded have been."""


@dataclass(frozen=True, eq=False)
class GradeTask:
    """Grades a design cut in other ways."""

    shape: Shape
    optics: StoneOptics
    rules: Rules
    names: tuple[str, ...]

    def __call__(self, design: TrialDesign) -> dict[str, Number] | MeshError:
        """The grades by name; or why there are none, of what is no stone."""
        try:
            shape = recut_shape(self.shape, design.recut())
            grades = next(grade(light_sums(), shape, self.optics, self.rules))
        except MeshError as error:
            return error
        return {name: number_of(grades, name) for name in self.names}


AskTrial = Callable[[TrialDesign], Candidate | None]
"""None of what is no stone; SpentError if no more may be graded."""


@dataclass(frozen=True)
class Search:
    """An optimiser at work. It asks the same whenever it is run and told the same."""

    run: Callable[[AskTrial], object]
    together: int = 1
    """So many designs it asks for at first, whatever it is told of them."""


class UnknownError(Exception):
    """What a search was to be told next is not known yet."""


class Candidates:
    """Designs that are graded for searches, and the best of them."""

    def __init__(
        self,
        shape: Shape,
        optics: StoneOptics,
        rules: Rules,
        weights: Mapping[str, float],
        *,
        crew: Crew = IN_PROCESS,
        progress: Callable[[int], None] = lambda graded: None,
    ) -> None:
        """`weights` of grades by name; `progress` is told how many designs have been graded."""
        self.shape = shape
        self.found: list[Candidate] = []
        """In the order in which searches came upon them."""
        self.graded: dict[TrialDesign, Candidate | None] = {}
        self._listed: set[TrialDesign] = set()
        self._weights, self._crew, self._progress = weights, crew, progress
        self._task = GradeTask(shape, optics, rules, tuple(dict.fromkeys([BRIGHTNESS, FIRE, *weights])))

    def grade_given(self) -> None:
        """The design as it is, the first of those that are found; MeshError if it cannot be."""
        given = TrialDesign()
        ((_, grades),) = self._crew.results(self._task, in_turn([given]))
        if isinstance(grades, MeshError):
            raise grades
        self._keep(given, grades)
        self._list([given])

    def grade(self, designs: Sequence[TrialDesign]) -> None:
        """Those that are not yet, side by side."""
        new = [design for design in dict.fromkeys(designs) if design not in self.graded]
        try:
            with closing(self._crew.results(self._task, in_turn(new))) as done:
                for design, grades in done:
                    self._keep(design, grades)
        finally:
            self._list(new)

    def run(self, searches: Sequence[Search], room: int) -> None:
        """Searches side by side, each of which may come upon so many designs that nobody knew before them all.

        An optimiser of a library waits for the value of one design. So it is run until it asks for what is not known,
        and from its beginning again when that is.
        """
        known = frozenset(self.graded)
        own: list[dict[TrialDesign, None]] = [{} for _ in searches]
        missing: dict[TrialDesign, list[int]] = {}
        to_do = deque[TrialDesign]()

        def advance(number: int) -> None:
            for design in self._unknown(searches[number], known, own[number], room):
                if design not in missing:
                    missing[design] = []
                    to_do.append(design)
                missing[design].append(number)

        def more(most: int) -> list[TrialDesign]:
            return [to_do.popleft() for _ in range(min(most, len(to_do)))]

        try:
            for number in range(len(searches)):
                advance(number)
            with closing(self._crew.results(self._task, more)) as done:
                for design, grades in done:
                    self._keep(design, grades)
                    for number in missing.pop(design):
                        if not any(number in others for others in missing.values()):
                            advance(number)
        finally:
            self._list(design for designs in own for design in designs)

    def _unknown(
        self, search: Search, known: frozenset[TrialDesign], own: dict[TrialDesign, None], room: int
    ) -> Sequence[TrialDesign]:
        """What a search asks for next; nothing when it has ended. Where nobody grades beside this process there is no
        need to begin again."""
        asked = 0
        unknown: dict[TrialDesign, None] = {}

        def ask(design: TrialDesign) -> Candidate | None:
            nonlocal asked
            asked += 1
            if unknown and asked > search.together:
                raise UnknownError
            if design not in known and design not in own:
                if len(own) >= room:
                    raise SpentError
                own[design] = None
            if design not in self.graded:
                if not self._crew.alone:
                    unknown[design] = None
                    return None
                self.grade([design])
            return self.graded[design]

        with suppress(SpentError, UnknownError):
            search.run(ask)
        return list(unknown)

    def front(self) -> list[Candidate]:
        """Those that no other beats in brightness and fire both, from the brightest to the most fiery."""
        order = sorted(self.found, key=lambda each: (-each.grades[BRIGHTNESS].value, -each.grades[FIRE].value))
        front: list[Candidate] = []
        for each in order:
            if not front or each.grades[FIRE].value > front[-1].grades[FIRE].value:
                front.append(each)
        return front

    def best(self) -> Candidate:
        """By the weighted sum."""
        return max(self.found, key=lambda each: each.total)

    def _keep(self, design: TrialDesign, grades: Mapping[str, Number] | MeshError) -> None:
        if isinstance(grades, MeshError):
            self.graded[design] = None
        else:
            total = sum(weight * grades[name].value for name, weight in self._weights.items())
            self.graded[design] = Candidate(
                design.crown_ratio, design.pavilion_ratio, grades, total, dict(design.angles)
            )
        self._progress(len(self.graded))

    def _list(self, designs: Iterable[TrialDesign]) -> None:
        """Of those in their order, the ones that are stones and not yet listed, whoever was quicker."""
        for design in designs:
            each = self.graded.get(design)
            if each is not None and design not in self._listed:
                self._listed.add(design)
                self.found.append(each)
