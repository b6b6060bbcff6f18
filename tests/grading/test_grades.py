"""Grades against GemRay's own program, closed forms, and what must hold for any stone."""

from __future__ import annotations

import math
from collections.abc import Iterable
from typing import TypeVar

import numpy as np
import pytest

from culet.errors import MeshError, SceneError
from culet.geometry.cuts.cut import shape_of_cut
from culet.geometry.designs.solid import shape_of_design
from culet.geometry.half_spaces import shape_from_half_spaces
from culet.geometry.shape import Shape
from culet.grading.grades import BATCHES, grade, grades_of, tilt_curve, weighted_light_return
from culet.grading.optics import StoneOptics, optics_of
from culet.grading.report import reports_of
from culet.grading.rules import GEMRAY, Glare, Rules, rules_of
from culet.grading.sums import FIRE_DEGREES, KERNEL, DomeView, LightSums
from culet.rendering.opencl.device import Device
from culet.scene import Scene
from culet.scene.cuts import BrilliantCut, HeartCut, OvalCut, PrincessCut
from culet.scene.stone import StoneSettings
from culet.stage import Stage
from geometry.designs.files import design

GEMRAY_FIGURES = {
    "01_srb_from_angles": (1.54, 62.24, 54.17, 38.96),
    "02_round_tolkowsky": (2.4175, 77.09, 58.91, 56.59),
    "03_single_cut": (2.4175, 78.63, 60.58, 52.46),
    "04_emerald_1.4": (1.58, 63.27, 36.78, 42.61),
    "05_princess": (2.4175, 59.57, 39.24, 50.80),
    "06_oval_1.4": (1.76, 64.85, 44.63, 50.73),
    "07_portuguese_16": (1.54, 45.40, 35.40, 24.27),
    "10_trillion_120": (1.54, 56.02, 43.83, 35.21),
}
"""Index, ISO, COS and SC2 of GemRay itself (2026-05), 800 x 800 rays, head 10 degrees."""
DIAMOND = StoneOptics(2.4175, 2.4513, 2.4099)
BRILLIANT = shape_of_cut(BrilliantCut())

GLARES: tuple[Glare, ...] = ("all", "crown", "none")

T = TypeVar("T")


@pytest.fixture(scope="module")
def light(device: Device) -> LightSums:
    return LightSums(device)


def last(values: Iterable[T]) -> T:
    """The best of what gets better and better."""
    *_, final = values
    return final


def slab(thickness: float) -> Shape:
    """A square plate, level."""
    sides = [(1, 0, 0, 1), (-1, 0, 0, 1), (0, 0, 1, 1), (0, 0, -1, 1)]
    return shape_from_half_spaces("slab", np.array([(0, 1, 0, thickness), (0, -1, 0, thickness), *sides], float))


@pytest.mark.parametrize("name", GEMRAY_FIGURES)
def test_by_gemrays_rules_grades_are_gemrays(light: LightSums, name: str) -> None:
    index, *figures = GEMRAY_FIGURES[name]
    shape = shape_of_design(design(name))
    grades = last(grade(light, shape, StoneOptics.of_index(index), GEMRAY, target=0.05))
    found = [number.value for number in (grades.iso, grades.cos, grades.sc2)]
    assert found == pytest.approx(figures, abs=0.3)  # measured 0.22 at most, the emerald's SC2
    # Followed to the end there is more light, by what was cut off at most.
    whole = last(grade(light, shape, StoneOptics.of_index(index), Rules(glare="crown"), target=0.05))
    assert -0.2 < whole.iso.value - grades.iso.value < grades.iso.bound + 0.2


def test_a_princess_followed_to_the_end_is_nine_points_brighter(light: LightSums) -> None:
    """68.78 by an independent program, with chains to the end, in double precision."""
    shape = shape_of_design(design("05_princess"))
    grades = last(grade(light, shape, StoneOptics.of_index(2.4175), Rules(glare="crown"), target=0.05))
    assert grades.iso.value == pytest.approx(68.78, abs=0.3)
    assert grades.iso.bound < 0.01


