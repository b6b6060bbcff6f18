"""What the engine answers to each request of the gateway."""

from __future__ import annotations

import asyncio
import math
import os
import time
from collections.abc import Callable
from functools import partial
from typing import Any, assert_never

from culet.engine import events
from culet.engine.assets import Assets
from culet.engine.limits import Limits, check_still_size, check_still_work, live_size
from culet.engine.live import LivePicture
from culet.engine.memory import Memory
from culet.engine.painter import Painter
from culet.engine.session import Session, Sky
from culet.engine.snapshot import Snapshot
from culet.engine.still import SESSION_STILL_SAMPLES, Still, StillQueue
from culet.engine.upload_process import Buffer
from culet.engine.uploads import MESH, SKY, UploadStore
from culet.errors import BusyError, InputError, NotFoundError
from culet.geometry.stone import Stone
from culet.rendering.panoramas import Panorama
from culet.rendering.sky_files.picture import SkyPicture
from culet.scene import Environment, Scene
from culet.scene.model import ImageEnvironment
from culet_protocol import engine as protocol

STILL_SIZE = (640, 360)
"""Pixels of a still that names no size."""

SUBSCRIPTIONS = 4096
"""Subscriptions that are remembered: sessions may be opened after somebody subscribed to them."""

SESSION_BYTES = 2**20
"""Of a session: its scene, its simulation with the stone's hull, and its stone if that is a cut."""
SHOWN_BYTES = 2**14
"""Of a shown state whose scene is another than the one before; one in which only the stone moved takes 2.6 KiB."""
HISTORY_SHARE = 1 / 8
"""Of the memory that all histories together may take."""
LEAST_LIVE_SIZE = (160, 90)
"""Pixels that a live picture has in any case."""

LONG_EVENTS = frozenset({"patch_scene", "set_scene", "toggle_fall", "toggle_walls", "push"})
"""They may make a stone or its hull, or try whether a stone that sleeps would move: other sessions go on meanwhile."""

MOTION_SECONDS = 0.05
"""Between reports of a session that moves. If this engine dies, so much of the motion is lost at most."""

Answer = tuple[dict[str, Any], bytes | None]


