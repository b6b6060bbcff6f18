"""The few requests of REST that a viewer needs: a session made, told something, changed, seen, forgotten."""

from __future__ import annotations

import http.client
import json
import secrets
import urllib.error
import urllib.request
from pathlib import PurePath
from typing import Any
from urllib.parse import urlencode, urlsplit, urlunsplit

from culet_client.errors import ClientError, RefusedError
from culet_protocol.messages import Message


class _NoRedirects(urllib.request.HTTPRedirectHandler):
    """What another server is asked, it would be asked with this one's token."""

    def redirect_request(self, *_: object) -> None:
        """None that is followed: the answer counts as a refusal."""


_OPENER = urllib.request.build_opener(_NoRedirects)


class Rest:
    """A gateway's interface."""

    def __init__(self, server: str, timeout_seconds: float, token: str | None = None) -> None:
        """The gateway at an address such as `http://127.0.0.1:8000`; ClientError for one that is none."""
        parts = urlsplit(server)
        scheme = {"http": "http", "https": "https", "ws": "http", "wss": "https"}.get(parts.scheme)
        if scheme is None or not parts.netloc:
            raise ClientError(f"expected a server such as http://127.0.0.1:8000, got {server!r}")
        self.server = urlunsplit((scheme, parts.netloc, parts.path.rstrip("/"), "", ""))
        self._timeout = timeout_seconds
        self._headers: dict[str, str] = {}
        if token is not None:
            self._headers["Authorization"] = f"Bearer {token}"

    def make_session(self, scene: dict[str, Any] | None, preset: str | None) -> str:
        """The id of a new session that shows a scene, or a preset, or the default scene."""
        given = {"scene": scene, "preset": preset}
        answer = self._ask("POST", "/api/sessions", {name: value for name, value in given.items() if value is not None})
        session = answer.get("id")
        if not isinstance(session, str):
            raise ClientError(f"{self.server} made a session and did not say its id")
        return session

    def tell(self, session: str, event: Message) -> None:
        """Apply an event to a session; RefusedError says why it cannot be."""
        self._ask("POST", f"/api/sessions/{session}/events", event.model_dump(mode="json"))

    def forget_session(self, session: str) -> None:
        """Delete it."""
        self._ask("DELETE", f"/api/sessions/{session}")

    def patch(self, session: str, patch: dict[str, Any]) -> None:
        """Change parts of a session's scene by a merge patch; RefusedError says why it cannot be."""
        self._ask("PATCH", f"/api/sessions/{session}", patch)

    def scene(self, session: str) -> dict[str, Any]:
        """What a session shows now, with camera and stones where they are."""
        return self._ask("GET", f"/api/sessions/{session}/scene")

    def upload(self, kind: str, name: str, content: bytes) -> str:
        """The id that scenes name a file by, once it is brought: one of `meshes` or `skies`, its kind by the ending of
        its name. RefusedError says why it cannot be used."""
        boundary, ending = secrets.token_hex(16), PurePath(name).suffix
        head = f'--{boundary}\r\nContent-Disposition: form-data; name="file"; filename="file{ending}"\r\n\r\n'
        body = head.encode() + content + f"\r\n--{boundary}--\r\n".encode()
        answer = self._read(self._answer("POST", f"/api/{kind}", body, f"multipart/form-data; boundary={boundary}"))
        return str(answer["id"])

    def frame(self, session: str, ending: str, asked: dict[str, float | None]) -> bytes:
        """The file of a picture of what a session shows, rendered anew; `asked` as in the query of `frame.png`."""
        query = urlencode({name: value for name, value in asked.items() if value is not None})
        return self._answer("GET", f"/api/sessions/{session}/frame.{ending}?{query}")

    def _ask(self, method: str, path: str, body: dict[str, Any] | None = None) -> dict[str, Any]:
        data = None if body is None else json.dumps(body).encode()
        return self._read(self._answer(method, path, data))

    def _read(self, text: bytes) -> dict[str, Any]:
        try:
            answered: dict[str, Any] = json.loads(text) if text else {}
        except ValueError as error:
            raise ClientError(f"{self.server} answered with something else than JSON; is it culet?") from error
        return answered

    def _answer(self, method: str, path: str, body: bytes | None = None, of: str = "application/json") -> bytes:
        request = urllib.request.Request(  # noqa: S310 - http or https, as checked above
            self.server + path, body, {**self._headers, "Content-Type": of}, method=method
        )
        try:
            with _OPENER.open(request, timeout=self._timeout) as answer:
                answered: bytes = answer.read()
        except urllib.error.HTTPError as error:
            elsewhere = error.headers.get("Location")
            if 300 <= error.code < 400 and elsewhere:
                raise ClientError(f"{self.server} answers with a redirect to {elsewhere}; name that server") from error
            raise _refusal(error) from error
        except (OSError, http.client.HTTPException) as error:
            raise ClientError(f"cannot reach {self.server}: {getattr(error, 'reason', error)}") from error
        return answered


def _refusal(error: urllib.error.HTTPError) -> RefusedError:
    """What the problem document says (RFC 9457), if there is one."""
    try:
        problem = json.loads(error.read())
        return RefusedError(f"{problem['title']}: {problem['detail']}", problem.get("field"))
    except (ValueError, KeyError, TypeError):
        return RefusedError(f"the server answered with status {error.code}")
