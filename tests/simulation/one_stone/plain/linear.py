"""Small linear systems in plain floats: the same bits on every machine, which LAPACK does not promise."""

from __future__ import annotations

from typing import NamedTuple

Matrix = list[list[float]]


class Factors(NamedTuple):
    """Of a square matrix, its rows exchanged: a lower triangle with ones on its diagonal, times an upper one."""

    rows: Matrix
    """The lower triangle left of the diagonal, the upper one on it and right of it."""
    order: list[int]
    """Which row of the matrix each row was."""


def factorised(matrix: Matrix) -> Factors | None:
    """By Gauss with partial pivoting; None if the matrix is singular."""
    size = len(matrix)
    rows, order = [row[:] for row in matrix], list(range(size))
    for column in range(size):
        pivot = max(range(column, size), key=lambda i: abs(rows[i][column]))
        rows[column], rows[pivot] = rows[pivot], rows[column]
        order[column], order[pivot] = order[pivot], order[column]
        head = rows[column]
        if not abs(head[column]) > 0:
            return None
        scale, rest = 1 / head[column], range(column + 1, size)
        for i in rest:
            row = rows[i]
            factor = row[column] = row[column] * scale
            if factor != 0:
                for j in rest:
                    row[j] -= factor * head[j]
    return Factors(rows, order)


def solution(factors: Factors, right: list[float]) -> list[float]:
    """x with matrix x = right."""
    rows, size = factors.rows, len(right)
    x = [right[i] for i in factors.order]
    for i in range(1, size):
        row, value = rows[i], x[i]
        for j in range(i):
            value -= row[j] * x[j]
        x[i] = value
    for i in range(size - 1, -1, -1):
        row, value = rows[i], x[i]
        for j in range(i + 1, size):
            value -= row[j] * x[j]
        x[i] = value / row[i]
    return x
