"""Programs hold what their scene needs and nothing else, and show the same."""

from __future__ import annotations

import struct
from dataclasses import fields, replace
from typing import Any

import numpy as np
import pyopencl as cl
import pytest

from conftest import RendererOf
from culet.rendering.features import FRESNEL, RUNTIME, SKY, SURFACE, Features, Geometry, features_of
from culet.rendering.renderer import DevicePicture, Renderer
from culet.scene import PRESETS
from culet.scene.legacy import LEGACY_DEFAULT, LEGACY_LAMPS, legacy
from pictures import compared
from rendering.views import BARE, radiance, take
from shared.stages import staged

LANES = 4
"""Narrow packets compile faster, and the claims are about the source."""
LAMPS = [lamp.model_dump() for lamp in LEGACY_LAMPS]
DECIDED: dict[str, tuple[str, int, dict[str, Any]]] = {
    "no floor": ("floor", SURFACE["none"], {"floor": {"kind": "none"}}),
    "matte floor": ("floor", SURFACE["matte"], {"floor": {"kind": "matte"}}),
    "mirror floor": ("floor", SURFACE["mirror"], {}),
    "no walls": ("walls", SURFACE["none"], {}),
    "matte walls": ("walls", SURFACE["matte"], {"walls": {"kind": "matte"}}),
    "mirror walls": ("walls", SURFACE["mirror"], {"walls": {"kind": "mirror"}}),
    "no lights": ("lights", 0, {"emitters": LAMPS, "floor": {"kind": "matte"}}),
    "constant sky": ("sky", SKY["constant"], {"environment": {"kind": "constant"}}),
    "gradient sky": ("sky", SKY["gradient"], {"environment": {"kind": "gradient"}}),
    "half sky": ("sky", SKY["half"], {"environment": {"kind": "half"}}),
    "no lamps": ("lamps", 0, {"emitters": []}),
    "no dispersion": ("dispersion", 0, {"stones": [{"material": {"ior": [2.4, 2.4, 2.4]}}]}),
    "no absorption": ("absorption", 0, {}),
    "exact Fresnel": ("fresnel", FRESNEL["exact"], {}),
    "Schlick": ("fresnel", FRESNEL["schlick"], {"optics": {"fresnel": "schlick"}}),
    "camera outside": ("camera_inside", 0, {}),
}
"""What is decided, how, and a scene in which it is so."""
OFF = ("no floor", "no walls", "no lights", "no absorption", "exact Fresnel", "no lamps")


def machine_code(picture: DevicePicture) -> int:
    """Bytes of machine code in the program: the text sections of the objects that PoCL has made of it.

    The container around them also holds the bitcode and names that vary in length; the text is what the processor runs.
    """
    (binary,) = picture.program.get_info(cl.program_info.BINARIES)
    total, start = 0, binary.find(b"\x7fELF")
    while start >= 0:
        elf = binary[start:]
        (table,) = struct.unpack_from("<Q", elf, 0x28)
        size, count, names = struct.unpack_from("<HHH", elf, 0x3A)
        sections = [struct.unpack_from("<IIQQQQ", elf, table + size * i) for i in range(count)]
        strings = sections[names][4]
        total += sum(length for name, *_, length in sections if elf[strings + name :].startswith(b".text\0"))
        start = binary.find(b"\x7fELF", start + 4)
    assert total > 0
    return total


@pytest.fixture(scope="module")
def narrow(renderer_of: RendererOf) -> Renderer:
    return renderer_of(LANES, np.float32)


@pytest.fixture(scope="module")
def size_of_general(narrow: Renderer) -> int:
    return machine_code(take(narrow, LEGACY_DEFAULT, features=Features()))


@pytest.mark.validation
@pytest.mark.parametrize(("feature", "kind", "scene"), DECIDED.values(), ids=DECIDED.keys())
def test_a_decided_feature_shows_what_the_general_program_shows(
    narrow: Renderer, size_of_general: int, feature: str, kind: int, scene: dict[str, Any]
) -> None:
    """The general program with the feature idle, and the same program without the other kinds' code."""
    general = take(narrow, legacy(scene), features=Features())
    decided = take(narrow, legacy(scene), features=replace(Features(), **{feature: kind}))
    assert machine_code(general) == size_of_general
    with compared(radiance(decided), radiance(general)):
        if scene == {} and feature == "fresnel":
            # Multiply-adds are contracted otherwise there. At the critical angle the reflectance is a root, so that a
            # rounding is seen: measured in 1.1 % of the values, 1.3e-3 at most, 1.5e-7 in the mean.
            difference = np.abs(radiance(decided) - radiance(general))
            assert (difference > 4e-7 * radiance(general) + 3e-8).mean() < 0.02
            assert difference.max() < 2e-3
            assert difference.mean() < 5e-7
            return
        # measured 1.9e-7 of the radiance without dispersion, where the channels of one chain are summed in another
        # order; otherwise every bit is the same
        assert radiance(decided) == pytest.approx(radiance(general), rel=4e-7, abs=3e-8)


