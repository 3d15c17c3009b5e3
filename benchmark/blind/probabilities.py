"""Stated probabilities beside what came true: Brier's score, and shares by bins."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0)


def brier(stated: Sequence[tuple[float, bool]]) -> float | None:
    """Mean square of probability less outcome; None where none was stated."""
    return sum((probability - is_true) ** 2 for probability, is_true in stated) / len(stated) if stated else None


@dataclass(frozen=True, slots=True)
class Bin:
    """Probabilities from `low` up to `high`: their mean, and how many of them came true."""

    low: float
    high: float
    mean: float
    hits: int
    total: int


def reliability(stated: Sequence[tuple[float, bool]]) -> list[Bin]:
    """One bin for each part of BINS in which something was stated; the last one holds 1 too."""
    bins = []
    for low, high in pairwise(BINS):
        inside = [pair for pair in stated if low <= pair[0] < high or (high == BINS[-1] and pair[0] == high)]
        if inside:
            mean = sum(probability for probability, _ in inside) / len(inside)
            bins.append(Bin(low, high, mean, sum(is_true for _, is_true in inside), len(inside)))
    return bins
