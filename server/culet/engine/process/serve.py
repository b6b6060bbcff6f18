"""The engine's process: `culet engine` calls `run`, which returns at SIGTERM or SIGINT."""

from __future__ import annotations

import asyncio
import logging
import os
import signal
import sys
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import TYPE_CHECKING

import zmq.asyncio

from culet.engine.capacity.heap import keep_little
from culet.engine.capacity.limits import Limits
from culet.engine.painting.renderer import AnyPicture, AnyRenderer
from culet.engine.painting.still import EncodeStill
from culet.engine.process.engine import EngineServer
from culet.engine.process.strangers import engine_keys, letting_in
from culet.errors import CuletError

if TYPE_CHECKING:
    from culet.legend import Line

log = logging.getLogger(__name__)

SWITCH_SECONDS = 5e-4
"""s after which a thread that computes in Python lets others go on that wait for the interpreter. A frame waits for it
some ten times on its way, between kernels, the encoder and the network: Python's own 5 ms are a third of its time at 60
frames/s."""


def run(control: str, frames: Sequence[str], limits: Limits | None = None, *, stand_by: bool = False) -> None:
    """Serve until SIGTERM or SIGINT: control at one endpoint, frames at each of some. The process may end with it.

    With `stand_by` it gets everything ready but its sockets, and then waits for a line on the standard input.
    DeviceError without a working device, InputError for a bad endpoint.
    """
    keep_little()
    sys.setswitchinterval(SWITCH_SECONDS)
    start = asyncio.Event()
    asyncio.run(_run(control, frames, limits or Limits(), start, stand_by=stand_by))
    _end_beside_compilers()


def _end_beside_compilers() -> None:
    """End the process here if a thread still compiles, or whatever else nobody waits for.

    Python ends such a thread, when it comes back to Python, by unwinding its stack. In a driver's C++ that is
    `std::terminate`, and the process would abort.
    """
    if any(thread.daemon for thread in threading.enumerate()):
        logging.shutdown()
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(0)


async def _run(control: str, frames: Sequence[str], limits: Limits, start: asyncio.Event, *, stand_by: bool) -> None:
    loop = asyncio.get_running_loop()

    def begin() -> None:
        loop.remove_reader(sys.stdin)  # the line, and the end of a closed input, would wake the loop for ever
        start.set()

    if stand_by:
        loop.add_reader(sys.stdin, begin)
    else:
        start.set()
    await serve(
        control, frames, limits, partial(open_renderer, special_programs=limits.special_programs), encode_still, start
    )
    if stand_by:
        loop.remove_reader(sys.stdin)


def open_renderer(*, special_programs: bool) -> AnyRenderer:
    """The OpenCL renderer, its special programs compiled while the general one serves, or with none.

    It is imported here, so that whatever only speaks to an engine never loads it.
    """
    from culet.rendering import first_programs

    with first_programs.made_apart():
        import culet.rendering.film.files  # so that the first still needs not wait for it  # noqa: F401
        from culet.rendering.cut_out import CuttingRenderer
        from culet.rendering.opencl import kernel_cache

    if not kernel_cache.has_plenty_of_room() and (fault := kernel_cache.complaint()):
        log.error("%s", fault)  # said first: the compiler may end this process
    renderer = CuttingRenderer(background_compile=True, special_programs=special_programs)
    try:
        renderer.prepare()
    except CuletError as error:  # what needs these programs says so itself, and other work goes on
        log.error("%s", error)
    return renderer


def encode_still(picture: AnyPicture, file_format: str, legend: Sequence[Line] = ()) -> bytes:
    """A still in its file format, with those lines in a corner."""
    from culet.rendering.film.files import encode
    from culet.rendering.renderer import DevicePicture

    assert isinstance(picture, DevicePicture)  # noqa: S101 - made by `open_renderer`
    if not legend:
        return encode(file_format, picture.rgb, picture.linear)
    from culet.legend import drawn

    return encode(file_format, lambda: drawn(picture.rgb(), list(legend)), picture.linear)


async def serve(
    control: str,
    frames: Sequence[str],
    limits: Limits,
    renderer_of: Callable[[], AnyRenderer],
    encode: EncodeStill,
    start: asyncio.Event | None = None,
) -> None:
    """Serve with a renderer that is made and used on the render thread, once `start` is set."""
    loop = asyncio.get_running_loop()
    stopping = asyncio.Event()
    keys = engine_keys(limits.keys)
    for number in (signal.SIGTERM, signal.SIGINT):
        loop.add_signal_handler(number, stopping.set)
    render_thread = ThreadPoolExecutor(1, "render")
    context = zmq.asyncio.Context()
    try:
        renderer = await loop.run_in_executor(render_thread, renderer_of)
        if start is not None and not await _first(start, stopping):
            return
        with letting_in(context, keys):
            engine = EngineServer(context, control, frames, limits, renderer, render_thread, encode, keys)
            await engine.run_until(stopping)
    finally:
        render_thread.shutdown(wait=False, cancel_futures=True)
        context.destroy(linger=0)


async def _first(event: asyncio.Event, other: asyncio.Event) -> bool:
    """Wait for the first of two events; whether the one is set, and not the other."""
    waiting = [asyncio.create_task(waited.wait()) for waited in (event, other)]
    await asyncio.wait(waiting, return_when=asyncio.FIRST_COMPLETED)
    for task in waiting:
        task.cancel()
    return not other.is_set()
