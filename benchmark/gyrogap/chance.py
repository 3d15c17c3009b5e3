"""Figures of chance: Wilson's interval of a share, Brier's score and the reliability of stated probabilities."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import sqrt

NORMAL_95 = 1.959964
CALIBRATION_BINS = 10
BINS = (0.0, 0.2, 0.4, 0.6, 0.8, 0.9, 1.0)


def wilson(hits: int, total: int) -> tuple[float, float]:
    """95 % interval of the share behind `hits` of `total` (Wilson 1927); 0 to 1 where nothing was tried."""
    if total == 0:
        return 0.0, 1.0
    z2 = NORMAL_95**2
    share = hits / total
    middle = (share + z2 / (2.0 * total)) / (1.0 + z2 / total)
    half = NORMAL_95 / (1.0 + z2 / total) * sqrt(share * (1.0 - share) / total + z2 / (4.0 * total**2))
    return max(0.0, middle - half), min(1.0, middle + half)


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


def expected_calibration_error(stated: Sequence[tuple[float, bool]]) -> float:
    """Mean distance of stated probability and share of true outcomes, over ten equal bins (Guo et al. 2017)."""
    bins: dict[int, list[tuple[float, bool]]] = {}
    for probability, is_true in stated:
        bins.setdefault(min(int(probability * CALIBRATION_BINS), CALIBRATION_BINS - 1), []).append(
            (probability, is_true)
        )
    return sum(abs(sum(p - is_true for p, is_true in inside)) for inside in bins.values()) / len(stated)
