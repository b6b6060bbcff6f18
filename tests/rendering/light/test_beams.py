"""Light maps by beams, against closed forms: how much light lands, and where."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import pyopencl as cl
import pytest

from culet.geometry.shape import Shape
from culet.rendering.emitters.light_map import frame_of
from culet.rendering.light.beams import FIRST_JOBS, Beams
from culet.rendering.opencl.device import Device
from culet.rendering.stones.placed_stone import rotation_matrix
from culet.scene import Scene
from optics.closed_forms import fresnel
from optics.closed_forms import slab as plate
from rendering.light.throwing import DARK, UPRIGHT, Array, lamp, sun, sun_from, thrown
from shared.stages import staged
from shared.stones import prism, skew_block, slab
from shared.trimesh_stones import exact_box

INDEX = 2.41749


@pytest.fixture(scope="module")
def beams(device: Device) -> Beams:
    return Beams(device)


@pytest.fixture(scope="module")
def exact(device: Device) -> Beams:
    return Beams(device, np.float64)


def glass(index: float, **stone: object) -> dict[str, object]:
    return {**UPRIGHT, "material": {"ior": [index] * 3}, **stone}


@pytest.mark.parametrize("degrees", [0, 30, 60])
def test_a_plate_lets_through_one_minus_r_over_one_plus_r(beams: Beams, exact: Beams, degrees: float) -> None:
    """In the middle of its image, of all echoes; light that goes in by the rim does not get there."""
    angle = math.radians(degrees)
    through, _ = plate(fresnel(math.sin(angle), 1, INDEX))
    for used, tolerance in ((beams, 1e-5), (exact, 1e-6)):  # measured
        made = thrown(used, [sun_from(degrees)], slab(0.01), stones=[glass(INDEX)], cutoff=1e-8)
        seen = made.at(math.tan(angle) + 0.02, 0.03) + math.cos(angle)
        assert seen == pytest.approx([math.cos(angle) * through] * 3, abs=tolerance)


def test_a_coloured_plate_takes_its_part_of_every_passage(beams: Beams) -> None:
    stone = glass(1.7, absorption=[0.5, 2, 8])
    angle = math.radians(40)
    made = thrown(beams, [sun_from(40)], slab(0.05), stones=[stone], cutoff=1e-8)
    way = 0.1 / math.sqrt(1 - (math.sin(angle) / 1.7) ** 2)
    expected = [math.cos(angle) * plate(fresnel(math.sin(angle), 1, 1.7), math.exp(-a * way))[0] for a in (0.5, 2, 8)]
    assert made.at(math.tan(angle), 0.03) + math.cos(angle) == pytest.approx(expected, abs=2e-5)
    assert made.tally.absorbed > 0.1
    assert abs(made.lost()) < 1e-6


def test_of_a_coloured_light_what_adds_little_is_followed_less(beams: Beams, brilliant: Shape) -> None:
    """Of as much light by as many beams less is cut. Measured: 0.154 of white light by 2826 beams, 0.125 of the red one
    by 2746, 0.091 of what is red alone by 2359."""
    white, red = (
        thrown(beams, [sun(colour=colour)], brilliant, cutoff=1e-3) for colour in ((1, 1, 1), (2.6, 0.2, 0.2))
    )
    assert red.tally.incident == pytest.approx(white.tally.incident, rel=1e-5)
    assert red.tally.cut < 0.9 * white.tally.cut
    assert red.tally.beams < 1.05 * white.tally.beams
    assert abs(red.lost()) < 1e-6
    pure = thrown(beams, [sun(colour=(3, 0, 0))], brilliant, cutoff=1e-3)
    assert pure.map[..., 0].max() > 0
    assert not pure.map[..., 1:].any(), "nor is what there is none of"
    assert pure.tally.cut < 0.9 * red.tally.cut


def test_two_plates_pass_on_what_they_reflect_to_each_other(beams: Beams) -> None:
    """(1 - R) / (1 + 3 R): none of the light passes the lower plate unhindered, and none is lost between them."""
    r = fresnel(0, 1, INDEX)
    stones = [glass(INDEX), glass(INDEX, position=[0, -0.5, 0])]
    made = thrown(beams, [sun_from(0)], slab(0.05), stones=stones, cutoff=1e-7)
    assert made.at(0.05, 0.03) + 1 == pytest.approx([(1 - r) / (1 + 3 * r)] * 3, abs=1e-4)
    assert abs(made.lost()) < 1e-6


def test_a_box_that_faces_the_light_shows_nothing_but_its_face(beams: Beams) -> None:
    r = fresnel(0, 1, 2.4)
    made = thrown(beams, [sun_from(0)], exact_box(), stones=[glass(2.4)], cutoff=1e-9)
    half = np.abs(exact_box().vertices[:, 0]).max()
    assert made.at(0.01, 0.01) + 1 == pytest.approx([(1 - r) / (1 + r)] * 3, abs=1e-6)
    assert abs(made.at(half + 0.05, 0.01)).max() < 1e-5
    assert made.tally.away / made.tally.incident == pytest.approx(2 * r / (1 + r), abs=1e-6)


def caustic(beams: Beams, ray: Array, shape: Shape, stone: dict[str, object], cutoff: float) -> tuple[Array, Array]:
    """(512,) the light that goes through a stone, on the middle row of the map, and u of the texels' edges."""
    light = sun(-ray)
    made = thrown(beams, [light], shape, stones=[stone], cutoff=cutoff)
    shadow = thrown(
        beams, [type(light)(light.colour, towards=light.towards, follows=False)], shape, stones=[stone], cutoff=cutoff
    )
    columns, _ = made.frame.texels(0, 0)
    step = columns[1] - columns[0]
    row = (made.map - shadow.map)[0, 0, 256, :, 0]
    return row, np.append(columns - step / 2, columns[-1] + step / 2)


