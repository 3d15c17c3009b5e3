"""Interval of true angles in which a recording rests, by its encoder count. Replayed motion must rest inside it."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.recording.order_statistics import median
from gyrodrift.values.arrays import Floats

ANGLES, REACH = 401, 1.5
"""Number of angles that are tried around a count, and the largest distance, in counts. Chosen: steps of 0.0075 counts,
over the count and a count on either side."""


class CountedRests(NamedTuple):
    """Rests of a recording.

    spans
        First and end sample of every rest.
    low_deg, high_deg
        (rests,) limits of the true angle.
    """

    spans: tuple[tuple[int, int], ...]
    low_deg: Floats
    high_deg: Floats

    def correction_deg(self, angle_deg: Floats) -> Floats:
        """(n,) change of a path, (n,), so that it rests within the limits; linear between rests.

        A Gaussian whose variance is that of a count puts one rest in twelve into the next count. Such a rest is
        mirrored at the limit, but at most to the middle. If it were moved to the limit only, it would rest on the edge
        of the count.
        """
        if not self.spans:
            return np.zeros_like(angle_deg)
        rest_deg = np.array([angle_deg[first:end].mean() for first, end in self.spans])
        above_deg, below_deg = (np.maximum(far, 0.0) for far in (rest_deg - self.high_deg, self.low_deg - rest_deg))
        most_deg = 0.5 * (self.high_deg - self.low_deg)
        change_deg = below_deg - above_deg + np.minimum(below_deg, most_deg) - np.minimum(above_deg, most_deg)
        ends = np.array(self.spans) - (0, 1)
        correction: Floats = np.interp(np.arange(len(angle_deg)), ends.ravel(), np.repeat(change_deg, 2))
        return correction


def counted_rests(
    spans: tuple[tuple[int, int], ...],
    encoder_deg: Floats,
    true_deg: Floats,
    read: Callable[[Floats], Floats],
    count_deg: float,
) -> CountedRests:
    """Limits of the true angle in every rest.

    spans
        First and end sample of every rest.
    encoder_deg
        (n,) angles that the encoder read.
    true_deg
        (n,) these angles without the errors of the encoder, apart from its counts.
    read
        Angles that the encoder reads at some true angles.
    count_deg
        Step of the encoder.
    """
    around_deg = np.linspace(-REACH, REACH, ANGLES) * count_deg
    low_deg, high_deg = np.empty(len(spans)), np.empty(len(spans))
    for rest, (first, end) in enumerate(spans):
        read_deg = median(encoder_deg[first:end])
        error_deg = np.abs(read(read_deg + around_deg) - read_deg)
        inside_deg = around_deg[error_deg < error_deg.min() + 1e-6]  # equal except for rounding of floats
        rest_deg = median(true_deg[first:end])
        low_deg[rest], high_deg[rest] = rest_deg + inside_deg[0], rest_deg + inside_deg[-1]
    return CountedRests(spans, low_deg, high_deg)
