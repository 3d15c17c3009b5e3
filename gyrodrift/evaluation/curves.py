"""Yaw over time, thinned for the figures of reports."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.evaluation.dataset import LoadedSession
from gyrodrift.values.arrays import Floats


@dataclass(frozen=True, slots=True)
class YawCurves:
    """Times in minutes and reference in deg, shape (m,), and yaw of k methods in deg, shape (k, m)."""

    minutes: Floats
    reference_deg: Floats
    yaw_deg: Floats

    @property
    def errors_deg(self) -> Floats:
        """Yaw minus reference, deg, shape (k, m)."""
        return self.yaw_deg - self.reference_deg


def yaw_curves(loaded: LoadedSession, yaws_deg: Sequence[Floats], max_samples: int) -> YawCurves:
    """Yaws of a session, of shape (n,), thinned to at most `max_samples` samples."""
    rows = loaded.reference.thinned(max_samples)
    minutes = (loaded.t_s[rows] - loaded.t_s[0]) / 60.0
    return YawCurves(minutes, loaded.reference.reference_deg[rows], np.array([yaw_deg[rows] for yaw_deg in yaws_deg]))
