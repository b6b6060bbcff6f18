"""The specification in words says what the code says."""

from __future__ import annotations

import re
import struct

import pytest

from culet_protocol import SUBPROTOCOL, fixtures, generate
from culet_protocol.close import FINAL, CloseCode
from culet_protocol.frame import FIELDS, HEADER_SIZE
from culet_protocol.messages import Message

TEXT = (generate.TYPESCRIPT.parent / "README.md").read_text()
ROWS = [tuple(cell.strip() for cell in line.strip("|").split("|")) for line in TEXT.splitlines() if line[:1] == "|"]
TYPES = {"16s": "16 bytes", "4s": "4 bytes", "B": "u8", "H": "u16", "I": "u32", "Q": "u64", "d": "f64", "f": "f32"}


def test_the_header_table_gives_every_field_its_offset_and_type() -> None:
    offset, wanted = 0, []
    for field in FIELDS:
        wanted.append((str(offset), field.name, TYPES[field.format]))
        offset += struct.calcsize("<" + field.format)
    assert [row[:3] for row in ROWS if row[0].isdigit() and len(row) == 4] == wanted
    assert f"{HEADER_SIZE} bytes, then" in TEXT


@pytest.mark.parametrize("message", [*fixtures.CONTROL_EVENTS, *fixtures.NOTICES], ids=lambda m: type(m).__name__)
def test_every_message_is_listed_with_its_fields(message: Message) -> None:
    fields = set(type(message).model_fields) - {"type"}
    (row,) = [row for row in ROWS if row[0] == f"`{message.model_dump()['type']}`"]
    assert {re.split(r"[?:( ]", part.strip())[0] for part in re.split(r",(?![^`]*`$)", row[1]) if part} >= fields


def test_every_close_code_is_listed_with_whether_to_come_back() -> None:
    listed = {int(code): row[2] for row in ROWS if re.match(r"\d{4}", row[0]) for code in re.findall(r"\d{4}", row[0])}
    assert set(listed) == set(CloseCode)
    assert {code for code, answer in listed.items() if answer == "no"} == set(FINAL)


def test_the_subprotocol_is_named() -> None:
    assert f"`{SUBPROTOCOL}`" in TEXT