class Requests:
    """The engine's sessions, and the meaning of every request."""

    def __init__(
        self,
        painter: Painter,
        stills: StillQueue,
        limits: Limits,
        device: dict[str, Any],
        *,
        tell: Callable[[protocol.SessionState | protocol.SessionMotion], None],
        memory: Memory,
        forget_sky: Callable[[SkyPicture], object],
    ) -> None:
        self.instance = os.urandom(8).hex()
        """Differs for every process."""
        self._painter = painter
        self._stills = stills
        self._limits = limits
        self._device = device
        self._tell = tell
        self._memory = memory
        self._meshes = UploadStore(MESH, limits, memory, in_use=self._named)
        self._skies = UploadStore(SKY, limits, memory, in_use=self._named, forgotten=forget_sky)
        self._assets = Assets(self._meshes, self._skies)
        self._history = history_length(limits, memory.budget)
        memory.count("sessions", self._session_bytes)
        memory.count("histories", self._history_bytes)
        self._touched: dict[str, float] = {}
        self._awaited: set[Still] = set()
        """Stills that somebody waits for."""
        self._clients: dict[str, str] = {}
        """Who opened the sessions."""
        self._told: dict[str, tuple[int, int]] = {}
        """What of each session was told last: its step and frame."""
        self._reporting: set[str] = set()
        self._subscriptions: set[bytes] = set()
        self._started = time.monotonic()
        self._closed_pace = 0.0, 0.0
        """Of sessions that are closed: seconds that were to be simulated, and of these those that were dropped."""

    async def answer(self, request: protocol.Request, data: Buffer | None) -> Answer:
        """Do what is asked; CuletError if it cannot be done."""
        match request:
            case protocol.OpenSession():
                return await self._open(request), None
            case protocol.CloseSession():
                return self._close(request.session), None
            case protocol.GetSession():
                return described(self._live(request.session)), None
            case protocol.ListSessions():
                return {"sessions": [self._described(live) for live in self._painter.pictures.values()]}, None
            case protocol.Control():
                return await self._control(request), None
            case protocol.Demand():
                return self._demand(request), None
            case protocol.Render():
                return await self._render(request)
            case protocol.PutMesh():
                return await self._meshes.put(request.mesh, request.file_type, _file(data)), None
            case protocol.PutSky():
                return await self._skies.put(request.sky, request.file_type, _file(data)), None
            case protocol.Cancel():
                return {}, None
            case protocol.Status():
                return self.status(), None
            case _:
                assert_never(request)

    def watch(self, key: bytes, subscribed: bool) -> None:
        """Somebody began or ceased to receive the frames of the session with these 16 bytes."""
        if subscribed and len(self._subscriptions) < SUBSCRIPTIONS:  # maybe before the session is opened
            self._subscriptions.add(key)
        elif not subscribed:
            self._subscriptions.discard(key)
        live = self._painter.pictures.get(key.hex())
        if live is None:
            return
        live.watched = subscribed
        self._touched[live.session.name] = time.monotonic()
        if subscribed:
            self._painter.show_again(live)

    async def report_motion(self) -> None:
        """Tell of every session that changes by itself, often, what another engine needs to go on; for ever."""
        async with asyncio.TaskGroup() as tasks:
            while True:
                for live in self._painter.pictures.values():
                    if live.session.name not in self._reporting and self._has_moved(live):
                        self._reporting.add(live.session.name)
                        tasks.create_task(self._report_motion(live))
                await asyncio.sleep(MOTION_SECONDS)

    def _has_moved(self, live: LivePicture) -> bool:
        session = live.session
        return session.asleep != live.told_asleep or self._told.get(session.name) != _numbers(session)

    async def _report_motion(self, live: LivePicture) -> None:
        session = live.session
        try:
            async with session.lock:  # or a step could be taken between the parts of the snapshot
                self._told[session.name] = _numbers(session)
                if session.asleep != live.told_asleep:
                    live.told_asleep = session.asleep
                    self._tell(session.report(edited=False))
                else:
                    self._tell(protocol.SessionMotion(session=session.name, moved=session.snapshot().moving_part()))
        finally:
            self._reporting.discard(session.name)

    def close_unwatched(self) -> None:
        """Forget the sessions that nobody watches."""
        for name in [name for name, live in self._painter.pictures.items() if not live.watched]:
            self._close(name)

    def status(self) -> dict[str, Any]:
        """Counters and device."""
        pictures = self._painter.pictures.values()
        return {
            "instance": self.instance,
            "uptime_seconds": time.monotonic() - self._started,
            "sessions": len(pictures),
            "sessions_watched": sum(live.watched for live in pictures),
            "sessions_moving": sum(live.watched and live.session.moving for live in pictures),
            "stills_waiting": len(self._stills),
            "meshes": len(self._meshes),
            "skies": len(self._skies),
            **vars(self._painter.counters),
            "memory_budget_bytes": self._memory.budget,
            **{f"memory_{kind}_bytes": size for kind, size in self._memory.held().items()},
            **self._pace(),
            **self._painter.durations.as_json(),
            "device": self._device,
        }

    def _pace(self) -> dict[str, Any]:
        """How far simulations that somebody watches are behind real time."""
        paces = [live.session.pace for live in self._painter.pictures.values()]
        moving = [live.session.pace for live in self._painter.pictures.values() if live.watched and live.session.moving]
        return {
            "simulated_seconds": self._closed_pace[0] + sum(pace.seconds for pace in paces),
            "simulated_seconds_dropped": self._closed_pace[1] + sum(pace.dropped for pace in paces),
            "sessions_slow": sum(pace.slow for pace in moving),
            "slowest_pace": min((pace.lately for pace in moving), default=1.0),
        }

    async def _open(self, request: protocol.OpenSession) -> dict[str, Any]:
        pictures = self._painter.pictures
        if request.session in pictures:  # asked again by a gateway that heard nothing for a while
            return described(self._live(request.session))
        scene = Scene.read(request.scene)
        snapshot = None if request.snapshot is None else Snapshot.read(request.snapshot)
        self._make_room()
        own = scene.environment if snapshot is None else snapshot.environment
        stone, sky = await asyncio.to_thread(self._made, scene, own)
        if request.session in pictures:  # opened twice at once
            return described(self._live(request.session))
        self._make_room()
        history = self._history
        if snapshot is None:
            session = Session(request.session, scene, stone, sky=sky, history=history)
        else:
            session = Session.restored(request.session, scene, stone, snapshot, sky=sky, history=history)
        if request.client is not None:
            self._clients[request.session] = request.client
        pictures[request.session] = LivePicture(session, watched=session.key in self._subscriptions)
        self._painter.wake()
        return described(self._live(request.session))

    def _described(self, live: LivePicture) -> dict[str, Any]:
        return described(live) | {"client": self._clients.get(live.session.name)}

    def _make_room(self) -> None:
        """For one more session; BusyError."""
        with self._memory.reserved("sessions", SESSION_BYTES, "a session"):
            pass
        pictures, now = self._painter.pictures, time.monotonic()
        if len(pictures) < self._limits.max_sessions:
            return
        idle = [name for name, live in pictures.items() if not live.watched]
        oldest = min(idle, key=lambda name: self._touched[name], default=None)
        if oldest is None or now - self._touched[oldest] < self._limits.engine_idle_seconds:
            raise BusyError(f"there are {self._limits.max_sessions} sessions already; close one, or try again later")
        self._close(oldest)

    def _named(self) -> set[str]:
        """The meshes and skies that sessions show, or would go back to, and that stills wait for."""
        named = set[str]()
        for live in self._painter.pictures.values():
            named |= names_in(live.session.shown.scene, live.session.sky.environment)
            if live.painted is not None:
                named |= names_in(live.painted.scene)
        for still in self._awaited:
            named |= names_in(still.scene)
        return named

    def _session_bytes(self) -> int:
        """Of open sessions, and of what only they and their stills hold of skies."""
        kept = {id(sky.pixels) for sky in self._skies.contents()}
        panoramas: dict[int, int] = {}
        size = 0
        for live in self._painter.pictures.values():
            size += SESSION_BYTES + len(live.message or b"")
            painted = live.painted.panorama if live.painted else None
            for panorama in (live.session.sky.panorama, painted):
                if panorama is not None:
                    panoramas[id(panorama)] = panorama.nbytes
        for still in self._awaited:
            if still.panorama is not None:
                panoramas[id(still.panorama)] = still.panorama.nbytes
        return size + sum(own for key, own in panoramas.items() if key not in kept)

    def _history_bytes(self) -> int:
        return SHOWN_BYTES * sum(live.session.remembered for live in self._painter.pictures.values())

    def _close(self, session: str) -> dict[str, Any]:
        pace = self._live(session).session.pace
        self._closed_pace = self._closed_pace[0] + pace.seconds, self._closed_pace[1] + pace.dropped
        del self._painter.pictures[session]
        del self._touched[session]
        self._told.pop(session, None)
        self._clients.pop(session, None)
        self._painter.wake()
        return {}

    async def _control(self, request: protocol.Control) -> dict[str, Any]:
        live = self._live(request.session)
        session = live.session
        apply = partial(events.apply, session, request.event, self._assets)
        try:
            async with session.lock:
                if request.event.type in LONG_EVENTS:
                    await asyncio.to_thread(apply)
                else:
                    apply()
                self._tell(session.report(edited=True))
        finally:
            self._painter.wake()
        return {"step": session.shown.step, "falling": session.falling}

    def _demand(self, request: protocol.Demand) -> dict[str, Any]:
        live = self._live(request.session)
        live.rate = request.frames_per_second
        live.size = self._size_within_memory(live, *live_size(request.width, request.height, self._limits))
        self._painter.wake()
        return {"width": live.size[0], "height": live.size[1]}

    def _size_within_memory(self, live: LivePicture, width: int, height: int) -> tuple[int, int]:
        """The size, or one of that shape whose picture takes no more than half of the memory that is free."""
        needed = picture_bytes(width, height)
        others = sum(picture_bytes(*other.size) for other in self._painter.pictures.values() if other is not live)
        held = self._memory.held()
        taken = sum(held.values()) - held.get("pictures", 0) + others
        room = max(0, self._memory.budget - taken) // 2
        if needed <= room:
            return width, height
        self._memory.make_room(2 * needed)
        scale = math.sqrt(max(room, picture_bytes(*LEAST_LIVE_SIZE)) / needed)
        return (width, height) if scale >= 1 else (max(1, int(width * scale)), max(1, int(height * scale)))

    def _make_room_for(self, still: Still) -> None:
        """BusyError if it does not fit besides what is held and what waits, of which no more pixels are begun at a time
        than a largest still has."""
        waiting = [other for other in self._awaited if other.picture is None]
        needed = sum(picture_bytes(other.width, other.height) for other in (*waiting, still))
        most = picture_bytes(self._limits.max_still_pixels, 1)
        needed = max(picture_bytes(still.width, still.height), min(needed, most))
        with self._memory.reserved("stills", needed, f"a still of {still.width} x {still.height}"):
            pass

    async def _render(self, request: protocol.Render) -> Answer:
        if (request.scene is None) == (request.session is None):
            raise InputError("expected either a scene or a session to render, got both or neither", "scene")
        scene, stone, panorama, default_size, step = await self._subject(request)
        width = default_size[0] if request.width is None else request.width
        height = default_size[1] if request.height is None else request.height
        check_still_size(width, height, self._limits)
        samples = scene.sampling.samples_per_pixel
        if request.session is not None:
            samples = max(samples, SESSION_STILL_SAMPLES)
        check_still_work(width, height, samples, scene.optics.bands, self._limits)
        still = Still(
            scene, stone, width, height, samples, request.format, panorama, request.client, time.monotonic()
        )  # fmt: skip
        await self._painter.make_ready(scene, stone)
        self._make_room_for(still)
        self._stills.put(still)
        self._awaited.add(still)
        self._painter.wake()
        try:
            data = await still.done
        finally:  # also where nobody waits for it any more
            self._awaited.discard(still)
            self._stills.remove(still)
            self._painter.wake()
        return {"width": width, "height": height, "samples": samples, "step": step, "format": request.format}, data

    async def _subject(
        self, request: protocol.Render
    ) -> tuple[Scene, Stone | None, Panorama | None, tuple[int, int], int | None]:
        if request.session is None:
            scene = Scene.read(request.scene)
            stone, sky = await asyncio.to_thread(self._made, scene, scene.environment)
            return scene, stone, sky.panorama, STILL_SIZE, None
        live = self._live(request.session)
        async with live.session.lock:
            past = live.session.recall(request.step)
            stone, panorama = await asyncio.to_thread(events.past_subject, past, live.session, self._assets)
        return past.scene, stone, panorama, live.size, past.step

    def _live(self, session: str) -> LivePicture:
        try:
            live = self._painter.pictures[session]
        except KeyError:
            raise NotFoundError(f"no session {session}") from None
        self._touched[session] = time.monotonic()
        return live

    def _made(self, scene: Scene, environment: Environment | None) -> tuple[Stone | None, Sky]:
        sky = events.own_sky(environment or scene.environment, self._assets)
        return events.stone_for(scene, None, self._assets), sky


