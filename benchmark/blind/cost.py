"""Yaw error that faults cost, without that of a steady bias, which is calibrated."""

from dataclasses import replace

import numpy as np
from gyrogap.physics.bench import Columns
from gyrogap.physics.motion import Floats
from gyrogap.physics.write import SessionBatch


def yaw_cost_deg(batch: SessionBatch) -> float:
    """Mean absolute yaw that its faults add to or take from its sessions, beside the same sessions without them."""
    without = replace(batch, faults=())
    costs = [_cost_deg(batch.columns(number), without.columns(number)) for number in range(len(batch.plans))]
    return float(np.mean(costs))


def _cost_deg(seen: Columns, without: Columns) -> float:
    _, rows, others = np.intersect1d(seen.seq, without.seq, return_indices=True)
    away_deg = _yaw_error_deg(seen)[rows] - _yaw_error_deg(without)[others]
    t_s = without.t_device_s[others]
    return float(np.abs(away_deg - np.polyval(np.polyfit(t_s, away_deg, 1), t_s)).mean())


def _yaw_error_deg(columns: Columns) -> Floats:
    """Integrated rate less what the encoder says, at each row."""
    steps_s = np.diff(columns.t_device_s, prepend=columns.t_device_s[0])
    away_deg: Floats = np.cumsum(columns.rate_dps * steps_s) - columns.encoder_deg
    return away_deg
