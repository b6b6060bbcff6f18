"""The checked-in TypeScript and fixtures are what the Python source gives now."""

from __future__ import annotations

import pytest

from culet_protocol import fixtures, generate

TYPESCRIPT = generate.generated()
GOLDEN = fixtures.generated()


@pytest.mark.parametrize("name", TYPESCRIPT)
def test_the_typescript_is_up_to_date(name: str) -> None:
    checked_in = (generate.TYPESCRIPT / name).read_text()
    assert checked_in == TYPESCRIPT[name], "run: python -m culet_protocol.generate"


@pytest.mark.parametrize("name", GOLDEN)
def test_the_fixture_is_up_to_date(name: str) -> None:
    assert (fixtures.FIXTURES / name).read_bytes() == GOLDEN[name], "run: python -m culet_protocol.fixtures"


def test_no_fixture_is_left_from_before() -> None:
    assert {path.name for path in fixtures.FIXTURES.iterdir()} == set(GOLDEN)


def test_every_message_has_an_interface() -> None:
    for message in (*fixtures.CONTROL_EVENTS, *fixtures.NOTICES):
        assert f"export interface {type(message).__name__} {{" in TYPESCRIPT["messages.ts"]


def test_a_schema_without_a_typescript_type_is_an_error() -> None:
    with pytest.raises(TypeError, match=r"expected a schema of integer, .* got .*array"):
        generate.typescript_type({"type": "array"})


def test_generated_lines_fit() -> None:
    assert [line for text in TYPESCRIPT.values() for line in text.splitlines() if len(line) > 120] == []
