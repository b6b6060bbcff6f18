"""`python -m hostile.flood URL KIND`: a viewer that sends one kind of message as fast as it can, until it is ended.

It prints a line once it sends.
"""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Mapping, Sequence

from websockets.asyncio.client import connect
from websockets.exceptions import WebSocketException
from websockets.typing import Subprotocol

from culet_protocol import SUBPROTOCOL
from culet_protocol.frame import Frame

MESSAGES: Mapping[str, Sequence[Mapping[str, object]]] = {
    "resize": [{"type": "resize", "width": width, "height": 100} for width in (100, 600)],
    "orbit": [{"type": "orbit", "yaw": 0.01, "pitch": 0}],
    "questions": [
        {"type": "pick", "number": 1, "x": 0.1, "y": 0},
        {"type": "outline", "stone": "stone-1", "step": 1},
    ],
    "reach": [{"type": "reach", "number": number} for number in range(2)],
    "scatter": [
        {"type": "patch_scene", "patch": {"stones": [{"position": [n % 8 + x, 3, n // 8]} for n in range(64)]}}
        for x in (0, 0.5)
    ],
}


async def flood(url: str, kind: str) -> None:
    """Until the process ends; a viewer that is closed for it comes back."""
    messages, told = [json.dumps(message) for message in MESSAGES[kind]], False
    while True:
        try:
            async with connect(
                url, subprotocols=[Subprotocol(SUBPROTOCOL)], max_size=None, compression=None, proxy=None
            ) as connection:

                async def send() -> None:
                    nonlocal told
                    while True:
                        for message in messages:
                            await connection.send(message)
                        if not told:
                            print("sending", flush=True)
                            told = True
                        await asyncio.sleep(0)

                sending = asyncio.create_task(send())
                try:
                    async for message in connection:
                        if isinstance(message, bytes):
                            sequence = Frame.unpack(message).sequence
                            await connection.send(json.dumps({"type": "ack", "sequence": sequence}))
                finally:
                    sending.cancel()
                    await asyncio.gather(sending, return_exceptions=True)
        except (OSError, TimeoutError, WebSocketException):
            await asyncio.sleep(0.1)


if __name__ == "__main__":
    asyncio.run(flood(*sys.argv[1:]))
