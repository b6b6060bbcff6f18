"""Uploads that a new engine lacks: it is given few at a time, however many sessions come at once."""

from __future__ import annotations

import asyncio
from typing import Any

from culet.errors import InputError
from culet.gateway.engine.link import EngineLink
from culet.gateway.settings import GatewaySettings
from culet.gateway.uploads.form import UploadedFile
from culet.gateway.uploads.uploads import GIVEN_AT_ONCE, MESH, Uploads
from culet_protocol.engine import OpenSession, PutMesh
from culet_protocol.messages import Message


class ForgottenEngine(EngineLink):
    """Keeps what it is given, until it forgets all."""

    def __init__(self) -> None:
        super().__init__(GatewaySettings(control="ipc://unused", frames="ipc://unused"))
        self.kept: set[str] = set()
        self.reading = self.most_reading = 0

    async def request(
        self,
        message: Message,
        payload: bytes | bytearray | None = None,
        *,
        patient: bool = False,
        for_asker: bool = False,
    ) -> tuple[dict[str, Any], bytes | memoryview]:
        if isinstance(message, PutMesh):
            self.reading += 1
            self.most_reading = max(self.most_reading, self.reading)
            await asyncio.sleep(0)
            self.reading -= 1
            self.kept.add(message.mesh)
        elif isinstance(message, OpenSession) and message.scene["stones"][0]["mesh"] not in self.kept:
            raise InputError("it lacks that mesh", "stones.0.mesh")
        return {}, b""


async def test_a_new_engine_is_given_few_uploads_at_a_time() -> None:
    link = ForgottenEngine()
    uploads = Uploads(link, max_bytes=2**20)
    files = [UploadedFile(f"{number}.obj", bytearray([number]), bytes([number])) for number in range(4 * GIVEN_AT_ONCE)]
    meshes = [(await uploads.put(MESH, file))[0] for file in files]
    link.kept.clear()
    scenes = [{"stones": [{"mesh": mesh}]} for mesh in meshes]
    opened = [OpenSession(session="ab" * 16, scene=scene, snapshot={}) for scene in scenes]
    await asyncio.gather(*(uploads.request(message, patient=True) for message in opened))
    assert link.kept == set(meshes)
    assert link.most_reading == GIVEN_AT_ONCE
