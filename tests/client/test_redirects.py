"""What the client does when a server sends it on to another one."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, HTTPServer

import pytest

from culet_client import ClientError
from culet_client.rest import Rest

TOKEN = "correct-horse-battery-staple"  # noqa: S105 - of this test


@contextmanager
def listening(handler: type[BaseHTTPRequestHandler]) -> Iterator[str]:
    """The address of a server."""
    with HTTPServer(("127.0.0.1", 0), handler) as server:
        serving = threading.Thread(target=server.serve_forever, args=(0.01,))
        serving.start()
        try:
            yield f"http://127.0.0.1:{server.server_port}"
        finally:
            server.shutdown()
            serving.join()


class Handler(BaseHTTPRequestHandler):
    def log_message(self, *_: object) -> None:
        """Nothing."""


@pytest.mark.parametrize("status", [301, 302, 303, 307, 308])
def test_no_other_server_is_told_the_token(status: int) -> None:
    heard: list[str | None] = []

    class Elsewhere(Handler):
        def do_GET(self) -> None:
            heard.append(self.headers["Authorization"])
            self.send_response(200)
            self.end_headers()
            self.wfile.write(b"{}")

    with listening(Elsewhere) as other:

        class SendsOn(Handler):
            def do_GET(self) -> None:
                self.send_response(status)
                self.send_header("Location", other + self.path)
                self.end_headers()

        with listening(SendsOn) as server, pytest.raises(ClientError, match=f"{server} answers with a redirect to"):
            Rest(server, 10, TOKEN).scene("5" * 32)
    assert heard == []
