"""A frame as an engine sends it."""

from __future__ import annotations

from culet_protocol.frame import Codec, Flags, Frame

SESSION = "0123456789abcdef" * 2
FRAME = Frame(
    watch=bytes.fromhex(SESSION), codec=Codec.JPEG, flags=Flags.MOVING, sequence=1, width=4, height=2, samples=1,
    bands=3, max_bounces=256, cutoff=0.5, step=9, simulation_time=0.5, timestamp=1.0, simulate_ms=1, render_ms=2,
    encode_ms=3, cut=0.125, error=0.25, light_cut=0.0625, light_error=0.5, shown_error=0.125, rest_error=0.25,
    payload=b"picture",
)  # fmt: skip
