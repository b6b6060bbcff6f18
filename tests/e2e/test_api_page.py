"""/docs: what the REST interface can do, on a page that needs nothing from elsewhere."""

from __future__ import annotations

import re
from typing import Any

from playwright.sync_api import Locator

from e2e.conftest import ViewOf
from e2e.server import Server
from e2e.view import View


def open_docs(view: View) -> View:
    """Go there, and wait until it lists requests."""
    view.page.goto(f"{view.server.url}/docs")
    view.page.locator("details").first.wait_for()
    return view


def test_the_page_lists_every_request_of_the_api(view_of: ViewOf, server: Server) -> None:
    view = open_docs(view_of())
    paths: dict[str, dict[str, Any]] = server.http.get("/openapi.json").json()["paths"]
    listed = [request_of(details) for details in view.page.locator("details").all()]
    assert "GET /api/presets" in view.page.locator("main").inner_text()
    assert sorted(listed) == sorted((method.upper(), path) for path, methods in paths.items() for method in methods)
    for request in (("GET", "/api/render.tga"), ("POST", "/api/render"), ("GET", "/api/sessions/{session_id}")):
        assert request in listed


def test_the_page_needs_nothing_from_another_host(server: Server) -> None:
    text = server.http.get("/docs").text
    assert re.findall(r"""(?:src|href|url|import|fetch)\W{1,3}(?:https?:)?//""", text) == []


def test_every_request_that_needs_no_input_runs_as_it_stands(view_of: ViewOf) -> None:
    view = open_docs(view_of())
    ran = []
    for details in view.page.locator("details").all():
        method, path = request_of(details)
        if details.locator("input:required, input[type=file]").count() > 0:
            continue
        details.locator("summary").click()
        answer = run(details)
        assert re.match(r"2\d\d ", answer), f"{method} {path}: {answer}"
        ran.append((method, path))
    assert {("GET", "/api/render.tga"), ("POST", "/api/render"), ("POST", "/api/sessions")} <= set(ran)


def request_of(details: Locator) -> tuple[str, str]:
    """Method and path of an entry."""
    return details.locator("summary .method").inner_text(), details.locator("summary code").inner_text()


def run(details: Locator) -> str:
    """Press its button; the line above the answer."""
    details.get_by_role("button", name="Run").click()
    heading = details.locator("form + div > p").first
    heading.wait_for()
    return heading.inner_text()
