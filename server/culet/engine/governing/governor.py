"""The governor: how good a frame may be while things move, so that the frame rate asked for is held.

It chooses from a ladder of settings: the best, and below it the front of least error for each cost, which
`python -m culet.study.serving.ladder` has measured. Down at once when a frame has taken too long, up only after a run
of frames that would have had time to spare, and then as far as there is time. The session's balance says which frame
rate is asked for, or pins a setting. At rest nothing is chosen: the picture is refined as the scene has it.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass
from functools import lru_cache
from importlib.resources import files

from culet.engine.governing.measured_errors import SettingErrors, read_setting_errors
from culet.engine.governing.thrift import Encoding
from culet.rendering.chains import bands_seen
from culet.scene import Scene
from culet_protocol.messages import Balance, balance_rate

SHARE = 0.9
"""Of a frame's time that the render thread may work for it, at most;"""
RESERVE_SECONDS = 0.004
"""but so much less than all of it: encoding, the event loop and the rest of the machine take no less time of a short
frame."""
SHARE_OF_MANY = 0.8
"""Where others draw too, whose frames are encoded beside this one's."""
STEERED = 0.75
"""Part of either that is filled while somebody steers: what an input changes waits for the frame before it, and is then
drawn, encoded and decoded, all of which takes as long as a frame is dear."""
LEAST_SHARE = 0.3
"""Of a frame's time that rendering gets, however long simulation and tone mapping take."""
SPARE = 0.8
"""A better setting must be expected to take less than this part of the time before it is tried: of a fall's frames nine
of ten differ by less than a tenth from the one before."""
PATIENCE = 12
"""Frames with time to spare before a better setting is tried: 0.4 s at 30 frames/s, or quality would flicker."""
TRIAL = 60
"""Frames for which a better setting must hold: if it does not, twice as many frames pass before the next try."""
MOST_PATIENCE = 4 * PATIENCE
"""Until one has held, and the failures are forgotten."""
MEMORY = 0.15
"""Weight of the latest frame in the expected cost,"""
LATE = 1.5
"""but one that took so many frames' time (50 ms at 30 frames/s) counts in full: the next must not be as late."""
WORTH = 0.98
"""A setting must miss less than so many times what a cheaper one does: for less, none is worth a change that is
seen."""
LEAST_PIXELS = 640 * 360
"""Of a frame, below which none is scaled unless the viewer asked for less, or the cheapest setting at that size is too
dear for ALONE_RATE and CROWDED_RATE."""
SMALLEST_PIXELS = 320 * 180
"""Of a frame, below which none is scaled then either, unless many share the render thread: then down to LEAST_PIXELS
times the share, so that all frames together have as many pixels."""
ALONE_RATE = 15.0
"""Frames per second for which a frame of a session that is alone is made smaller than LEAST_PIXELS: with fewer the eye
sees single pictures, and no motion. Frames of the cheapest setting at the least size may come oftener, if there is
time, but are not made smaller for it."""
CROWDED_RATE = 8.0
"""The same where many share the render thread."""
SHRINK = 2**-0.25
"""Of width and height, each time: a step that is hardly seen."""

MOVING_BANDS = 3
"""Wavelengths of a moving frame. Others cost by their number: 8 take 2.6 times as long (`culet bench`)."""
POLARISED_COST = 1.1
"""Time of a polarised picture over that of one that is not (`culet bench`)."""

LIGHT_CUTOFFS = ((0.4, 1.7e-4), (0.2, 1e-3), (0.1, 2e-3), (0.0, 5e-3))
"""Cut-offs of the light map, by the cost of a rung, at least. Under two points and a sun the first cuts 0.16 of the
light, and takes a third of the frame's time besides (`culet study light`); 1e-3 cuts 0.27 and takes a seventh. Where
frames are late and small, they would be made later by what does not shrink with them. Several stones share that time:
for them the cut-off is as many times as high."""


@dataclass(frozen=True)
class Setting:
    """One rung of the ladder."""

    scale: float
    """Of width and height."""
    cutoff: float
    """At least, whatever the scene says."""
    max_bounces: int
    """At most, whatever the scene says."""
    cost: float
    """Time over that of the first rung, measured."""
    error: float
    """Root mean square error of what is shown, 0 to 1, at one sample a pixel; measured on the default scene."""

    @property
    def caustics_cutoff(self) -> float:
        """Of the light map, at least, whatever the scene says."""
        return next(cutoff for cost, cutoff in LIGHT_CUTOFFS if self.cost >= cost)

    @property
    def pixel_cost(self) -> float:
        """Time of one pixel, over that of the first rung."""
        return self.cost / self.scale**2


