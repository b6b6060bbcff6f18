"""The user's browser, shown the page once the server is there."""

from __future__ import annotations

import html
import logging
import webbrowser
from pathlib import Path

log = logging.getLogger(__name__)

FILE = "open.html"


def show(page: str, folder: Path) -> None:
    """Have a browser open the page; one with a token by a file in the folder, which leads on to the page.

    Everybody on this machine sees what a browser is started with, and only this user the file.
    """
    bare, token, _ = page.partition("#token=")
    if not webbrowser.open(_leading_to(page, folder) if token else page):
        log.warning("no browser could be started; open %s", bare)


def _leading_to(page: str, folder: Path) -> str:
    """Address of a file that leads on to the page."""
    file, address = folder / FILE, html.escape(page)
    file.touch(0o600, exist_ok=False)
    file.write_text(
        '<!doctype html><meta charset="utf-8"><meta name="referrer" content="no-referrer"><title>culet</title>'
        f'<meta http-equiv="refresh" content="0; url={address}"><a href="{address}">culet</a>\n'
    )
    return file.as_uri()