def test_all_light_is_somewhere(light: LightSums) -> None:
    """The furnace: shares of what the viewer sees are all of it; with glare and without a head a white sky is 100 %."""
    for shape in (BRILLIANT, shape_of_cut(OvalCut()), slab(0.4)):
        grades = last(grade(light, shape, DIAMOND, Rules(head_degrees=0), target=0.2))
        assert sum(number.value for number in grades.shares.values()) == pytest.approx(100, abs=2e-3)  # measured 2e-4
        above = sum(grades.shares[name].value for name in ("green", "red", "blue"))
        assert grades.iso.value == pytest.approx(above + grades.shares["glare"].value, abs=1e-3)


def test_a_slab_lets_through_what_its_faces_do(light: LightSums) -> None:
    """Straight down: R = ((n-1)/(n+1))^2 at each face, (1-R)/(1+R) through both; the rest comes back straight up."""
    reflected = (0.5 / 2.5) ** 2
    through = 100 * (1 - reflected) / (1 + reflected)
    grades = last(grade(light, slab(0.2), StoneOptics.of_index(1.5), Rules(head_degrees=0)))
    assert grades.shares["leak"].value == pytest.approx(through, abs=1e-2)
    assert grades.window.value == pytest.approx(100 * (1 - reflected) ** 2, abs=1e-3)
    assert grades.iso.value == pytest.approx(100 - through, abs=1e-2)
    assert grades.cos.value == pytest.approx(100 - through, abs=1e-2)
    assert grades.sc2.value == pytest.approx(0, abs=1e-2)
    assert grades.contrast.value == pytest.approx(0, abs=0.05)
    assert grades.extinction.value == pytest.approx(100)  # 7.7 % come back, less than a tenth
    dark = last(grade(light, slab(0.2), StoneOptics.of_index(1.5), Rules(head_degrees=10)))
    assert dark.iso.value == pytest.approx(0, abs=1e-6)


def test_a_window_is_the_leak_of_light_that_meets_one_facet_inside(light: LightSums) -> None:
    glass, rules = StoneOptics.of_index(1.4), Rules()
    whole, once = (
        light.of(BRILLIANT, glass, each, [DomeView()], batches=4, rays=2048)[0].sum(axis=0)
        for each in (rules, Rules(bounces=1))
    )
    assert whole[KERNEL["WINDOW"]] == pytest.approx(once[KERNEL["LEAK"]], rel=1e-6)
    assert whole[KERNEL["LEAK"]] > 1.05 * whole[KERNEL["WINDOW"]] > 0  # measured 1.062


def test_in_a_closed_setting_facets_that_look_down_mirror_nothing(light: LightSums) -> None:
    """As the stone is tilted to its edge, half of what is seen is pavilion; what that mirrors is glare of all alone."""
    edge_on = DomeView.tilted(80, 0)
    everything, crown, none = (
        light.of(BRILLIANT, DIAMOND, Rules(glare=glare), [edge_on], batches=4, rays=2048)[0].sum(axis=0)
        for glare in GLARES
    )
    iso = KERNEL["ISO"]
    assert none[iso] < crown[iso] < none[iso] + 0.9 * (everything[iso] - none[iso])


def test_absorption_takes_what_beer_and_lambert_say(light: LightSums) -> None:
    thickness = 0.2
    shape = slab(thickness)
    radius = np.abs(shape.vertices[:, 1]).max() / thickness
    passed = math.exp(-0.7 * 2 * thickness * radius)
    grades = last(grade(light, shape, StoneOptics(1.5, 1.5, 1.5, 0.7), Rules(head_degrees=0)))
    reflected = (0.5 / 2.5) ** 2
    assert grades.window.value == pytest.approx(100 * (1 - reflected) ** 2 * passed, abs=1e-3)
    assert sum(number.value for number in grades.shares.values()) == pytest.approx(100, abs=1e-3)


def test_without_dispersion_there_is_no_fire_and_with_little_its_angle_is_linear(light: LightSums) -> None:
    none = last(grade(light, BRILLIANT, StoneOptics.of_index(2.4175), Rules()))
    assert (none.fire.value, none.fire_degrees.value) == (0, 0)
    spreads = [
        last(grade(light, BRILLIANT, StoneOptics(2.4175, 2.4175 + d, 2.4175 - d), Rules())).fire_degrees.value
        for d in (5e-4, 1e-3)
    ]
    assert spreads[1] / spreads[0] == pytest.approx(2, rel=0.02)  # measured 1.99
    full = last(grade(light, BRILLIANT, DIAMOND, Rules()))
    assert 30 < full.fire.value < full.iso.value


