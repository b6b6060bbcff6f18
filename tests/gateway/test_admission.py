"""Which pages may come in."""

from __future__ import annotations

import pytest
from starlette.datastructures import Headers

from culet.gateway.admission import may_enter


@pytest.mark.parametrize(
    ("origin", "host", "enters"),
    [
        (None, "gems.example", True),
        ("http://gems.example", "gems.example", True),
        ("https://gems.example:8443", "gems.example:8443", True),
        ("http://gems.example:81", "gems.example", False),
        ("http://elsewhere.example", "gems.example", False),
        ("http://gems.example.elsewhere.example", "gems.example", False),
        ("null", "gems.example", False),
        ("null", None, False),
        ("https://studio.example", "gems.example", True),
        ("http://studio.example", "gems.example", False),
    ],
)
def test_a_page_enters_from_the_same_host_or_an_allowed_origin(
    origin: str | None, host: str | None, enters: bool
) -> None:
    headers = {name: value for name, value in (("origin", origin), ("host", host)) if value is not None}
    assert may_enter(Headers(headers), ("https://studio.example",)) is enters
