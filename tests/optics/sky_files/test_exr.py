"""What OpenEXR's header says of pixels: honoured, refused by name, or told."""

from __future__ import annotations

import io
import struct
from pathlib import Path
from typing import Any

import numpy as np
import OpenEXR
import pytest
from numpy.typing import NDArray

from culet.errors import InputError, TooLargeError
from culet.optics.sky_files.colour import NAMES, REC_709, to_xyz
from culet.optics.sky_files.reading import read_sky
from optics.sky_files.writers import attribute, exr, floats, grey, text

Array = NDArray[Any]

RED_BLUE = np.zeros((4, 8, 3), np.float32)
RED_BLUE[:, :4] = 0.5, 0.1, 0.1
RED_BLUE[:, 4:] = 0.1, 0.2, 0.7
LUMINANCE = to_xyz(REC_709)[1]


VIEWS = b"".join(struct.pack("<I", len(view)) + view for view in (b"left", b"right"))


def channels(colours: Array, names: str = "RGB") -> dict[str, NDArray[np.generic]]:
    return {name: np.ascontiguousarray(colours[..., i], np.float32) for i, name in enumerate(names)}


def chromaticities(name: str) -> bytes:
    return attribute("chromaticities", "chromaticities", floats(*np.ravel(NAMES[name])))


def pixels(data: bytes) -> Array:
    return read_sky(data, "exr").pixels


@pytest.mark.parametrize("sampling", [1, 2])
def test_luminance_and_chroma_are_colours(sampling: int) -> None:
    """OpenEXR's Y, RY and BY (ImfRgbaYca.h): chroma is reconstructed at the edge, exact away from it."""
    colours = np.repeat(RED_BLUE, 8, axis=1)
    y = colours @ LUMINANCE
    chroma = {"RY": (colours[..., 0] - y) / y, "BY": (colours[..., 2] - y) / y}
    parts = {name: part[::sampling, ::sampling] for name, part in chroma.items()} | {"Y": y}
    half = {name: part.astype(np.float16) for name, part in parts.items()}
    seen = pixels(exr(half, sampling=dict.fromkeys(chroma, sampling)))
    blurred = 0 if sampling == 1 else 14  # of a filter 27 wide
    for columns in (slice(0, 32 - blurred), slice(32 + blurred, 64)):
        assert seen[:, columns] == pytest.approx(colours[:, columns], abs=2e-3)  # of half; measured 3e-4


def test_luminance_alone_is_grey() -> None:
    y = np.linspace(0, 1, 32, dtype=np.float32).reshape(4, 8)
    assert pixels(exr({"Y": y})) == pytest.approx(np.repeat(y[..., None], 3, axis=-1))


@pytest.mark.parametrize("name", sorted(NAMES))
def test_colours_of_other_primaries_look_the_same(name: str) -> None:
    """White stays white (of XYZ, whose white is the eye's and no screen's, D65 is), and so do colours within both."""
    source = np.linalg.inv(to_xyz(NAMES[name])) @ to_xyz(REC_709)
    same_white = np.allclose(NAMES[name].white, REC_709.white, atol=1e-3) or name == "CIE XYZ"
    white = source @ [1, 1, 1] if name == "CIE XYZ" else np.ones(3)
    sky = read_sky(exr(channels(np.tile(white, (4, 8, 1))), chromaticities(name)), "exr")
    assert sky.pixels == pytest.approx(np.ones((4, 8, 3)), abs=1e-3)
    assert any(name in finding for finding in sky.findings)
    if same_white:
        seen = pixels(exr(channels(RED_BLUE @ source.T), chromaticities(name)))
        assert seen == pytest.approx(RED_BLUE, abs=1e-5)


def test_a_colour_space_by_name_is_its_primaries() -> None:
    by_name = pixels(exr(channels(RED_BLUE), text("colorInteropID", "lin_rec2020_scene")))
    assert by_name == pytest.approx(pixels(exr(channels(RED_BLUE), chromaticities("Rec. 2020"))), abs=1e-6)
    with pytest.raises(InputError, match=r"colorInteropID of .*; got 'srgb_rec709_scene'"):
        pixels(exr(grey(), text("colorInteropID", "srgb_rec709_scene")))


