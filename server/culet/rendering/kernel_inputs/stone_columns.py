"""What differs by stone as `stone_columns.cl` looks it up: columns of numbers by stone."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from culet.rendering.opencl.layout import constants

Array = NDArray[np.float64]

_PLACES = constants("parameters.cl")
MAX_STONES, COLUMNS, CHAIN_COLUMNS = (_PLACES[name] for name in ("MAX_STONES", "COLUMNS", "CHAIN_COLUMNS"))


def stone_columns(stones: NDArray[np.void], chains: NDArray[np.void], count: int) -> Array:
    """(COLUMNS + CHAIN_COLUMNS C, MAX_STONES) of rows of `stone_t`, each with C = `count` chains: the rows of `chains`
    (`chain_t`) from its `first_chain` on."""
    columns = np.zeros((COLUMNS + CHAIN_COLUMNS * count, MAX_STONES))
    own = columns[:, : len(stones)]
    for name in ("centre", "radius", "inverse_radius", "alike", "inner_axes", "absorption"):
        first, values = _PLACES[f"COLUMN_{name.upper()}"], stones[name].reshape(len(stones), -1).T
        own[first : first + len(values)] = values
    of_stones = chains[stones["first_chain"][:, None] + np.arange(count)]
    own[COLUMNS::CHAIN_COLUMNS], own[COLUMNS + 1 :: CHAIN_COLUMNS] = of_stones["eta"].T, of_stones["absorption"].T
    return columns
