"""Figures of chance: Wilson's interval of a share, and the calibration error of stated probabilities."""

from collections.abc import Sequence
from math import sqrt

NORMAL_95 = 1.959964
CALIBRATION_BINS = 10


def wilson(hits: int, total: int) -> tuple[float, float]:
    """95 % interval of the share behind `hits` of `total` (Wilson 1927); 0 to 1 where nothing was tried."""
    if total == 0:
        return 0.0, 1.0
    z2 = NORMAL_95**2
    share = hits / total
    middle = (share + z2 / (2.0 * total)) / (1.0 + z2 / total)
    half = NORMAL_95 / (1.0 + z2 / total) * sqrt(share * (1.0 - share) / total + z2 / (4.0 * total**2))
    return max(0.0, middle - half), min(1.0, middle + half)


def expected_calibration_error(stated: Sequence[tuple[float, bool]]) -> float:
    """Mean distance of stated probability and share of true outcomes, over ten equal bins (Guo et al. 2017)."""
    bins: dict[int, list[tuple[float, bool]]] = {}
    for probability, is_true in stated:
        bins.setdefault(min(int(probability * CALIBRATION_BINS), CALIBRATION_BINS - 1), []).append(
            (probability, is_true)
        )
    return sum(abs(sum(p - is_true for p, is_true in inside)) for inside in bins.values()) / len(stated)