def edge_of(row: Array, edges: Array, near: float, inside: float) -> float:
    """Where light of that level begins or ends, near a place."""
    at = int(np.searchsorted(edges, near))
    window, step = row[at - 20 : at + 20], edges[1] - edges[0]
    if window[:5].mean() > window[-5:].mean():
        return float(edges[at - 20] + window.sum() / inside * step)
    return float(edges[at + 20] - window.sum() / inside * step)


def test_a_plate_moves_light_by_its_height_times_the_inner_tangent(exact: Beams) -> None:
    """The first passage alone: echoes, and what goes in by the rim, are cut."""
    angle, index, half = math.radians(40), 1.5, 0.1
    ray = np.array([math.sin(angle), -math.cos(angle), 0])
    row, edges = caustic(exact, ray, slab(half), glass(index), cutoff=0.3)
    inner = math.asin(math.sin(angle) / index)
    width = math.sqrt((1 - half**2) / 2)
    level = (1 - fresnel(math.sin(angle), 1, index)) ** 2 * math.cos(angle)
    below = (1 - half) * math.tan(angle)
    begins, ends = -width + 2 * half * math.tan(inner) + below, width + below
    assert edge_of(row, edges, begins, level) == pytest.approx(begins, abs=2e-5)
    assert edge_of(row, edges, ends, level) == pytest.approx(ends, abs=2e-5)
    middle = row[np.searchsorted(edges, begins) + 10 : np.searchsorted(edges, ends) - 10]
    assert middle == pytest.approx(np.full(len(middle), level), abs=2e-6)


def refracted(ray: Array, normal: Array, eta: float) -> Array:
    """Snell's law in vectors; the normal is on the side that the light comes from."""
    cosine = -float(ray @ normal)
    return ray / eta + (cosine / eta - math.sqrt(1 - (1 - cosine**2) / eta**2)) * normal


