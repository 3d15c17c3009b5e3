"""Yaw over time, thinned for the figures of reports."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.dataset import LoadedSession


@dataclass(frozen=True, slots=True)
class YawCurves:
    """Minutes and reference in deg, shape (m,), and yaw in deg by several methods in their order, shape (k, m)."""

    minutes: Floats
    reference_deg: Floats
    yaw_deg: Floats

    @property
    def errors_deg(self) -> Floats:
        """Yaw less the reference, deg, shape (k, m)."""
        return self.yaw_deg - self.reference_deg


def yaw_curves(loaded: LoadedSession, yaws_deg: Sequence[Floats], points: int) -> YawCurves:
    """Yaws of a session, each of shape (n,), thinned to at most `points` points."""
    rows = loaded.reference.thinned(points)
    minutes = (loaded.t_s[rows] - loaded.t_s[0]) / 60.0
    return YawCurves(minutes, loaded.reference.reference_deg[rows], np.array([yaw_deg[rows] for yaw_deg in yaws_deg]))
