"""Angles of a convex stone's facets changed with its meets kept.

A meet is a corner in which more than three facets come together: of three any angles will do. To keep it is a condition
on angles and distances of its facets, linear in the distances; all conditions together are solved by Gauss and Newton's
method from where the stone is, a degree at a time. Other angles stay if distances alone can follow; if not, they follow
by the least that is possible. The outline of the girdle stays, and so do the mean heights of its upper and lower edge.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import null_space, qr

from culet.errors import MeshError
from culet.geometry.designs.measures import DesignOutline, outline_of
from culet.geometry.half_spaces import Intersection, intersection

Array = NDArray[np.float64]

FIELD = "angles"
STEP = 1.0
"""Degrees that the angles are changed by at a time."""
FARTHEST = 20.0
"""Degrees that an angle may change; a cutter's changes are of a few."""
LEAST_DEGREES, MOST_DEGREES = 0.01, 89.99
"""Between which angles are told of and searched: a tier beyond is taken for a level or an upright one."""
MOST_FACETS, MOST_GROUPS = 400, 100
"""Of a stone whose angles are changed. Public designs have up to 304 facets."""
ITERATIONS = 12
MOST_WORK = 1e10
"""Multiplications, about 3 s of one processor, after which angles are given up: an engine's pictures wait meanwhile.
Of the 400 facets and 100 groups that are the most, all of them in meets, they are 115 iterations. Each end of a reach
has half of it: where that is spent, nothing is known of what is beyond, and FARTHEST is told."""
DERIVATIVES = 130
"""Multiplications for each derivative that finding it takes as long as; as measured."""
DONE = 1e-12
"""Change of distances, in units of the stone's extent, and of angles, radians, at which a solution is one."""
APART = 1e-8
"""In units of the stone's extent, how much further apart the facets of a meet may be than before."""
RANK = 1e-6
"""Of singular values, relative to the largest, below which nothing is said: designs have 0.03 or more, or rounding."""
SAME_TIER = 1e-6
"""Slopes, radians, and distances, of the stone's extent, nearer than this are one: files have 8 decimals."""
LEVEL = 1e-9
HALVINGS = 8
"""Of the way from where meets are kept to where they are not, to say how far angles may go."""

END_HALVINGS = 5
"""Of a step, for an end that is told before anybody asks for it: 0.03 degrees."""


def with_angles(name: str, planes: Array, tiers: Sequence[int], degrees: Mapping[int, float]) -> Array:
    """(F, 4) planes of a closed convex stone, z up, in their order, the tiers named at so many degrees from the
    horizontal. MeshError, its field `angles`, for what is no tier of sloping facets of one angle, and for meets that
    cannot be kept, with how far they could."""
    stone = _tiers_of(name, planes, tiers)
    wanted = {stone.group(tier): math.radians(angle) for tier, angle in degrees.items()}
    return stone.turned(wanted)


def reach_of_tier(
    name: str, planes: Array, tiers: Sequence[int], tier: int, degrees: Mapping[int, float]
) -> tuple[float, float]:
    """The least and the greatest angle of a tier, degrees, at which all meets are kept, FARTHEST from its own at most,
    where other tiers are at `degrees` and stay there; FARTHEST too where following the meets takes too long, which a
    change to there may then be refused for. MeshError as of `with_angles`."""
    stone = _tiers_of(name, planes, tiers)
    wanted = {stone.group(other): math.radians(angle) for other, angle in degrees.items()}
    least, most = stone.reach(stone.group(tier), wanted)
    return math.degrees(least), math.degrees(most)


def independent_tiers(name: str, planes: Array, tiers: Sequence[int]) -> list[int]:
    """The most tiers whose angles can all be changed at once, each for itself, with all meets kept; the angles of the
    other tiers follow from theirs. MeshError for a stone of no tiers, or of too many facets."""
    stone = _tiers_of(name, planes, tiers)
    turnable = [
        group for group, tier in enumerate(stone.tier_of_group)
        if stone.sloping[group] and stone.tier_of_group.count(tier) == 1
    ]  # fmt: skip
    return [stone.tier_of_group[group] for group in stone.independent(turnable)]