def names_in(scene: Scene, *environments: Environment) -> set[str]:
    """What may be ids of uploads in a scene and in further skies."""
    named = {stone.mesh for stone in scene.stones if stone.mesh is not None}
    skies = (scene.environment, *environments)
    return named | {sky.image for sky in skies if isinstance(sky, ImageEnvironment)}


def history_length(limits: Limits, budget: int) -> int:
    """Shown states that each session may keep, so that all sessions' take HISTORY_SHARE of the memory at most."""
    return max(1, min(limits.max_shown_states, int(HISTORY_SHARE * budget) // (SHOWN_BYTES * limits.max_sessions)))


def picture_bytes(width: int, height: int) -> int:
    """Of a picture while it is rendered: two sums of four float32, and three bytes that are shown, for each pixel."""
    return 35 * width * height


def _numbers(session: Session) -> tuple[int, int]:
    """What changes whenever another engine would have to be told something."""
    return session.shown.step, session.sequence


def _file(data: Buffer | None) -> Buffer:
    if data is None:
        raise InputError("expected the file's bytes as the third part of the message, got none")
    return data


def described(live: LivePicture) -> dict[str, Any]:
    """A session as the gateway is told of it."""
    session = live.session
    return {
        "session": session.name,
        "scene": session.scene.model_dump(mode="json"),
        "falling": session.falling,
        "asleep": session.asleep,
        "exactness": session.balance.exactness,
        "pinned": session.balance.pinned,
        "watched": live.watched,
        "step": session.shown.step,
        "simulation_time": session.shown.simulation_time,
        "pose": session.pose(),
        "snapshot": session.snapshot().model_dump(mode="json"),
        "width": live.size[0],
        "height": live.size[1],
        "findings": list(session.stone.findings) if session.stone else [],
    }
