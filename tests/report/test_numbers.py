"""Numbers for a person: as many digits as help, and no exponent where it can be read without."""

from math import inf, isnan, nan

import pytest

from gyrodrift.report.numbers import degrees, even, factor_label, mean, significant


@pytest.mark.parametrize(
    ("values", "expected"),
    [
        ([137.0291, 2.078, 29.6], ["137.0", "2.1", "29.6"]),
        ([0.0089, 0.0388, 0.0429], ["0.0089", "0.0388", "0.0429"]),
        ([0.0], ["0.00"]),
        ([inf, 2.0], ["∞", "2.00"]),
        ([nan, 1234.5], ["–", "1234"]),
        ([1e8], ["100000000"]),
        ([1e300], ["1e+300"]),
    ],
)
def test_numbers_of_a_column_have_equally_many_decimals(values: list[float], expected: list[str]) -> None:
    assert even(values) == expected


@pytest.mark.parametrize(
    ("value", "digits", "expected"),
    [
        (1e-6, 4, "0.000001"),
        (0.00045678, 4, "0.0004568"),
        (6877.0, 4, "6877"),
        (123456.0, 4, "123500"),
        (2.5e-9, 3, "2.5e-09"),
        (0.0, 4, "0"),
        (inf, 4, "∞"),
        (nan, 4, "–"),
    ],
)
def test_a_number_has_the_digits_that_are_asked_for(value: float, digits: int, expected: str) -> None:
    assert significant(value, digits) == expected


def test_an_angle_has_three_digits() -> None:
    assert [degrees(value) for value in (56.4321, 0.5, -0.01234, inf)] == ["56.4°", "0.500°", "-0.0123°", "∞°"]


def test_the_mean_of_nothing_is_no_number() -> None:
    assert mean([1.0, 2.0]) == 1.5
    assert isnan(mean([]))


@pytest.mark.parametrize(
    ("value", "label"), [(100.0, "100"), (0.01, "0.01"), (1e6, "10⁶"), (1e-6, "10⁻⁶"), (2e4, "2·10⁴"), (0.0, "0")]
)
def test_labels_of_factors_can_be_read(value: float, label: str) -> None:
    assert factor_label(value) == label
