"""What is claimed of containers: each claim is printed once it is found to be true, or ends the program."""

from __future__ import annotations

import asyncio
import time
from collections.abc import Awaitable, Callable

PATIENCE = 240.0
"""Seconds for each answer: the first picture waits for the compiler, and a machine that does much else is slow."""


def check(holds: bool, claim: str) -> None:
    """Print the claim, or end with it."""
    if not holds:
        raise SystemExit(f"not true: {claim}")
    print(f"  {claim}", flush=True)


async def until(claim: str, condition: Callable[[], Awaitable[bool]], patience: float = PATIENCE) -> float:
    """Wait for the claim to come true, or end with it. Returns the seconds."""
    began = time.monotonic()
    while not await condition():
        if time.monotonic() - began > patience:
            raise SystemExit(f"not true within {patience:g} s: {claim}")
        await asyncio.sleep(0.2)
    took = time.monotonic() - began
    check(True, f"{claim}, after {took:.1f} s")
    return took
