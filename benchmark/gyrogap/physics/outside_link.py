"""Outside the catalogue: encoders that err otherwise, clocks that jump, links that disorder."""

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats
from gyrogap.physics.scene import TableScene, later


def encoder_harmonic(
    values: Floats, scene: TableScene, rng: Rng, *, amplitude_deg: float, order: float, phase_deg: float
) -> Floats:
    """An oval disc: the angle errs several times per turn; on the fine grid."""
    return values + amplitude_deg * np.sin(np.radians(order * scene.fine_deg + phase_deg))


def encoder_delay(values: Floats, scene: TableScene, rng: Rng, *, delay_ms: float) -> Floats:
    """The encoder is read late, so that the rate seems to lead; on the fine grid."""
    return later(values, delay_ms * 1e-3 * scene.fine_hz)


def clock_steps(values: Floats, scene: TableScene, rng: Rng, *, step_ms: float, count: float) -> Floats:
    """The device clock is set forward now and then."""
    at_s = np.sort(rng.uniform(0.1, 0.9, int(count))) * scene.t_s[-1]
    return values + step_ms * 1e-3 * np.searchsorted(at_s, scene.t_s)


def host_wander(values: Floats, scene: TableScene, rng: Rng, *, amplitude_ms: float, period_s: float) -> Floats:
    """The host's clock is pulled to and fro by a time server."""
    swing = np.sin(2.0 * np.pi * scene.t_s / period_s + rng.uniform(0.0, 6.28))
    return values + amplitude_ms * 1e-3 * swing


def swapped_rows(values: Floats, scene: TableScene, rng: Rng, *, share_percent: float) -> Floats:
    """Two neighbors come in the wrong order; on the rows."""
    rows = values.copy()
    firsts = np.flatnonzero(rng.random(len(rows) // 2) < share_percent / 100.0) * 2
    rows[firsts], rows[firsts + 1] = values[firsts + 1], values[firsts]
    return rows


def doubled_rows(values: Floats, scene: TableScene, rng: Rng, *, share_percent: float) -> Floats:
    """A sample comes twice; on the rows."""
    rows: Floats = np.repeat(values, 1 + (rng.random(len(values)) < share_percent / 100.0))
    return rows