@pytest.mark.parametrize("index", [1.5, 1.6, 1.7, 1.8])
def test_a_prism_sends_each_colour_to_its_place_at_its_strength(exact: Beams, index: float) -> None:
    shape, turn, incidence = prism(20), math.radians(-70), math.radians(25)
    orientation = (math.cos(turn / 2), 0.0, 0.0, math.sin(turn / 2))
    rotation = rotation_matrix(orientation)
    left, right = (rotation @ shape.planes[k, :3] for k in (0, 1))
    to_apex = rotation @ np.array([math.sin(math.radians(10)), math.cos(math.radians(10)), 0])
    ray = -math.cos(incidence) * left + math.sin(incidence) * to_apex
    inside = refracted(ray, left, index)
    out = refracted(inside, -right, 1 / index)
    top = shape.vertices[shape.vertices[:, 1].argmax()] * [1, 1, 0]
    apex = rotation @ top
    lands = float(apex[0] - (apex[1] + 1) / out[1] * out[0])
    cos_r, cos_i2, cos_t2 = -float(inside @ left), float(inside @ right), float(out @ right)
    passes = (1 - fresnel(math.sin(incidence), 1, index)) * (1 - fresnel(math.sqrt(1 - cos_t2**2), 1, index))
    level = passes * math.cos(incidence) / cos_r * cos_i2 / cos_t2 * -out[1]
    row, edges = caustic(exact, ray, shape, {**glass(index), "orientation": list(orientation)}, cutoff=0.15)
    assert edge_of(row, edges, lands, level) == pytest.approx(lands, abs=2e-5)
    at = int(np.searchsorted(edges, lands))
    assert max(row[at - 12], row[at + 12]) == pytest.approx(level, abs=2e-6)


def test_a_stone_of_index_1_changes_nothing(beams: Beams) -> None:
    """What is let through is exactly what is taken away, on floor and walls."""
    made = thrown(beams, [sun((-1, 0.7, 1.4))], stones=[glass(1)], cutoff=1e-5, walls={"kind": "matte"})
    assert abs(made.map).max() < 2e-3  # rounding of sums along 512 texels, where sides are thinner than texels
    assert np.sqrt((made.map**2).mean()) < 2e-5
    assert made.tally.landed + made.tally.outside == pytest.approx(made.tally.incident, rel=1e-6)


def test_light_of_a_point_far_away_is_parallel(beams: Beams) -> None:
    near = thrown(beams, [lamp((-4000, 6000, 4000))], cutoff=1e-4)
    far = thrown(beams, [sun()], cutoff=1e-4)
    assert near.tally.incident == pytest.approx(far.tally.incident, rel=1e-3)
    assert np.sqrt(((near.map - far.map) ** 2).mean()) < 0.06 * np.sqrt((far.map**2).mean())


def test_light_of_a_point_takes_and_gives_the_same_where_the_index_is_1(beams: Beams) -> None:
    """But for what falls between facets, where the parts of a beam are not thin."""
    made = thrown(beams, [lamp()], stones=[glass(1, position=[0, 0.5, 0])], cutoff=1e-5)
    assert np.sqrt((made.map[0, 0] ** 2).mean()) < 0.01  # measured 0.0045; the shadow's is 0.2
    assert made.tally.unresolved < 0.015 * made.tally.incident  # measured 0.0095


def test_the_coarse_map_is_the_mean_of_the_fine_one(beams: Beams) -> None:
    for ray in (sun(), lamp()):
        made = thrown(beams, [ray], cutoff=1e-3)
        fine = made.map[0, 0].reshape(128, 4, 128, 4, 3).mean((1, 3))
        # But for the first column, in which sides that come from beyond the map are not quite where they belong.
        assert made.map[0, 1, 192:320, 193:320] == pytest.approx(fine[:, 1:], abs=2e-3)


def test_single_precision_agrees_with_double(beams: Beams, exact: Beams) -> None:
    single, double = (thrown(used, [sun()], cutoff=1e-4) for used in (beams, exact))
    assert single.tally.cut == pytest.approx(double.tally.cut, rel=1e-5)
    assert np.sqrt(((single.map - double.map) ** 2).mean()) < 5e-5  # measured 7e-6; the map's own is 0.15


