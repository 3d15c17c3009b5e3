"""Vectors and matrices as tuples: read from lists, and a linear system solved without numpy."""

import json
from typing import Any

Vector = tuple[float, float, float]
Matrix = tuple[Vector, Vector, Vector]
Numbers = tuple["float | Numbers", ...]


def numbers_in(text: str, shape: tuple[int, ...], name: str) -> Numbers:
    """Vector or matrix from its text in JSON.

    Raises
    ------
    ValueError
        As for `numbers_of`, or the text is not JSON.
    """
    try:
        return numbers_of(json.loads(text), shape, name)
    except RecursionError:
        raise ValueError(f"{name}: expected {shape_text(shape)}") from None


def numbers_of(value: Any, shape: tuple[int, ...], name: str) -> Numbers:
    """Vector or matrix from nested lists of numbers.

    Raises
    ------
    ValueError
        The lists do not have this shape, or have other content than numbers; the name is in the message.
    """
    return _nested(value, shape, f"{name}: expected {shape_text(shape)}")


def shape_text(shape: tuple[int, ...]) -> str:
    """Words for a shape."""
    return f"{shape[0]} numbers in brackets" if len(shape) == 1 else f"{shape[0]} rows of {shape[1]} numbers"


def _nested(value: Any, shape: tuple[int, ...], error: str) -> Numbers:
    if not isinstance(value, list | tuple) or len(value) != shape[0]:
        raise ValueError(error)
    if len(shape) > 1:
        return tuple(_nested(row, shape[1:], error) for row in value)
    if not all(isinstance(number, int | float) and not isinstance(number, bool) for number in value):
        raise ValueError(error)
    try:
        return tuple(map(float, value))
    except OverflowError:
        raise ValueError(error) from None


def product(matrix: Matrix, x: float, y: float, z: float) -> Vector:
    """Product of a matrix and a vector."""
    (a, b, c), (d, e, f), (g, h, i) = matrix
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def solution(matrix: Matrix, right: Vector) -> Vector:
    """Solution of a system of three linear equations, by the rule of Cramer."""
    columns = tuple(zip(*matrix, strict=True))
    whole = determinant(columns)
    x, y, z = (determinant((*columns[:index], right, *columns[index + 1 :])) / whole for index in range(3))
    return x, y, z


def determinant(columns: tuple[tuple[float, ...], ...]) -> float:
    """Determinant of a matrix from its columns, or from its rows."""
    (a, b, c), (d, e, f), (g, h, i) = columns
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