def test_a_prism_parts_two_wavelengths_by_snells_law(light: LightSums) -> None:
    """Light straight down onto a wedge's slope leaves by its level base: sin(out) = n sin(slope - in), in by Snell."""
    slope = math.radians(20)
    normal = (math.sin(slope), math.cos(slope), 0.0)
    sides = [(-1, 0, 0, 1), (1, 0, 0, 1), (0, 0, 1, 1), (0, 0, -1, 1)]
    wedge = shape_from_half_spaces("wedge", np.array([(*normal, 0.7), (0, -1, 0, 0), *sides], float))
    over = [DomeView(axis=(0.0, -1.0, 0.0))]  # the dome turned over, so that what leaves through the base counts
    optics, rules = StoneOptics(1.52, 1.53, 1.51), Rules(head_degrees=0, glare="none", bounces=1)
    sums = light.of(wedge, optics, rules, over, batches=4, rays=4096, fire=True)
    found = sums[0].sum(axis=0)

    def out(n: float) -> float:
        return math.degrees(math.asin(n * math.sin(slope - math.asin(math.sin(slope) / n))))

    parted = out(1.53) - out(1.51)
    assert found[KERNEL["SPREAD"]] / found[KERNEL["TOGETHER"]] == pytest.approx(parted, rel=2e-3)  # measured 2e-4
    assert parted < FIRE_DEGREES
    assert found[KERNEL["FIRE"]] < 2e-3 * found[KERNEL["RETURNED"]]  # where one meets a side; measured 8e-4


def test_the_mean_parting_is_of_light_that_takes_the_same_facets_alone(light: LightSums) -> None:
    """A roof: at the base below its flatter slope both wavelengths leave, parted by Snell's law; below the steeper one
    blue is totally reflected."""
    flat, steep = math.radians(20), math.radians(40)
    slopes = [(math.sin(angle), math.cos(angle), 0, math.cos(angle)) for angle in (flat, -steep)]
    sides = [(0, -1, 0, 0), (-1, 0, 0, 1), (1, 0, 0, 1), (0, 0, 1, 1), (0, 0, -1, 1)]
    shape = shape_from_half_spaces("roof", np.array([*slopes, *sides], float))
    over = [DomeView(axis=(0.0, -1.0, 0.0))]
    optics, rules = StoneOptics(2.4, 2.45, 2.35), Rules(head_degrees=0, glare="none", bounces=1)
    (sums,) = light.of(shape, optics, rules, over, batches=4, rays=4096, fire=True)

    def sine(n: float, slope: float) -> float:
        return n * math.sin(slope - math.asin(math.sin(slope) / n))

    assert sine(2.45, steep) > 1 > sine(2.35, steep)
    parted = math.degrees(math.asin(sine(2.45, flat)) - math.asin(sine(2.35, flat)))
    assert grades_of(sums, optics).fire_degrees.value == pytest.approx(parted, rel=2e-3)
    returned, together, fire = (sums[:, KERNEL[name]].sum() for name in ("RETURNED", "TOGETHER", "FIRE"))
    assert fire > 0.99 * returned  # all of it is fire
    assert returned > 1.2 * together


def test_light_return_has_the_shape_that_gia_published(light: LightSums) -> None:
    """Hemphill et al. 1998: a local maximum near a crown of 23 degrees, more without a crown, and a maximum between
    pavilions of 38 and 44. The value at 34 and 40.5 degrees is 0.2791 by an independent program."""

    def of(**changed: float) -> float:
        usual = {"table_percent": 56, "crown_degrees": 34, "pavilion_degrees": 40.5, "star_percent": 50}
        cut = BrilliantCut.model_validate({**usual, "lower_half_percent": 75, **changed})
        optics = StoneOptics.of_index(2.419)
        return last(weighted_light_return(light, shape_of_cut(cut), optics, rays=32)).value

    assert of() == pytest.approx(0.2791, abs=0.003)  # measured 0.2787; one standard error is 0.0004
    crown = {degrees: of(crown_degrees=degrees) for degrees in (1, 15, 23, 30, 42)}
    assert crown[15] < crown[23] > crown[30] > crown[42]
    assert crown[1] > crown[23]
    pavilion = {degrees: of(pavilion_degrees=degrees) for degrees in (38, 40.7, 44)}
    assert pavilion[38] < pavilion[40.7] > pavilion[44]