@dataclass(frozen=True)
class Plan:
    """How a moving frame is to be drawn."""

    scene: Scene
    """With the optics chosen."""
    size: tuple[int, int]
    """Pixels."""
    wanted: tuple[int, int]
    """Pixels that the viewer asked for."""
    setting: Setting | None
    """None if a balance is pinned to all that the scene asks for."""
    error: float
    """Root mean square error of the radiance, as measured for this scale, cut-off and bounces on the default scene; NaN
    if such ones were not, as those of a whole scene."""
    encoding: Encoding | None = None
    """None if no link limits it."""


def read_ladder() -> tuple[Setting, ...]:
    """As measured, the best first, which is the dearest: the cheaper, the more error."""
    rungs = json.loads(files(__package__).joinpath("ladder.json").read_text(encoding="utf-8"))["rungs"]
    return tuple(Setting(**rung) for rung in rungs)


def asked_rate(balance: Balance, most: float) -> float:
    """Frames per second to hold for viewers that take `most`; as many as they take if the quality is pinned."""
    return most if balance.pinned else min(most, balance_rate(balance.exactness))


ERRORS = read_setting_errors()


class Governor:
    """Of one session's moving frames. Times are in seconds."""

    def __init__(self, ladder: tuple[Setting, ...], errors: SettingErrors = ERRORS) -> None:
        self._ladder = ladder
        self._errors = errors
        self._rung = 0
        self._eased: int | None = None
        """The rung, cheaper as a rule, that is drawn while somebody steers,"""
        self._eased_spared = 0
        """and the frames with time to spare for a better one."""
        self._shrunk = 0
        """How many times frames are made smaller than the cheapest setting has them."""
        self._easier = 0
        """Frames that one step larger would have had time to spare."""
        self._unit: float | None = None
        """Expected time of the first rung for one pixel."""
        self._overhead = 0.0
        """Expected time of the render thread for a frame besides rendering it."""
        self._spared = 0
        self._rungs: tuple[tuple[int, int], tuple[int, ...]] | None = None
        """Size that was asked for last, and what is worth its cost then."""
        self._patience = PATIENCE
        self._held: int | None = None
        """Frames for which a better setting has held that is on trial; None if none is."""

    @property
    def setting(self) -> Setting:
        """For the next moving frame, unless one is pinned."""
        return self._ladder[self._rung if self._eased is None else self._eased]

    def plan(self, scene: Scene, wanted: tuple[int, int], balance: Balance, reduced: float = 1.0) -> Plan:
        """For the next moving frame: three indices, without polarisation; cut-off, bounces and size by the setting.

        `wanted` are so many times, each way, the pixels that the viewer asked for.
        """
        setting = self._pinned(wanted, balance) if balance.pinned else self.setting
        if setting is None:
            return Plan(scene, wanted, wanted, None, math.nan)
        stones = max(1, len(scene.stones))
        changes = {
            "bands": MOVING_BANDS,
            "polarised": False,
            "cutoff": max(scene.optics.cutoff, setting.cutoff),
            "max_bounces": min(scene.optics.max_bounces, setting.max_bounces),
            "caustics_cutoff": min(1.0, max(scene.optics.caustics_cutoff, stones * setting.caustics_cutoff)),
        }
        simplified = scene.model_copy(update={"optics": scene.optics.model_copy(update=changes)})
        scale = _scale(setting, wanted) * (1 if balance.pinned else SHRINK**self._shrunk)
        size = max(16, round(wanted[0] * scale)), max(16, round(wanted[1] * scale))
        error = self._errors.radiance(reduced * scale, simplified.optics.cutoff, simplified.optics.max_bounces)
        return Plan(simplified, size, wanted, setting, error)

    def rested(
        self,
        scene: Scene,
        size: tuple[int, int],
        seconds: float,
        frames_per_second: float,
        share: float = 1.0,
        *,
        steered: bool = False,
    ) -> None:
        """The first sample of a picture in full took that long to render: as long as no moving frame has told, it says
        what they will take. Without, the first one would be drawn in the dearest setting, however late it comes.

        A cut-off below the ladder's makes them seem dearer than they are: better ones are tried soon.
        """
        if self._unit is not None:
            return
        optics = scene.optics
        dearer = bands_seen(scene, 1) / MOVING_BANDS * (POLARISED_COST if optics.polarised else 1.0)
        self._unit = seconds / (size[0] * size[1] * dearer * self._ladder[0].pixel_cost)
        self._adapt(size, frames_per_second, share, steered=steered)

    def has_cheaper(self, plan: Plan) -> bool:
        """Whether frames of that size can be cheaper than planned."""
        cheapest = self._ladder[self._worthwhile(plan.wanted)[-1]]
        return plan.setting is not None and _cost(plan.setting, plan.wanted) > _cost(cheapest, plan.wanted)

    def rendered(
        self,
        plan: Plan,
        seconds: float,
        overhead: float,
        frames_per_second: float,
        share: float = 1.0,
        *,
        steered: bool = False,
    ) -> None:
        """A moving frame took that long to render, and that long besides; the next ones are to come at that rate, with
        that share of the render thread's time, and `steered` by somebody.

        Chooses the next setting.
        """
        if plan.setting is None:  # other optics than the ladder's: its time says nothing of theirs
            return
        overhead = min(overhead, 1 / frames_per_second)  # a longer one was a stall, and says nothing of the next frame
        unit = seconds / (plan.size[0] * plan.size[1] * plan.setting.pixel_cost)
        held = frames_per_second if self.has_cheaper(plan) else _least_rate(frames_per_second, share)
        late = seconds + overhead > LATE * share / held
        if self._unit is None or (late and unit > self._unit):
            self._unit = unit
        self._unit += MEMORY * (unit - self._unit)
        self._overhead += MEMORY * (overhead - self._overhead)
        self._adapt(plan.wanted, frames_per_second, share, steered=steered)

    def _adapt(self, wanted: tuple[int, int], frames_per_second: float, share: float, *, steered: bool) -> None:
        """Setting and size to what is expected."""
        budget = self._budget(frames_per_second, share)
        self._choose(wanted, budget, drawn=not steered)
        self._ease(wanted, STEERED * budget if steered else None)
        self._shrink(wanted, self._budget(_least_rate(frames_per_second, share), share), share)

    def _budget(self, frames_per_second: float, share: float) -> float:
        """For rendering a frame."""
        interval = share / frames_per_second
        worked = work_share(frames_per_second) if share >= 1 else SHARE_OF_MANY
        return max(worked * interval - self._overhead, LEAST_SHARE * interval)

    def _ease(self, wanted: tuple[int, int], budget: float | None) -> None:
        """Draw a rung of that budget, if there is one, in place of the one that was chosen, which stays as it is."""
        if budget is None:
            self._eased, self._eased_spared = None, 0
            return
        eased = self._rung if self._eased is None else self._eased
        cost = self._expected(eased, wanted)
        best, better = self._best(wanted, budget), self._best(wanted, SPARE * budget)
        self._eased_spared = self._eased_spared + 1 if self._expected(better, wanted) > cost else 0
        if self._expected(best, wanted) < cost:
            eased = best
        elif self._eased_spared >= PATIENCE:
            eased, self._eased_spared = better, 0
        self._eased = min(eased, self._rung, key=lambda rung: self._expected(rung, wanted))

    def _shrink(self, wanted: tuple[int, int], budget: float, share: float) -> None:
        """Make frames of the cheapest setting so small that the least rate is held, and larger when there is time."""
        cost = self._expected(self._rung, wanted)
        if self._rung != self._worthwhile(wanted)[-1] or cost <= 0:
            self._shrunk = 0
            return
        pixels = wanted[0] * wanted[1] * _scale(self.setting, wanted) ** 2
        smallest = max(min(share, SMALLEST_PIXELS / pixels), 1e-6)
        most = math.floor(math.log(smallest) / 2 / math.log(SHRINK) + 1e-9)
        needed = min(most, max(0, math.ceil(math.log(budget / cost) / 2 / math.log(SHRINK))))
        if needed > self._shrunk:
            self._shrunk, self._easier = needed, 0
            return
        larger = cost * SHRINK ** (2 * (self._shrunk - 1))
        self._easier = self._easier + 1 if self._shrunk > needed and larger < SPARE * budget else 0
        if self._easier >= PATIENCE or self._shrunk > most:
            self._shrunk, self._easier = self._shrunk - 1, 0

    def _choose(self, wanted: tuple[int, int], budget: float, *, drawn: bool) -> None:
        """A cheaper rung at once where one is needed, a better one that there was time for again and again. A rung that
        is not `drawn`, but a cheaper one in its place, does not stand its trial."""
        cost = self._expected(self._rung, wanted)
        best = self._best(wanted, budget)
        if self._expected(best, wanted) < cost:
            if self._held is not None:
                self._patience = min(2 * self._patience, MOST_PATIENCE)
            self._rung, self._spared, self._held = best, 0, None
            return
        if drawn:
            self._hold()
        better = self._best(wanted, SPARE * budget)
        self._spared = self._spared + 1 if self._expected(better, wanted) > cost else 0
        if self._spared >= self._patience:
            self._rung, self._spared, self._held = better, 0, 0

    def _hold(self) -> None:
        """A better setting that holds for so long makes its failures forgotten."""
        if self._held is not None:
            self._held += 1
            if self._held == TRIAL:
                self._patience, self._held = PATIENCE, None

    def _pinned(self, wanted: tuple[int, int], balance: Balance) -> Setting | None:
        """The last rung for speed, up to more than the first one for exactness."""
        worthwhile = self._worthwhile(wanted)
        place = round((1 - balance.exactness) * len(worthwhile))
        return self._ladder[worthwhile[place - 1]] if place else None

    def _best(self, wanted: tuple[int, int], budget: float) -> int:
        """The best rung that is expected to take no longer, or the cheapest for that size."""
        worthwhile = self._worthwhile(wanted)
        return next((rung for rung in worthwhile if self._expected(rung, wanted) <= budget), worthwhile[-1])

    def _worthwhile(self, wanted: tuple[int, int]) -> tuple[int, ...]:
        """`worthwhile_rungs`, asked for several times a frame: to look it up by the whole ladder takes longer."""
        if self._rungs is None or self._rungs[0] != wanted:
            self._rungs = wanted, worthwhile_rungs(self._ladder, self._errors, wanted)
        return self._rungs[1]

    def _expected(self, rung: int, wanted: tuple[int, int]) -> float:
        return (self._unit or 0) * wanted[0] * wanted[1] * _cost(self._ladder[rung], wanted)


