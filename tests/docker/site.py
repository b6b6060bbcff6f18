"""Units behind the proxy of docker/units.yaml, as those see them who come by the proxy and TLS, and from within."""

from __future__ import annotations

import json
import ssl
from typing import Any

import httpx
from websockets.asyncio.client import connect

from docker.claims import PATIENCE
from docker.containers import Container, Containers
from docker.watcher import connected

ASK = """
import json, os, sys
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen
answers = []
for path in sys.argv[1:]:
    request = Request("http://127.0.0.1:8000" + path, headers={"Authorization": "Bearer " + os.environ["CULET_TOKEN"]})
    try:
        with urlopen(request, timeout=60) as answer:
            answers.append((answer.status, answer.read().decode()))
    except HTTPError as refused:
        answers.append((refused.code, ""))
    except URLError:
        answers.append((0, ""))
print(json.dumps(answers))
"""
"""Run in a unit: what its own server answers to each path; 0 while it does not listen."""


class Site:
    """The proxy's address, and the containers."""

    def __init__(self, address: str, token: str, context: ssl.SSLContext, containers: Containers) -> None:
        self.url = f"https://{address}"
        self.token = token
        self.context = context
        self.containers = containers

    def client(self) -> httpx.AsyncClient:
        """Who was never here before: without a cookie, and without a connection."""
        return httpx.AsyncClient(base_url=self.url, verify=self.context, timeout=PATIENCE)

    async def make(self, **asked: object) -> dict[str, str]:
        """A new session, by a client of its own."""
        async with self.client() as http:
            body = asked or {"preset": "matte"}
            made = await http.post("/api/sessions", json=body, headers={"Authorization": f"Bearer {self.token}"})
            answer: dict[str, str] = made.raise_for_status().json()
            return answer

    async def delete(self, *sessions: str) -> None:
        """Sessions, by a client of its own for each."""
        for session in sessions:
            async with self.client() as http:
                (await http.delete(f"/api/sessions/{session}")).raise_for_status()

    async def tell(self, session: str, event: dict[str, Any]) -> None:
        """Do something to a session."""
        async with self.client() as http:
            (await http.post(f"/api/sessions/{session}/events", json=event)).raise_for_status()

    def stream(self, path: str) -> str:
        """The address of a stream."""
        return f"{self.url.replace('https', 'wss', 1)}{path}"

    def open(self, path: str, *protocols: str) -> connect:
        """A stream by the proxy and TLS."""
        return connected(self.stream(path), self.context, *protocols)

    async def units(self) -> list[Container]:
        """Those that run, the eldest first."""
        return [each for each in await self.containers.all("unit") if (await each.inspect())["State"]["Running"]]

    async def holders(self, *sessions: str) -> list[list[bool]]:
        """Which unit has which of the sessions: a row for each unit."""
        found = []
        for unit in await self.units():
            answers = json.loads(await unit.python(ASK, *(f"/api/sessions/{session}" for session in sessions)))
            found.append([status == 200 for status, _ in answers])
        return found

    async def viewers(self) -> list[int]:
        """How many each unit has."""
        found = []
        for unit in await self.units():
            ((_, text),) = json.loads(await unit.python(ASK, "/metrics"))
            lines = [line.split() for line in text.splitlines() if not line.startswith("#")]
            found.append(int(float(dict(lines)["culet_viewers"])))
        return found
