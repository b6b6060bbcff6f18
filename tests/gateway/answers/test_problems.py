"""Numbers that JSON cannot hold, and errors from the engine."""

from __future__ import annotations

import math

import pytest

from culet.errors import BusyError, CuletError, EngineUnavailableError, InputError, NotFoundError, TooLargeError
from culet.gateway.answers.problems import finite
from culet.gateway.engine.link import error_of
from culet_protocol.engine import Reply


@pytest.mark.parametrize("number", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_none_is_named_by_its_place(number: float) -> None:
    with pytest.raises(InputError, match=r"emitters\.1\.position: expected a finite number") as refused:
        finite({"emitters": [{"position": 0.0}, {"position": number}], "name": "x"})
    assert refused.value.field == "emitters.1.position"


def test_deep_nesting_is_refused_before_anything_recurses_into_it() -> None:
    nested: list[object] = []
    for _ in range(100_000):
        nested = [nested]
    with pytest.raises(InputError, match="levels of nesting"):
        finite({"camera": nested})


def test_finite_numbers_pass_at_any_depth() -> None:
    finite({"a": [1, 2.5, {"b": None, "c": "NaN", "d": True}]})


@pytest.mark.parametrize(
    ("status", "error", "field"),
    [
        (404, NotFoundError, None),
        (413, TooLargeError, "file"),
        (422, InputError, "camera.up"),
        (429, BusyError, None),
        (500, CuletError, None),
        (503, EngineUnavailableError, None),
    ],
)
def test_the_engines_refusals_keep_their_status_title_and_field(
    status: int, error: type[CuletError], field: str | None
) -> None:
    raised = error_of(Reply(status=status, title="a title", detail="what happened", field=field))
    assert type(raised) is error
    assert (raised.status, raised.title, str(raised)) == (status, "a title", "what happened")
    assert getattr(raised, "field", None) == field
