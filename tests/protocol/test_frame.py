"""The binary frame, against golden bytes that the browser's tests read too."""

from __future__ import annotations

import io
import json
import math
import struct
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from PIL import Image

from culet_protocol.fixtures import FIXTURES, MOVING, STILL
from culet_protocol.frame import FIELDS, HEADER_SIZE, LAYOUT, MAGIC, Flags, Frame, FrameError, refusal

LISTING: dict[str, dict[str, Any]] = json.loads((FIXTURES / "frames.json").read_text())
VALID = [name for name, case in LISTING.items() if "fields" in case]
REFUSED = [name for name, case in LISTING.items() if "expected" in case]


def golden(name: str) -> bytes:
    return Path(FIXTURES / LISTING[name]["file"]).read_bytes()


@pytest.mark.parametrize("name", VALID)
def test_golden_bytes_hold_the_listed_fields(name: str) -> None:
    frame = Frame.unpack(golden(name))
    wanted = LISTING[name]["fields"]
    assert frame.watch.hex() == wanted.pop("watch")
    assert frame.step == int(wanted.pop("step"))
    assert len(frame.payload) == wanted.pop("payload")
    wanted = {name: math.nan if value is None else value for name, value in wanted.items()}
    assert {key: getattr(frame, key) for key in wanted} == pytest.approx(wanted, rel=0, abs=0, nan_ok=True)


@pytest.mark.parametrize("name", VALID)
def test_a_frame_packs_to_the_bytes_it_came_from(name: str) -> None:
    assert Frame.unpack(golden(name)).pack() == golden(name)


@pytest.mark.parametrize("name", REFUSED)
def test_bytes_that_are_no_frame_are_refused_with_what_was_expected_and_got(name: str) -> None:
    with pytest.raises(FrameError) as refusal:
        Frame.unpack(golden(name))
    assert LISTING[name]["expected"] in str(refusal.value)
    assert LISTING[name]["got"] in str(refusal.value)


@pytest.mark.parametrize(("frame", "size", "left"), [(MOVING, (16, 8), (255, 40, 40)), (STILL, (4, 2), (16, 128, 240))])
def test_golden_payloads_are_pictures_of_the_size_in_the_header(
    frame: Frame, size: tuple[int, int], left: tuple[int, int, int]
) -> None:
    picture = Image.open(io.BytesIO(frame.payload)).convert("RGB")
    assert picture.size == size == (frame.width, frame.height)
    pixel = picture.getpixel((0, 0))
    assert isinstance(pixel, tuple)
    # Measured: 0 for the PNG, 3 for the JPEG of quality 60.
    assert max(abs(got - wanted) for got, wanted in zip(pixel, left, strict=True)) <= 4


def test_the_header_has_no_padding_and_starts_with_the_topic() -> None:
    assert sum(struct.calcsize("<" + field.format) for field in FIELDS) == HEADER_SIZE == 113
    packed = MOVING.pack()
    assert packed[:16] == MOVING.watch
    assert packed[16:20] == MAGIC
    assert len(packed) == LAYOUT.size + len(MOVING.payload)


def test_the_sequence_wraps_after_32_bits() -> None:
    assert Frame.unpack(replace(MOVING, sequence=2**32 + 5).pack()).sequence == 5


def test_flags_are_bits() -> None:
    both = Frame.unpack(replace(MOVING, flags=Flags.MOVING | Flags.FINAL).pack())
    assert both.flags & Flags.MOVING
    assert both.flags & Flags.FINAL


def test_a_watch_id_of_the_wrong_length_is_refused_before_it_is_sent() -> None:
    with pytest.raises(FrameError, match="16 bytes, got 3"):
        replace(MOVING, watch=b"abc").pack()


def test_a_refusal_says_why_and_readers_of_other_versions_see_that_it_is_none_of_theirs() -> None:
    """Mark and version are where version 1 of the protocol looked for them, in no fewer bytes than its header had."""
    message = refusal(bytes(range(16)), "by another topic")
    assert (message[:16], message[16:20], message[20]) == (bytes(range(16)), MAGIC, 6)
    assert len(message) >= 93
    with pytest.raises(FrameError, match=r"^by another topic$"):
        Frame.unpack(message)