def angle_of_tiers(planes: Array, tiers: Sequence[int]) -> dict[int, float]:
    """Degrees from the horizontal of the tiers that `with_angles` can change."""
    found: dict[int, list[float]] = {}
    for (_, _, rise, _), tier in zip(planes.tolist(), tiers, strict=True):
        found.setdefault(tier, []).append(rise)
    return {
        tier: math.degrees(math.acos(abs(rises[0])))
        for tier, rises in sorted(found.items())
        if LEVEL < abs(rises[0]) < 1 - LEVEL and max(rises) - min(rises) < SAME_TIER
    }


def _tiers_of(name: str, planes: Array, tiers: Sequence[int]) -> _Tiers:
    """MeshError for a stone of no tiers, or of too many facets."""
    if not tiers:
        raise MeshError(f"{name}: {FIELD}: expected a stone whose facets have tiers, as designs and cuts have", FIELD)
    if len(planes) > MOST_FACETS:
        raise MeshError(
            f"{name}: {FIELD}: expected at most {MOST_FACETS} facets to change angles of, got {len(planes)}",
            FIELD,
        )
    return _Tiers(name, planes, tiers)


class _SpentError(Exception):
    """MOST_WORK was done."""


@dataclass(frozen=True, eq=False)
class _Setting:
    """Of each group of facets its slope, radians from the vertical axis' upper end, and its distance."""

    slope: Array
    distance: Array


