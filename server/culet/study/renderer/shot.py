"""The picture that a study is of."""

from __future__ import annotations

from typing import NamedTuple

from culet.stage import Stage


class Shot(NamedTuple):
    """A picture of what a study is of."""

    stage: Stage
    width: int
    height: int
