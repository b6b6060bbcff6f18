"""Which pages may come in, and which names this server goes by."""

from __future__ import annotations

import pytest

from culet.gateway.identity.origins import Hosts, may_enter, read_origin


@pytest.mark.parametrize(
    ("scheme", "origin", "host", "enters"),
    [
        ("http", None, "gems.example", True),
        ("http", "http://gems.example", "gems.example", True),
        ("ws", "http://gems.example", "gems.example:80", True),
        ("wss", "https://gems.example", "Gems.Example:443", True),
        ("https", "https://gems.example:8443", "gems.example:8443", True),
        ("http", "http://[::1]:8000", "[::1]:8000", True),
        ("http", "https://gems.example", "gems.example", False),
        ("https", "http://gems.example", "gems.example", False),
        ("http", "http://gems.example:81", "gems.example", False),
        ("http", "http://elsewhere.example", "gems.example", False),
        ("http", "http://gems.example.elsewhere.example", "gems.example", False),
        ("http", "null", "gems.example", False),
        ("http", "null", None, False),
        ("http", "null", "", False),
        ("http", "file://", "", False),
        ("http", "http://", "", False),
        ("http", "http://[", "gems.example", False),
        ("http", "http://[", "[", False),
        ("http", "http://gems.example:99999999999", "gems.example", False),
        ("http", "http://evil@gems.example", "gems.example", False),
        ("http", "\xff", "gems.example", False),
        ("http", "https://studio.example", "gems.example", True),
        ("http", "HTTPS://studio.example:443", "gems.example", True),
        ("http", "http://studio.example", "gems.example", False),
    ],
)
def test_a_page_enters_from_the_same_origin_or_an_allowed_one(
    scheme: str, origin: str | None, host: str | None, enters: bool
) -> None:
    headers = {"origin": origin, "host": host}
    raw = [(name.encode(), value.encode("latin-1")) for name, value in headers.items() if value is not None]
    assert may_enter({"type": "http", "scheme": scheme, "headers": raw}, ("https://studio.example",)) is enters


@pytest.mark.parametrize(
    ("host", "known"),
    [
        (None, True),
        ("localhost:8000", True),
        ("gems.localhost", True),
        ("127.0.0.1:8000", True),
        ("192.0.2.7", True),
        ("[2001:db8::1]:8000", True),
        ("gems.example", True),
        ("GEMS.example.:443", True),
        ("a.b.shop.example", True),
        ("shop.example", False),
        ("rebind.evil.example", False),
        ("gems.example.evil.example", False),
        ("localhost.evil.example", False),
        ("evillocalhost", False),
        ("evilshop.example", False),
        ("127.0.0.1.evil.example", False),
        ("", False),
        ("[", False),
        ("gems.example@evil.example", False),
        ("gems.example:80:80", False),
        ("x" * 60_000, False),
    ],
)
def test_a_server_goes_by_addresses_localhost_and_the_names_that_it_was_given(host: str | None, known: bool) -> None:
    assert Hosts(["gems.example", "*.shop.example"]).allow(host) is known


def test_any_name_is_allowed_by_a_star() -> None:
    assert Hosts(["*"]).allow("rebind.evil.example")


@pytest.mark.parametrize("name", ["", "gems.example:80", "http://gems.example", "*.", "a b", "*gems.example"])
def test_what_is_no_name_of_a_server_is_refused(name: str) -> None:
    with pytest.raises(ValueError, match="expected a name without a port"):
        Hosts([name])


def test_an_origin_is_written_as_browsers_write_it() -> None:
    assert [
        str(read_origin(text)) for text in ("HTTP://A.Example:80", "https://a.example:8443", "http://[::1]:80")
    ] == [
        "http://a.example",
        "https://a.example:8443",
        "http://[::1]",
    ]
