"""Vectors and matrices as tuples: what they are read from, and the linear system."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.values.vectors import determinant, numbers_in, numbers_of, product, solution

entries = st.floats(-2.0, 2.0)
rows = st.tuples(entries, entries, entries)


@given(st.tuples(rows, rows, rows), rows)
def test_products_determinants_and_solutions_are_those_of_numpy(
    matrix: tuple[tuple[float, float, float], ...], vector: tuple[float, float, float]
) -> None:
    """A solution only of a matrix that is far from singular."""
    first, second, third = matrix
    square = (first, second, third)
    assert product(square, *vector) == pytest.approx(np.array(square) @ vector, abs=1e-12)
    assert determinant(square) == pytest.approx(np.linalg.det(np.array(square)), abs=1e-9)
    if abs(determinant(square)) > 0.1:
        assert product(square, *solution(square, vector)) == pytest.approx(vector, abs=1e-9)


def test_numbers_of_a_shape_are_read() -> None:
    assert numbers_in("[1, 2.5]", (2,), "v") == (1.0, 2.5)
    assert numbers_in("[[1, 2], [3, 4]]", (2, 2), "m") == ((1.0, 2.0), (3.0, 4.0))


@pytest.mark.parametrize(
    "text",
    [
        "1",
        "[1]",
        "[1, true]",
        '["1", 2]',
        "[1, null]",
        "[[1], [2]]",
        "{}",
        "",
        "[1, 2",
        f"[{10**400}, 1]",
        "[" * 100000,
    ],
    ids=lambda text: text[:10],
)
def test_other_content_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match=r"v: expected 2 numbers in brackets|Expecting"):
        numbers_in(text, (2,), "v")


def test_a_value_that_is_no_list_is_refused() -> None:
    with pytest.raises(ValueError, match="m: expected 2 rows of 2 numbers"):
        numbers_of([1, 2], (2, 2), "m")
