"""What the user's browser is started with."""

from __future__ import annotations

import logging
import webbrowser
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from culet.service.browser import show

PAGE = "http://127.0.0.1:8000/"
SECRET = "a-token-for-this-user"  # noqa: S105 - of no server


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Addresses that the browser was to show; there is none that could."""
    addresses: list[str] = []
    monkeypatch.setattr(webbrowser, "open", addresses.append)
    return addresses


def test_a_page_without_a_token_is_opened_itself(opened: list[str], tmp_path: Path) -> None:
    show(PAGE, tmp_path)
    assert opened == [PAGE]


def test_a_token_stands_in_a_file_of_this_user_alone(
    opened: list[str], tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING):
        show(f"{PAGE}#token={SECRET}", tmp_path)
    (address,) = opened
    assert SECRET not in address
    assert SECRET not in caplog.text
    assert f"open {PAGE}" in caplog.text
    file = Path(urlsplit(address).path)
    assert file.stat().st_mode & 0o777 == 0o600
    assert f'content="0; url={PAGE}#token={SECRET}"' in file.read_text()
