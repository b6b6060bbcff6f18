"""Stills: pictures asked for once, at full quality, rendered in pieces between live frames."""

from __future__ import annotations

import asyncio
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from culet.engine.painting.renderer import PIECE_SECONDS, AnyPicture, AnyRenderer
from culet.engine.painting.shares import Account, Shares
from culet.errors import BusyError
from culet.rendering.film.target import Target
from culet.scene import Scene
from culet.stage import Stage
from culet_protocol.engine import Format

if TYPE_CHECKING:
    from culet.legend import Line

EncodeStill = Callable[[AnyPicture, str, Sequence["Line"]], bytes]
"""A still that is rendered, its format, and the lines of its legend, as a file."""

STILLS_WEIGHT = 0.5
"""Share of the render thread's time for all stills together beside a picture that moves."""

LINEAR_FORMATS = frozenset({"exr"})
"""Of radiance, which is not tone-mapped."""

SMALL_PART = 0.25
"""Of the largest still's pixels, that smaller ones may have together beside it: they need not wait for its end."""


@dataclass(eq=False)
class Still:
    """A picture that somebody waits for."""

    stage: Stage
    width: int
    height: int
    target: Target
    format: Format
    client: str = ""
    """On whose behalf."""
    part: float = 1.0
    """Of the time that a still may take, which this one may."""
    legend: Sequence[Line] = ()
    """For a corner of the picture."""
    asked_at: float = 0.0
    """s, steady clock."""
    done: asyncio.Future[bytes] = field(default_factory=lambda: asyncio.get_running_loop().create_future())
    picture: AnyPicture | None = None
    pieces: Iterator[object] | None = None
    rendered: bool = False
    """It is only to be encoded, which is no work of the render thread."""
    spent: float = 0.0
    """s of the render thread so far."""
    out_of_time: bool = False
    """It is left as it is after the sample under way, though its target is not reached."""

    @property
    def pictures(self) -> int:
        """That are made for it."""
        return pictures_of(self.stage.scene)

    @property
    def pixels(self) -> int:
        """Of all its pictures."""
        return self.width * self.height * self.pictures

    def paint(self, renderer: AnyRenderer) -> Iterator[object]:
        """Render, yielding between pieces of work. Runs in the render thread."""
        make = renderer.picture if self.pictures == 1 else renderer.cut_out
        picture = make(self.stage, self.width, self.height)
        self.picture = picture
        yield from picture.refine_until(self.target, PIECE_SECONDS, pause=lambda: self.out_of_time)
        if self.format not in LINEAR_FORMATS:
            yield from picture.develop_in_pieces()


def pictures_of(scene: Scene) -> int:
    """That a still of a scene is made of: one without its backdrop of two."""
    return 2 if scene.film.cut_out else 1


class StillQueue:
    """Clients take turns, by the time that theirs have had; of one client first come, first served.

    Those that are begun keep their sums, 32 bytes a pixel: together they have no more pixels than a largest one and
    SMALL_PART of it.
    """

    def __init__(self, limit: int, most_pixels: int) -> None:
        """At most `limit` stills, of at most `most_pixels` each. One client has at most half of the places."""
        self.account = Account(self, STILLS_WEIGHT)
        self.served_at = -1e9
        """s, steady clock."""
        self._limit = limit
        self._own_limit = max(1, limit // 2)
        self._most_pixels = most_pixels * (1 + SMALL_PART)
        self._stills: list[Still] = []
        self._accounts: dict[str, Account] = {}
        """Of the clients whose stills wait."""
        self._shares = Shares()

    def __len__(self) -> int:
        self._drop_abandoned()
        return len(self._stills)

    def put(self, still: Still) -> None:
        """Queue a still, or BusyError."""
        self._drop_abandoned()
        own = Counter(waiting.client for waiting in self._stills)[still.client]
        if len(self._stills) >= self._limit:
            raise BusyError(f"{self._limit} stills are waiting already; try again later")
        if still.client and own >= self._own_limit:
            raise BusyError(f"{own} stills of yours are waiting already, of {self._limit} in all; try again later")
        self._stills.append(still)
        self._accounts.setdefault(still.client, Account(still.client))

    def next(self) -> Still | None:
        """The still that is to be worked on."""
        self._drop_abandoned()
        begun = sum(still.pixels for still in self._stills if still.pieces is not None)
        firsts: dict[str, Still] = {}
        for still in self._stills:
            if not still.rendered:
                firsts.setdefault(still.client, still)
        candidates = [
            still for still in firsts.values() if still.pieces is not None or begun + still.pixels <= self._most_pixels
        ]
        return min(candidates, key=lambda still: self._shares.start(self._accounts[still.client]), default=None)

    def charge(self, still: Still, seconds: float, now: float) -> None:
        """A still was worked on for so long."""
        still.spent += seconds
        self.served_at = now
        if still.client in self._accounts:
            self._shares.charge(self._accounts[still.client], seconds, now)

    def remove(self, still: Still) -> None:
        """The still is done, or failed."""
        if still in self._stills:
            self._stills.remove(still)
        self._forget_clients()

    def _drop_abandoned(self) -> None:
        if any(still.done.done() for still in self._stills):
            self._stills = [still for still in self._stills if not still.done.done()]
            self._forget_clients()

    def _forget_clients(self) -> None:
        """Forget clients that wait for nothing. A client that has had more than others is remembered while the others
        wait, or it could begin anew with every still."""
        waiting = {still.client for still in self._stills}
        self._accounts = {
            client: account
            for client, account in self._accounts.items()
            if client in waiting or (waiting and not self._shares.is_due(account))
        }