def test_a_symmetrical_stone_tilts_alike_to_both_sides_and_about_both_axes(light: LightSums) -> None:
    tilts = (-30, -12, 0, 12, 30)
    about_x, about_z = (
        [point.iso for point in tilt_curve(light, BRILLIANT, DIAMOND, Rules(), azimuth, tilts)] for azimuth in (90, 0)
    )
    for other in (about_x[::-1], about_z):
        for a, b in zip(about_x, other, strict=True):
            assert abs(a.value - b.value) < 5 * math.hypot(a.error, b.error)
    long = [next(tilt_curve(light, shape_of_cut(OvalCut()), DIAMOND, Rules(), azimuth, (30,))) for azimuth in (90, 0)]
    assert abs(long[0].iso.value - long[1].iso.value) > 1


def test_errors_are_what_repeats_show(light: LightSums) -> None:
    """The spread of 24 repeats, beside the errors that they tell of themselves."""
    shape = shape_of_cut(PrincessCut())
    repeats = [
        grades_of(
            light.of(shape, DIAMOND, Rules(), [DomeView()], batches=BATCHES, rays=512, seed=seed, fire=True)[0], DIAMOND
        )
        for seed in range(24)
    ]
    for numbers in ([each.iso for each in repeats], [each.contrast for each in repeats]):
        spread = np.std([number.value for number in numbers], ddof=1)
        told = np.mean([number.error for number in numbers])
        assert 0.6 < spread / told < 1.6  # of 24 repeats a sample's deviation is off by 15 %; measured 1.0


def test_single_precision_is_enough(light: LightSums, device: Device) -> None:
    double = LightSums(device, np.float64)
    shape = shape_of_cut(PrincessCut())
    single, exact = (
        each.of(shape, DIAMOND, Rules(), [DomeView()], batches=4, rays=4096)[0].sum(axis=0) for each in (light, double)
    )
    for name in ("ISO", "LEAK", "MIRRORED"):
        assert single[KERNEL[name]] / single[0] == pytest.approx(exact[KERNEL[name]] / exact[0], abs=2e-3)


def test_a_report_gets_better_and_more_complete_and_ends_whole(light: LightSums) -> None:
    stage = Stage.of(Scene(stones=(StoneSettings(cut="single"),)))  # of few facets
    *_, whole = found = list(reports_of(light, stage, Rules(), tilt=True, target=0.1))
    done = [report.done for report in found]
    assert done == sorted(done)
    assert done[-1] == 1
    assert 2 * whole.grades.iso.error <= 0.1
    assert whole.weighted_light_return is not None
    assert whole.tilt is not None
    assert {axis: len(points) for axis, points in whole.tilt.items()} == {"x": 37, "z": 37}


def test_what_cannot_be_graded_is_refused(light: LightSums) -> None:
    with pytest.raises(MeshError, match="heart: expected a convex stone"):
        next(grade(light, shape_of_cut(HeartCut()), DIAMOND, Rules()))
    with pytest.raises(SceneError, match=r"expected the id of a stone \(stone\), got 'ruby'"):
        next(reports_of(light, Stage.of(Scene()), Rules(), stone="ruby"))
    with pytest.raises(SceneError, match=r"expected the id of a stone \(none\)"):
        next(reports_of(light, Stage.of(Scene(stones=())), Rules()))


def test_rules_by_name_take_another_head() -> None:
    assert rules_of("gemray") == GEMRAY
    assert rules_of("gemray", 15) == Rules(15, "crown", 9, 1e-3)
    assert rules_of("culet") == Rules()


def test_a_coloured_stone_is_graded_clear_unless_its_colour_is_asked_for() -> None:
    ruby = StoneSettings(material="ruby")
    assert optics_of(ruby, 3).absorption == 0
    assert optics_of(ruby, 3, coloured=True).absorption == pytest.approx(
        2 * optics_of(ruby, 1.5, coloured=True).absorption
    )
    assert optics_of(ruby, 3).index == pytest.approx(1.768, abs=1e-3)  # Malitson & Dodge 1972, ordinary ray
