"""Small linear systems in plain floats: the same bits on every machine, which LAPACK does not promise."""

from __future__ import annotations

Matrix = list[list[float]]


def inverse(matrix: Matrix) -> Matrix | None:
    """By Gauss and Jordan with partial pivoting; None if the matrix is singular."""
    size = len(matrix)
    rows = [[*row, *(1.0 if i == j else 0.0 for j in range(size))] for i, row in enumerate(matrix)]
    for column in range(size):
        pivot = max(range(column, size), key=lambda i: abs(rows[i][column]))
        head = rows[pivot]
        if not abs(head[column]) > 0:
            return None
        rows[pivot] = rows[column]
        scale = 1 / head[column]
        rows[column] = head = [value * scale for value in head]
        for i in range(size):
            factor = rows[i][column]
            if i != column and factor != 0:
                rows[i] = [value - factor * other for value, other in zip(rows[i], head, strict=True)]
    return [row[size:] for row in rows]


def times(matrix: Matrix, vector: list[float]) -> list[float]:
    """Matrix times vector."""
    return [sum([a * b for a, b in zip(row, vector, strict=True)]) for row in matrix]