def test_the_adopted_neutral_becomes_white() -> None:
    neutral = NAMES["ACES AP0"].white
    as_seen = np.linalg.inv(to_xyz(REC_709)) @ [neutral[0] / neutral[1], 1, (1 - sum(neutral)) / neutral[1]]
    data = exr(channels(np.tile(as_seen, (4, 8, 1))), attribute("adoptedNeutral", "v2f", floats(*neutral)))
    assert pixels(data) == pytest.approx(np.ones((4, 8, 3)), abs=1e-4)


def test_the_data_window_lies_in_the_display_window() -> None:
    sky = read_sky(exr(grey(), display=(-2, -1, 9, 4)), "exr")
    assert sky.pixels.shape == (6, 12, 3)
    expected = np.zeros((6, 12, 3))
    expected[1:5, 2:10] = 0.5
    assert (sky.pixels == expected).all()
    (finding,) = sky.findings
    assert "32 of the sky's 72 pixels" in finding
    cropped = read_sky(exr(channels(RED_BLUE), first=(-4, -1), display=(0, 0, 3, 1)), "exr")
    assert (cropped.pixels == RED_BLUE[1:3, 4:]).all()
    assert cropped.findings == ("Pixels beyond the display window were left out.",)


def test_rows_may_come_from_the_bottom_up() -> None:
    ramp = np.arange(32, dtype=np.float32).reshape(4, 8)
    assert (pixels(exr({"Y": ramp}, decreasing=True))[..., 0] == ramp).all()


@pytest.mark.parametrize("tiled", [False, True])
@pytest.mark.parametrize("compression", ["NO", "RLE", "ZIPS", "ZIP", "PIZ", "PXR24", "B44", "B44A", "DWAA", "DWAB"])
def test_every_compression_is_read(compression: str, tiled: bool, tmp_path: Path) -> None:
    colours = np.repeat(np.linspace(0, 1, 40 * 80, dtype=np.float16).reshape(40, 80, 1), 3, axis=-1)
    header: dict[str, Any] = {"compression": getattr(OpenEXR, f"{compression}_COMPRESSION")}
    header["type"] = OpenEXR.tiledimage if tiled else OpenEXR.scanlineimage
    if tiled:
        header["tiles"] = OpenEXR.TileDescription()
    OpenEXR.File(header, {"RGB": colours}).write(str(tmp_path / "a.exr"))
    assert pixels((tmp_path / "a.exr").read_bytes()) == pytest.approx(colours.astype(float), abs=0.02)  # of B44


def test_the_first_part_with_colours_is_taken_and_said(tmp_path: Path) -> None:
    depth = OpenEXR.Part({"name": "depth"}, {"Z": np.ones((4, 8), np.float32)})
    beauty = OpenEXR.Part({"name": "beauty"}, {"RGB": RED_BLUE})
    OpenEXR.File([depth, beauty]).write(str(tmp_path / "a.exr"))
    sky = read_sky((tmp_path / "a.exr").read_bytes(), "exr")
    assert (sky.pixels == RED_BLUE).all()
    assert sky.findings == ("The file has 2 parts; beauty was taken.",)


def test_a_layer_is_taken_if_it_is_the_only_one() -> None:
    layer = {f"sky.{name}": part for name, part in channels(RED_BLUE).items()}
    assert (pixels(exr(layer)) == RED_BLUE).all()
    with pytest.raises(InputError, match=r"expected one layer .*; got a, b"):
        pixels(exr({f"{name}.{c}": part for name in "ab" for c, part in channels(RED_BLUE).items()}))


def test_what_alpha_hides_is_told() -> None:
    alpha = np.ones((4, 8), np.float32)
    alpha[0, :3] = 0.5
    sky = read_sky(exr({**grey(), "A": alpha}), "exr")
    assert (sky.pixels == 0.5).all(), "colours are multiplied by alpha already in this format"
    assert sky.findings == ("3 pixels are transparent; black is behind them.",)


@pytest.mark.parametrize(
    ("extra", "told"),
    [
        (attribute("whiteLuminance", "float", floats(203)), "white as 203 cd/m\u00b2"),
        (text("lookModTransform", "warm"), "lookModTransform 'warm' was not applied"),
        (text("renderingTransform", "film"), "renderingTransform 'film' was not applied"),
        (
            attribute("multiView", "stringvector", VIEWS),
            "views left, right; left was taken",
        ),
    ],
)
def test_what_the_header_says_without_effect_is_told(extra: bytes, told: str) -> None:
    (finding,) = read_sky(exr(grey(), extra), "exr").findings
    assert told in finding
    (aspect,) = read_sky(exr(grey(), pixel_aspect=2), "exr").findings
    assert "aspect ratio of 2" in aspect


