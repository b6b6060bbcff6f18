"""Errors as problem documents: RFC 9457, `application/problem+json`."""

from __future__ import annotations

import math
from collections.abc import Mapping
from http import HTTPStatus
from typing import Any

from fastapi import FastAPI, Request
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from starlette.exceptions import HTTPException
from starlette.requests import ClientDisconnect

from culet.errors import CuletError, InputError, NotFoundError
from culet.gateway.answers.departure import ClientLeftError
from culet.scene.refusal import field_of
from culet.scene.wording import at_its_tag, expected
from culet_protocol.messages import PatchScene, Question, SessionEvent, SetScene, ViewerEvent

MEDIA_TYPE = "application/problem+json"
RETRY_AFTER_SECONDS = "2"
"""For 429 and 503: a still takes about so long, and so does a restart of the engine."""

MAX_DEPTH = 32
"""Levels of nesting in JSON; a scene has 5."""

PROBLEM_SCHEMA: dict[str, Any] = {
    "type": "object",
    "required": ["type", "title", "status", "detail"],
    "properties": {
        "type": {"type": "string"},
        "title": {"type": "string"},
        "status": {"type": "integer"},
        "detail": {"type": "string"},
        "field": {"type": ["string", "null"], "description": "Where in the input, such as `scene.camera.fov_degrees`."},
    },
}


def problem(
    status: int, title: str, detail: str, field: str | None = None, headers: Mapping[str, str] | None = None
) -> JSONResponse:
    """The response; `type` is about:blank, as the status and title say all that there is to say about the kind."""
    body = {"type": "about:blank", "title": title, "status": status, "detail": _writable(detail)}
    if field is not None:
        body["field"] = _writable(field)
    return JSONResponse(body, status, headers, MEDIA_TYPE)


def problem_of(error: CuletError) -> JSONResponse:
    """The response for one of culet's own errors."""
    field = error.field if isinstance(error, InputError) else None
    headers = {"Retry-After": RETRY_AFTER_SECONDS} if error.status in (429, 503) else None
    return problem(error.status, error.title, str(error), field, headers)


def answers(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """What OpenAPI should say about a route's errors: those that its user will meet, and that any other is alike."""
    content = {MEDIA_TYPE: {"schema": PROBLEM_SCHEMA}}
    known: dict[int | str, dict[str, Any]] = {
        status: {"description": HTTPStatus(status).phrase, "content": content} for status in statuses
    }
    return {**known, "default": {"description": "Another error", "content": content}}


def check_numbers(event: SessionEvent | Question | ViewerEvent) -> None:
    """`finite` of those events whose fields hold any JSON."""
    if isinstance(event, PatchScene):
        finite(event.patch)
    if isinstance(event, SetScene):
        finite(event.scene)


def finite(value: object) -> None:
    """Raise InputError naming what of parsed JSON cannot be sent on: NaN, infinity, half a character, deep nesting.

    Python reads `NaN`, `1e999` and `"\\ud800"`, and pydantic lets them through where a field may hold any JSON; on the
    way to the engine the numbers would turn into null, which in a merge patch means: delete. Half a surrogate pair, and
    what is nested deeply, cannot be written at all.
    """
    waiting: list[tuple[object, tuple[str, ...]]] = [(value, ())]
    while waiting:
        item, path = waiting.pop()
        field = ".".join(path) or None
        if len(path) > MAX_DEPTH:
            raise InputError(f"{field}: expected at most {MAX_DEPTH} levels of nesting, got more", field)
        if isinstance(item, float) and not math.isfinite(item):
            raise InputError(f"{field or 'body'}: expected a finite number, got {item}", field)
        if isinstance(item, str):
            _check_text(item, field)
        if isinstance(item, dict):
            for key in item:
                _check_text(key, field)
            waiting += [(inner, (*path, str(key))) for key, inner in item.items()]
        if isinstance(item, list):
            waiting += [(inner, (*path, str(index))) for index, inner in enumerate(item)]


def _check_text(text: str, field: str | None) -> None:
    if _writable(text) != text:
        raise InputError(f"{field or 'body'}: expected text, got half a surrogate pair in {_short(text)}", field)


def install(app: FastAPI) -> None:
    """Make every error of the app a problem document."""
    app.exception_handler(CuletError)(_of_culet)
    app.exception_handler(RequestValidationError)(_of_validation)
    app.exception_handler(HTTPException)(_of_http)
    app.exception_handler(ClientDisconnect)(_of_leaving)
    app.exception_handler(Exception)(_of_bug)


async def _of_culet(_request: Request, error: CuletError) -> JSONResponse:
    return problem_of(error)


async def _of_validation(request: Request, error: RequestValidationError) -> JSONResponse:
    # FastAPI's own answer repeats the input, and fails with a 500 if NaN is in it.
    findings = error.errors()
    first = at_its_tag(findings[0])
    if first["loc"] == ("body",) and isinstance(first.get("input"), bytes):  # FastAPI did not read it
        got = request.headers.get("content-type", "none")
        return problem(415, "unsupported media type", f"expected Content-Type: application/json, got {got[:80]}")
    if first["type"] == "json_invalid":
        detail = f"the body is not JSON: {first['ctx']['error']} at character {first['loc'][-1]}"
        return problem(InputError.status, InputError.title, detail)
    field = field_of(tuple(first["loc"][1:])) or None
    came = "" if first["type"] in ("missing", "union_tag_not_found") else f"; got {_short(first.get('input'))}"
    more = f" (and {len(findings) - 1} more)" if len(findings) > 1 else ""
    where = field or first["loc"][0]
    return problem(InputError.status, InputError.title, f"{where}: {expected(first)}{came}{more}", field)


async def _of_http(request: Request, error: HTTPException) -> JSONResponse:
    if error.status_code == 400 and (unreadable := _unreadable(error.__cause__)):
        return problem(InputError.status, InputError.title, f"the body is not JSON: {unreadable}")
    phrase = HTTPStatus(error.status_code).phrase
    detail = error.detail
    if error.status_code == NotFoundError.status and detail == phrase:  # no route leads there
        detail = f"there is nothing at {_short(request.url.path)}; /docs has all addresses"
    return problem(error.status_code, phrase.lower(), detail, None, error.headers)


async def _of_leaving(_request: Request, _error: ClientDisconnect) -> JSONResponse:
    return problem_of(ClientLeftError("the client left before it had sent its body"))


async def _of_bug(_request: Request, _error: Exception) -> JSONResponse:
    return problem(500, CuletError.title, "something went wrong in the gateway; its log says what")


def _unreadable(cause: BaseException | None) -> str | None:
    """Why a body could not be parsed, of the causes that FastAPI has one answer for."""
    match cause:
        case UnicodeDecodeError():
            return f"byte {cause.start} is not {cause.encoding.upper()}"
        case RecursionError():
            return f"expected at most {MAX_DEPTH} levels of nesting, got very many"
        case ValueError():
            return str(cause).partition(";")[0]  # what follows tells of an interpreter's setting
        case _:
            return None


def _writable(text: str) -> str:
    """The text as UTF-8 can hold it: half a surrogate pair, which JSON can spell, is spelt out."""
    return text.encode("utf-8", "backslashreplace").decode()


def _short(value: object) -> str:
    shown = repr(value)
    return shown if len(shown) <= 80 else shown[:77] + "..."