@pytest.mark.validation
@pytest.mark.parametrize("name", OFF)
def test_a_feature_that_is_off_is_not_in_the_program(narrow: Renderer, size_of_general: int, name: str) -> None:
    """Measured: from 0.7 % (absorption) to 22 % (the sky) of 49 kB. What the camera's place decides is a branch or two,
    less than what the compiler then orders otherwise: 0.2 % more."""
    feature, kind, scene = DECIDED[name]
    decided = take(narrow, legacy(scene), features=replace(Features(), **{feature: kind}))
    assert machine_code(decided) < size_of_general


def test_without_dispersion_a_third_of_the_segments_is_followed(narrow: Renderer) -> None:
    """This feature saves work, not code: one chain carries three channels, and its arithmetic is there for each."""
    feature, kind, scene = DECIDED["no dispersion"]
    general = take(narrow, legacy(scene), features=Features())
    decided = take(narrow, legacy(scene), features=replace(Features(), **{feature: kind}))
    assert general.segments() == 3 * decided.segments() > 0


def test_the_general_program_that_serves_a_stone_of_one_index_has_a_chain_for_each_channel(renderer: Renderer) -> None:
    """Its own program has one for all: with what that reads, the general one showed the stone in red alone."""
    scene = legacy({"stones": [{"material": {"ior": [2.4, 2.4, 2.4]}}]})
    serves, asked_for = take(renderer, scene), take(renderer, scene, features=Features())
    assert (radiance(serves) == radiance(asked_for)).all()
    assert serves.segments() == asked_for.segments()


def test_without_a_stone_the_program_is_less_than_half(narrow: Renderer, size_of_general: int) -> None:
    scene = legacy({"stones": []})
    assert machine_code(take(narrow, scene, features=Features(Geometry.EMPTY))) < size_of_general / 2  # measured 0.39


OWN: dict[str, dict[str, Any]] = {
    "default": {},
    "bare": {**BARE, "environment": {"kind": "constant"}, "stones": [{"material": {"ior": [2, 2, 2]}}]},
    "report's room": {"floor": {"kind": "matte"}, "walls": {"kind": "matte"}, "environment": {"kind": "dark"}},
    "tinted mirror": {"stones": [{"absorption": [2, 1, 0.1]}], "optics": {"fresnel": "schlick"}, "emitters": LAMPS},
}


@pytest.mark.parametrize("scene", OWN.values(), ids=OWN.keys())
def test_a_scenes_own_program_is_smaller_and_shows_the_same(
    narrow: Renderer, size_of_general: int, scene: dict[str, Any]
) -> None:
    """Every feature decided, against every feature left to run time."""
    of = legacy(scene)
    own, general = (take(narrow, of, features=which) for which in (features_of(staged(of)), Features()))
    # measured 2.2e-7 of the radiance: where less is left to run time, other sums are rounded together
    with compared(radiance(own), radiance(general)):
        assert radiance(own) == pytest.approx(radiance(general), rel=4e-7, abs=3e-8)
    assert machine_code(own) < size_of_general


def test_each_feature_of_a_scene_is_decided_unless_its_quantity_is_needed() -> None:
    """Lights, boxes and absorption that a scene has stay arguments: RUNTIME. All else is fixed."""
    left = {
        name: {
            field.name
            for field in fields(Features)
            if getattr(features_of(staged(preset.scene)), field.name) == RUNTIME
        }
        for name, preset in PRESETS.items()
    }
    assert left["default"] == {"boxes", "lamps"}
    assert left["mirror"] == {"lights", "lamps"}
    assert left["tinted-blue"] == {"lights", "absorption"}
    assert features_of(staged(legacy(OWN["bare"]))) == Features(
        Geometry.HULL, floor=0, walls=0, lights=0, light_map=0, sky=SKY["constant"], lamps=0, boxes=0, head=0,
        backdrop=0, glare=1, dispersion=0, absorption=0, fresnel=0, end=0, camera_inside=0,
    )  # fmt: skip


def test_options_name_what_is_decided_and_nothing_else() -> None:
    structure = ["-DSPECTRAL=0", "-DPOLARISED=0", "-DFEW_MIRRORS=0", "-DALIKE=0", "-DSTONES=1", "-DESTIMATOR=0"]
    assert Features().options == ["-DGEOMETRY=1", *structure]
    assert Features(floor=2, lights=0).options == ["-DGEOMETRY=1", "-DFLOOR=2", "-DLIGHTS=0", *structure]
    assert Features(floor=2, lights=0).without("floor").options == ["-DGEOMETRY=1", "-DLIGHTS=0", *structure]
    assert Features(Geometry.MESH, floor=2, spectral=1).general == Features(Geometry.MESH, spectral=1)