def work_share(frames_per_second: float) -> float:
    """Of a frame's time that the render thread may work for it at that rate, if nobody else draws: 0.88 at 30 a
    second, 0.76 at 60."""
    return max(LEAST_SHARE, min(SHARE, 1 - RESERVE_SECONDS * frames_per_second))


@lru_cache(maxsize=64)
def worthwhile_rungs(ladder: tuple[Setting, ...], errors: SettingErrors, wanted: tuple[int, int]) -> tuple[int, ...]:
    """Of the ladder, for a viewer of that size, the dearest first.

    LEAST_PIXELS makes some rungs alike, of which the first was measured at the size nearest to what is drawn, and
    others hardly better than cheaper ones. The ladder's first rung is always worth its cost.
    """
    drawn: dict[tuple[float, float, int], int] = {}
    for rung, setting in enumerate(ladder):
        drawn.setdefault((_scale(setting, wanted), setting.cutoff, setting.max_bounces), rung)
    chosen: list[int] = []
    least = math.inf
    for how, rung in sorted(drawn.items(), key=lambda item: _cost(ladder[item[1]], wanted)):
        error = errors.shown(*how)
        if error < WORTH * least or rung == 0:
            chosen.insert(0, rung)
            least = min(least, error)
    return tuple(chosen)


def _least_rate(frames_per_second: float, share: float) -> float:
    """For which frames are made smaller than the cheapest setting has them."""
    return min(frames_per_second, max(ALONE_RATE * share, CROWDED_RATE))


def _cost(setting: Setting, wanted: tuple[int, int]) -> float:
    """Expected time over that of all the pixels that the viewer asked for in the first rung."""
    return _scale(setting, wanted) ** 2 * setting.pixel_cost


def _scale(setting: Setting, wanted: tuple[int, int]) -> float:
    """Of width and height, within the limit."""
    least: float = (LEAST_PIXELS / (wanted[0] * wanted[1])) ** 0.5
    return max(setting.scale, min(1.0, least))