@pytest.mark.parametrize("name", ["owner", "comments", "capDate", "reelName"])
def test_what_concerns_no_sky_is_not_told(name: str) -> None:
    assert read_sky(exr(grey(), text(name, "x")), "exr").findings == ()


@pytest.mark.parametrize(
    ("data", "cause"),
    [
        (exr({n: np.ones((4, 8), np.uint32) for n in "RGB"}), r"R, G, B of whole numbers \(uint\)"),
        (exr({"Z": np.ones((4, 8), np.float32)}), "channels R, G and B, or Y; got Z"),
        (exr({"R": np.ones((4, 8), np.float32)}), "channels R, G and B, or Y; got R"),
        (exr({n: np.ones((4, 8), np.float32) for n in "XYZ"}), "got X, Y, Z"),
        (exr(grey(), attribute("envmap", "envmap", b"\1")), "latitude and longitude, got one of a cube's faces"),
        (exr({**grey(), "R": np.ones((2, 4), np.float32)}, sampling={"R": 2}), "channel R has fewer pixels"),
    ],
)
def test_a_refusal_names_what_the_file_has(data: bytes, cause: str) -> None:
    with pytest.raises(InputError, match=cause) as refusal:
        pixels(data)
    assert refusal.value.field == "file"


def test_deep_data_is_refused_by_name(tmp_path: Path) -> None:
    samples = np.empty((2, 4), object)
    for place in np.ndindex(2, 4):
        samples[place] = np.ones(2, np.float32)
    header = {"compression": OpenEXR.ZIPS_COMPRESSION, "type": OpenEXR.deepscanline}
    OpenEXR.File(header, dict.fromkeys("RGB", samples)).write(str(tmp_path / "deep.exr"))
    with pytest.raises(InputError, match="deep data: several values at several depths"):
        pixels((tmp_path / "deep.exr").read_bytes())


def test_a_window_beyond_all_reason_is_too_large() -> None:
    with pytest.raises(TooLargeError, match="at most 33554432 pixels, got 8200 x 4100"):
        pixels(exr(grey(), display=(0, 0, 8199, 4099)))
    with pytest.raises(InputError, match="a window of 2000000 x 1000000 pixels"):
        pixels(exr(grey(), display=(0, 0, 1_999_999, 999_999)))


def test_small_values_below_zero_are_set_to_zero_and_large_ones_refused() -> None:
    noisy = {name: part.copy() for name, part in grey().items()}
    noisy["R"][0, :3] = -0.004
    sky = read_sky(exr(noisy), "exr")
    assert (sky.pixels[0, :3, 0] == 0).all()
    assert sky.findings == ("The picture had 3 values below 0 (the lowest -0.004, the brightest 0.5), set to 0.",)
    noisy["R"][0, 0] = -0.4
    with pytest.raises(InputError, match=r"3 of 96 values are below 0, down to -0\.4 where the brightest is 0\.5"):
        pixels(exr(noisy))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_what_is_not_finite_is_counted_and_placed(value: float) -> None:
    parts = {name: part.copy() for name, part in grey().items()}
    parts["G"][2, 5] = value
    parts["B"][3, 0] = value
    with pytest.raises(InputError, match="2 of 96 values are NaN or infinite, the first at column 5, row 2"):
        pixels(exr(parts))


def test_a_lossy_file_with_black_in_it_is_read(tmp_path: Path) -> None:
    """DWA turns zeros into values like -3.6e-7."""
    colours = np.zeros((64, 128, 3), np.float16)
    colours[:20, :, 0] = np.linspace(0, 1, 128)
    OpenEXR.File({"compression": OpenEXR.DWAA_COMPRESSION}, {"RGB": colours}).write(str(tmp_path / "a.exr"))
    data = (tmp_path / "a.exr").read_bytes()
    raw = OpenEXR.File(io.BytesIO(data)).channels()["RGB"].pixels
    sky = read_sky(data, "exr")
    assert sky.pixels.min() == 0
    below = int((raw < 0).sum())
    assert bool(sky.findings) == (below > 0)
    assert all(f"{below} values below 0" in finding for finding in sky.findings)