class _Tiers:
    """A stone by its groups of facets of one tier, slope and distance, and its meets."""

    def __init__(self, name: str, planes: Array, tiers: Sequence[int]) -> None:
        self.name = name
        cut = intersection(name, planes)
        self.planes, self.used = cut.planes, cut.used
        self.outline: DesignOutline = outline_of(cut)
        self.extent = float(np.ptp(self.outline.corners, axis=0).max())
        level = np.hypot(cut.planes[:, 0], cut.planes[:, 1])
        self.facing = np.divide(
            cut.planes[:, :2], level[:, None], out=np.zeros((len(level), 2)), where=level[:, None] > LEVEL
        )
        """(F, 2) of each facet the level direction that it faces; nothing of a level one."""
        slope = np.arctan2(np.where(level > LEVEL, level, 0), cut.planes[:, 2])
        self.members = _grouped(tiers, slope, cut.planes[:, 3] / self.extent)
        if len(self.members) > MOST_GROUPS:
            raise MeshError(
                f"{name}: {FIELD}: expected facets of at most {MOST_GROUPS} angles and distances, got "
                f"{len(self.members)}", FIELD,
            )  # fmt: skip
        self.tier_of_group = [tiers[members[0]] for members in self.members]
        self.of_facet = np.empty(len(slope), int)
        for group, members in enumerate(self.members):
            self.of_facet[members] = group
        first = [members[0] for members in self.members]
        self.start = _Setting(slope[first], cut.planes[first, 3])
        self.upright = abs(cut.planes[first, 2]) < LEVEL
        self.sloping = (level[first] > LEVEL) & ~self.upright
        self.corners = self._facets_of_corners()
        self.edges = self._edges(cut)
        self.points = self._points()
        self.work = 0.0
        """Multiplications of all iterations."""
        self.kept, _ = self._evaluated(self.start)
        """Distances of meets' facets, which files' decimals leave somewhat apart, and heights, as they came."""

    def group(self, tier: int) -> int:
        """Of a tier that can be turned."""
        groups = [k for k, number in enumerate(self.tier_of_group) if number == tier]
        if not groups:
            known = sorted(set(self.tier_of_group))
            raise MeshError(f"{self.name}: {FIELD}: expected a tier of {known[0]} to {known[-1]}, got {tier}", FIELD)
        if len(groups) > 1 or not self.sloping[groups[0]]:
            what = "facets of several angles or distances" if len(groups) > 1 else "level or upright facets"
            raise MeshError(f"{self.name}: {FIELD}: expected a tier of sloping facets; tier {tier} is {what}", FIELD)
        return groups[0]

    def independent(self, groups: Sequence[int]) -> list[int]:
        """Of those groups the most whose slopes can be chosen: where the settings that keep all meets lead, at first,
        by pivots of a QR decomposition."""
        _, by = self._evaluated(self.start)
        free = np.concatenate([self.sloping, ~self.upright])
        kernel = null_space(by[:, free], rcond=RANK)
        ways = np.zeros((len(free), kernel.shape[1]))
        ways[free] = kernel
        chosen = ways[list(groups)]
        if not chosen.size:
            return []
        _, triangle, order = qr(chosen.T, mode="economic", pivoting=True)
        size = abs(np.diagonal(triangle))
        return sorted(groups[k] for k, length in zip(order, size, strict=False) if length > RANK * size.max())

    def turned(self, wanted: Mapping[int, float]) -> Array:
        """Planes with the groups at angles from the horizontal, radians."""
        return self._planes(self._settled(wanted))

    def reach(self, group: int, wanted: Mapping[int, float]) -> tuple[float, float]:
        """Of a group the least and the greatest angle from the horizontal, radians, others at theirs."""
        setting = self._settled(wanted) if wanted else self.start
        turned = np.array(sorted({*wanted, group}))
        ends = []
        for sign in (-1, 1):
            self.work = MOST_WORK / 2  # each its own half, whatever the other one took
            ends.append(self._end(setting, turned, group, sign))
        return ends[0], ends[1]

    def _end(self, setting: _Setting, turned: NDArray[np.int64], group: int, sign: int) -> float:
        """How far a group goes, less steep or steeper, from a setting in which others of `turned` stay as they are."""
        slopes = setting.slope[turned]
        up, place = bool(self.start.slope[group] < math.pi / 2), int(np.searchsorted(turned, group))
        kept = begin = _level(float(slopes[place]))
        last = _level(float(self.start.slope[group])) + sign * math.radians(FARTHEST)
        last = min(max(last, LEVEL), math.pi / 2 - LEVEL)
        steps = max(1, math.ceil(math.degrees(abs(last - begin)) / STEP))
        lost = None
        try:
            while kept != last and (lost is None or abs(lost - kept) > math.radians(STEP) / 2**END_HALVINGS):
                there = kept + (last - begin) / steps if lost is None else (kept + lost) / 2
                there = last if abs(there - last) < LEVEL else there
                slopes[place] = there if up else math.pi - there
                further = self._kept(setting, turned, slopes)
                if further is None:
                    lost = there
                else:
                    setting, kept = further, there
        except _SpentError:
            return last if lost is None else kept  # the former is not proven: a change to there is tried anyhow
        return kept

    def _settled(self, wanted: Mapping[int, float]) -> _Setting:
        turned = np.array(sorted(wanted))
        up = self.start.slope[turned] < math.pi / 2
        ends = np.array([wanted[group] for group in turned.tolist()])
        begin, end = self.start.slope[turned], np.where(up, ends, math.pi - ends)
        far = np.degrees(abs(end - begin))
        if far.max() > FARTHEST + math.degrees(SAME_TIER):  # an end that was told is not refused for its last digit
            most = int(far.argmax())
            own, tier = math.degrees(_level(begin[most])), self.tier_of_group[turned[most]]
            raise MeshError(
                f"{self.name}: {FIELD}: expected tier {tier} within {FARTHEST:g} degrees of {own:.2f}, got "
                f"{math.degrees(_level(end[most])):g}", FIELD,
            )  # fmt: skip
        steps = max(1, math.ceil(far.max() / STEP))
        setting, kept = self.start, 0.0
        for step in range(1, steps + 1):
            part = step / steps
            try:
                further = self._kept(setting, turned, begin + part * (end - begin))
            except _SpentError:
                raise self._given_up(turned, begin + kept * (end - begin), end) from None
            if further is None:
                raise self._refusal(setting, turned, begin, end, kept, part)
            setting, kept = further, part
        return setting

    def _refusal(
        self, setting: _Setting, turned: NDArray[np.int64], begin: Array, end: Array, kept: float, lost: float
    ) -> MeshError:
        for _ in range(HALVINGS):
            middle = (kept + lost) / 2
            try:
                further = self._kept(setting, turned, begin + middle * (end - begin))
            except _SpentError:
                break
            if further is None:
                lost = middle
            else:
                setting, kept = further, middle
        reached = begin + kept * (end - begin)
        return MeshError(
            f"{self.name}: {FIELD}: expected angles that keep all meets and facets, as far as "
            f"{self._said(turned, reached)}; got {self._said(turned, end)}", FIELD,
        )  # fmt: skip

    def _given_up(self, turned: NDArray[np.int64], reached: Array, end: Array) -> MeshError:
        return MeshError(
            f"{self.name}: {FIELD}: expected a smaller change of a stone of {len(self.planes)} facets and "
            f"{len(self.members)} angles and distances, whose meets were followed as far as "
            f"{self._said(turned, reached)} in the time for it; got {self._said(turned, end)}", FIELD,
        )  # fmt: skip

    def _said(self, turned: NDArray[np.int64], slopes: Array) -> str:
        return ", ".join(
            f"tier {self.tier_of_group[group]} at {math.degrees(_level(slope)):.2f}"
            for group, slope in zip(turned.tolist(), slopes.tolist(), strict=True)
        )

    def _kept(self, setting: _Setting, turned: NDArray[np.int64], slopes: Array) -> _Setting | None:
        """The nearest setting with those slopes, other angles as they are if that can be; None if it loses a meet or a
        facet."""
        for others in (False, True):
            found = self._solved(setting, turned, slopes, others)
            if found is not None and self._is_whole(found):
                return found
        return None

    def _solved(self, setting: _Setting, turned: NDArray[np.int64], slopes: Array, others: bool) -> _Setting | None:
        slope, distance = setting.slope.copy(), setting.distance.copy()
        slope[turned] = slopes
        free_slope = self.sloping.copy() if others else np.zeros(len(slope), bool)
        free_slope[turned] = False
        free = np.concatenate([free_slope, ~self.upright])
        for _ in range(ITERATIONS):
            values, by = self._evaluated(_Setting(slope, distance))
            self.work += by.size * (by.shape[1] + DERIVATIVES)
            if self.work > MOST_WORK:
                raise _SpentError
            step = np.zeros(len(free))
            step[free] = np.linalg.lstsq(by[:, free], self.kept - values, rcond=RANK)[0]
            slope, distance = slope + step[: len(slope)], distance + step[len(slope) :] * self.extent
            if not np.isfinite(step).all() or abs(step).max() > 1:
                return None
            if abs(step).max() < DONE:
                break
        found = _Setting(slope, distance)
        return found if abs(self._evaluated(found)[0] - self.kept).max(initial=0) < APART else None

    def _is_whole(self, setting: _Setting) -> bool:
        """Whether the solid has the same facets, and of each the same corners."""
        if not (setting.slope[self.sloping] > 0).all() or not (setting.slope[self.sloping] < math.pi).all():
            return False
        try:
            cut = intersection(self.name, self._planes(setting))
        except MeshError:
            return False
        return cut.used == self.used and _facets_of_corners(outline_of(cut)) == set(map(frozenset, self.corners))

    def _planes(self, setting: _Setting) -> Array:
        slope, distance = setting.slope[self.of_facet], setting.distance[self.of_facet]
        rise = np.where(self.upright[self.of_facet], 0, np.cos(slope))
        planes = np.column_stack([np.sin(slope)[:, None] * self.facing, rise, distance])
        moved = abs(setting.slope - self.start.slope) + abs(setting.distance - self.start.distance) / self.extent
        return np.where((moved > DONE)[self.of_facet, None], planes, self.planes)  # who stays does so to the last bit

    def _evaluated(self, setting: _Setting) -> tuple[Array, Array]:
        """Of each facet in a meet its distance from the point nearest to all of them, then the mean heights of the
        girdle's edges; and the derivatives by slopes and distances. Lengths are in units of the extent."""
        count, corners = len(setting.slope), len(self.corners)
        values, rows = [np.zeros(0)], [np.zeros((0, 2 * count))]
        height, height_by = np.zeros(corners), np.zeros((corners, 2 * count))
        for which, facets in self.points:
            group = self.of_facet[facets]
            slope, distance, facing = setting.slope[group], setting.distance[group], self.facing[facets]
            normals = np.concatenate([np.sin(slope)[..., None] * facing, np.cos(slope)[..., None]], axis=2)
            turning = np.concatenate([np.cos(slope)[..., None] * facing, -np.sin(slope)[..., None]], axis=2)
            inverse = np.linalg.pinv(normals)
            point = inverse @ distance[..., None]
            by = np.zeros((*facets.shape, 2 * count))
            place = np.arange(len(facets))[:, None], np.arange(facets.shape[1])
            by[*place, group] = (turning @ point)[..., 0] / self.extent
            by[*place, count + group] = -1
            moved = inverse @ by
            height[which], height_by[which] = point[:, 2, 0] / self.extent, -moved[:, 2]
            if facets.shape[1] > 3:
                values.append(((normals @ point)[..., 0] - distance).ravel() / self.extent)
                rows.append((by - normals @ moved).reshape(-1, 2 * count))
        for edge in self.edges:
            values.append(height[edge].mean(keepdims=True))
            rows.append(height_by[edge].mean(axis=0, keepdims=True))
        return np.concatenate(values), np.vstack(rows)

    def _facets_of_corners(self) -> list[list[int]]:
        found: list[list[int]] = [[] for _ in self.outline.corners]
        for facet, face in enumerate(self.outline.faces):
            for corner in face:
                found[corner].append(facet)
        return [facets for facets in found if facets]

    def _points(self) -> list[tuple[NDArray[np.int64], NDArray[np.int64]]]:
        """The corners that say something, meets and those of the girdle's edges, by the number of their facets: (K,)
        corners and (K, n) their facets."""
        on_edges = {corner for edge in self.edges for corner in edge}
        by_number: dict[int, list[int]] = {}
        for corner, facets in enumerate(self.corners):
            if len(facets) > 3 or corner in on_edges:
                by_number.setdefault(len(facets), []).append(corner)
        return [(np.array(of), np.array([self.corners[corner] for corner in of])) for of in by_number.values()]

    def _edges(self, cut: Intersection) -> list[list[int]]:
        """Corners of the girdle's upper and lower edge; where there is none, those in which crown and pavilion meet."""
        rise = cut.planes[:, 2]
        upper, lower, keen = list[int](), list[int](), list[int]()
        for corner, facets in enumerate(self.corners):
            above, below = (rise[facets] > LEVEL).any(), (rise[facets] < -LEVEL).any()
            upright = (abs(rise[facets]) <= LEVEL).any()
            if above and below:
                keen.append(corner)
            elif upright:
                (upper if above else lower).append(corner)
        return [edge for edge in (upper, lower) if edge] or [keen] * bool(keen)


def _level(slope: float) -> float:
    """From the horizontal, of a slope from the upper end of the axis; radians."""
    return min(slope, math.pi - slope)


def _facets_of_corners(outline: DesignOutline) -> set[frozenset[int]]:
    found: list[set[int]] = [set() for _ in outline.corners]
    for facet, face in enumerate(outline.faces):
        for corner in face:
            found[corner].add(facet)
    return {frozenset(facets) for facets in found if facets}


def _grouped(tiers: Sequence[int], slope: Array, distance: Array) -> list[list[int]]:
    """Facets of one tier, slope and distance."""
    groups: list[list[int]] = []
    by_tier: dict[int, list[int]] = {}
    for facet, tier in enumerate(tiers):
        for group in by_tier.setdefault(tier, []):
            first = groups[group][0]
            if max(abs(slope[facet] - slope[first]), abs(distance[facet] - distance[first])) < SAME_TIER:
                groups[group].append(facet)
                break
        else:
            by_tier[tier].append(len(groups))
            groups.append([facet])
    return groups
