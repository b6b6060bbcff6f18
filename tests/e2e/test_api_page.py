"""/docs: what the REST interface can do, on a page that runs requests and needs nothing from elsewhere."""

from __future__ import annotations

import re
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from e2e.conftest import ViewOf
from e2e.server import Server
from e2e.view import View


def open_docs(view: View) -> View:
    """Go there, and wait until it lists requests."""
    view.page.goto(f"{view.server.url}/docs")
    view.page.locator(".opblock").first.wait_for()
    return view


def test_the_page_lists_every_request_of_the_api_and_asks_no_other_host(view_of: ViewOf, server: Server) -> None:
    view = view_of()
    asked: list[str] = []
    view.page.on("request", lambda request: asked.append(request.url))
    open_docs(view)
    paths: dict[str, dict[str, Any]] = server.http.get("/openapi.json").json()["paths"]
    expect(view.page.locator(".opblock")).to_have_count(sum(map(len, paths.values())))
    listed = [request_of(entry) for entry in view.page.locator(".opblock").all()]
    assert sorted(listed) == sorted((method.upper(), path) for path, methods in paths.items() for method in methods)
    assert f"{server.url}/openapi.json" in asked
    assert [url for url in asked if not url.startswith((server.url, "data:"))] == []


@pytest.mark.parametrize(("method", "path"), [("GET", "/api/render.png"), ("POST", "/api/sessions")])
def test_a_request_runs_as_it_stands(view_of: ViewOf, method: str, path: str) -> None:
    view = open_docs(view_of())
    (entry,) = (entry for entry in view.page.locator(".opblock").all() if request_of(entry) == (method, path))
    entry.locator(".opblock-summary-control").click()
    entry.get_by_role("button", name="Execute").click()
    status = entry.locator(".live-responses-table .response-col_status").last
    status.wait_for()
    assert re.match(r"2\d\d", status.inner_text())
    assert f"curl -X '{method}'" in entry.locator(".curl-command").inner_text()


def request_of(entry: Locator) -> tuple[str, str]:
    """Method and path of an entry; paths are broken into lines by characters without width."""
    path = entry.locator(".opblock-summary-path, .opblock-summary-path__deprecated").inner_text()
    return entry.locator(".opblock-summary-method").inner_text(), path.replace("\u200b", "")