def test_bands_of_one_index_make_the_same_map_as_three_channels(beams: Beams) -> None:
    three = thrown(beams, [sun()], skew_block(), stones=[glass(1.6)], cutoff=1e-4)
    bands = thrown(beams, [sun()], skew_block(), stones=[glass(1.6)], cutoff=1e-4, optics={"bands": 8}, number=3)
    assert abs(bands.map - three.map).max() < 2e-4  # pytest.approx takes 4 us a number, of millions


def test_polarised_light_passes_a_plate_as_two_plates_worth(beams: Beams) -> None:
    """Each polarisation has its own echoes: the mean of both plates, not the plate of the mean."""
    angle, index = math.radians(60), 1.9
    t = math.asin(math.sin(angle) / index)
    r_s, r_p = math.sin(angle - t) / math.sin(angle + t), math.tan(angle - t) / math.tan(angle + t)
    expected = (plate(r_s**2)[0] + plate(r_p**2)[0]) / 2
    mean = plate((r_s**2 + r_p**2) / 2)[0]
    for polarised, through in ((True, expected), (False, mean)):
        made = thrown(
            beams, [sun_from(60)], slab(0.01), stones=[glass(index)], cutoff=1e-7, optics={"polarised": polarised}
        )
        seen = made.at(math.tan(angle) + 0.02, 0.03) + 0.5
        assert seen == pytest.approx([0.5 * through] * 3, abs=2e-5)
    assert abs(expected - mean) > 0.02


def test_pieces_of_a_pass_make_the_map_of_a_whole_one(beams: Beams) -> None:
    whole = thrown(beams, [sun()], cutoff=1e-3)
    stage = staged(Scene.read({**DARK, "stones": [{}]}))
    frame = frame_of(stage)
    target = cl.Buffer(beams.device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
    made = np.empty(frame.shape, np.float32)
    parts = list(beams.pieces(stage, [sun()], frame, lambda: target, cutoff=1e-3, seconds=1e-4))
    assert len(parts) > 3
    assert parts == sorted(parts)
    cl.enqueue_copy(beams.device.queue, made, target)
    assert abs(made - whole.map).max() < 1e-4
    beams.make(stage, [sun((1, 2, 0))], frame, target, cutoff=1e-3, keep=0.75, gain=0.25)
    cl.enqueue_copy(beams.device.queue, made, target)
    other = thrown(beams, [sun((1, 2, 0))], cutoff=1e-3)
    assert abs(made - (0.75 * whole.map + 0.25 * other.map)).max() < 1e-4


def test_a_pass_of_more_stones_begins_with_few_jobs_for_nobody_knows_how_long_they_take(device: Device) -> None:
    """A job that was quick among two stones may take long among eight."""
    launched: list[int] = []

    class Noting(Beams):
        def _launch(self, kernel: object, buffers: Sequence[object], begin: int, end: int, *more: int) -> None:
            launched.append(end - begin)
            super()._launch(kernel, buffers, begin, end, *more)

    noting = Noting(device)

    def begun_with(count: int) -> int:
        """The jobs of the first launch that follows light."""
        placed = [{**UPRIGHT, "id": f"s{k}", "scale": 0.2, "position": [0.5 * k, 0, 0]} for k in range(count)]
        stage = staged(Scene.read({**DARK, "stones": placed}))
        frame = frame_of(stage)
        target = cl.Buffer(device.context, cl.mem_flags.READ_WRITE, frame.nbytes)
        launched.clear()
        for _ in noting.pieces(stage, [sun()] * 2, frame, lambda: target, cutoff=0.5, seconds=60):
            pass
        return launched[1]  # after the one of shadows

    assert begun_with(2) == FIRST_JOBS
    assert begun_with(2) > FIRST_JOBS
    assert begun_with(8) == FIRST_JOBS
