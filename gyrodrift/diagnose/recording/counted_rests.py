"""In which count of the encoder a recording rests: an interval, out of which no motion of it may go."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats

PLACES, REACH = 401, 1.5
"""Angles that are tried about a count, and how far they reach, in counts."""


class CountedRests(NamedTuple):
    """The rests of a recording.

    spans
        First sample, and the one after the last, of each.
    low_deg, high_deg
        (rests,) the interval in which it stands.
    """

    spans: tuple[tuple[int, int], ...]
    low_deg: Floats
    high_deg: Floats

    def way_inside(self, angle_deg: Floats) -> Floats:
        """(n,) degrees by which a path has to be moved to rest in the counts that were seen; lines from rest to rest.

        A Gaussian as wide as a count puts one rest in twelve into the next one. The path is mirrored at the edge that
        it passed: were it cut off there, it would rest on the edge.
        """
        if not self.spans:
            return np.zeros_like(angle_deg)
        rest_deg = np.array([angle_deg[first:end].mean() for first, end in self.spans])
        above_deg, below_deg = (np.maximum(far, 0.0) for far in (rest_deg - self.high_deg, self.low_deg - rest_deg))
        most_deg = 0.5 * (self.high_deg - self.low_deg)
        way_deg = below_deg - above_deg + np.minimum(below_deg, most_deg) - np.minimum(above_deg, most_deg)
        ends = np.array(self.spans) - (0, 1)
        way: Floats = np.interp(np.arange(len(angle_deg)), ends.ravel(), np.repeat(way_deg, 2))
        return way


def counted_rests(
    spans: tuple[tuple[int, int], ...],
    encoder_deg: Floats,
    true_deg: Floats,
    read: Callable[[Floats], Floats],
    count_deg: float,
) -> CountedRests:
    """Of angles as they were read, and without what the encoder errs by beside its counts, shape (n,) each.

    read
        What the encoder reads at an angle.
    """
    about_deg = np.linspace(-REACH, REACH, PLACES) * count_deg
    low_deg, high_deg = np.empty(len(spans)), np.empty(len(spans))
    for rest, (first, end) in enumerate(spans):
        shown_deg = float(np.median(encoder_deg[first:end]))
        off_deg = np.abs(read(shown_deg + about_deg) - shown_deg)
        inside_deg = about_deg[off_deg < off_deg.min() + 1e-6]  # equal but for rounding
        here_deg = float(np.median(true_deg[first:end]))
        low_deg[rest], high_deg[rest] = here_deg + inside_deg[0], here_deg + inside_deg[-1]
    return CountedRests(spans, low_deg, high_deg)
