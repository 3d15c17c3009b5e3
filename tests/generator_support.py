"""For the tests of the generator: further estimators of a textbook, and a device with its sessions."""

from collections.abc import Callable

import numpy as np
from gyrogap.estimators import at_rest, fit, period_s
from gyrogap.physics.bench import Columns
from gyrogap.physics.device import DrawnDevice
from gyrogap.physics.dice import Path, plan_dice
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.motion import Floats
from gyrogap.physics.sessions import plan_sessions
from gyrogap.physics.write import SessionBatch

COUNT_DPS = 0.00763
NOISE_DPS_RTHZ = 0.0035
SAMPLE_HZ = 99.7
COUNTS = 36000


def plain_batch(*effects: InjectedEffect, seed: int = 5) -> SessionBatch:
    """Five sessions of six to eight minutes of a device of 99.7 Hz, with these effects."""
    path: Path = ("plain", seed)
    rng = plan_dice(path)
    plans = tuple(plan_sessions(rng, 5, (6.0, 8.0)))
    device = DrawnDevice(
        sample_hz=SAMPLE_HZ,
        dps_per_lsb=COUNT_DPS,
        noise_dps_rthz=NOISE_DPS_RTHZ,
        bias_dps=tuple(rng.normal(0.0, 0.3, len(plans)).tolist()),
        encoder_cpr=COUNTS,
        host_delay_s=rng.uniform(0.001, 0.008),
        host_scatter_s=rng.uniform(0.00003, 0.00015),
        stamp_scatter_s=2e-6,
        clock_ppm=rng.uniform(-3.0, 3.0),
    )
    return SessionBatch(device, plans, effects, path)


def of_fit(name: str, factor: float = 1.0) -> Callable[[Columns], float]:
    """One of the coefficients."""
    return lambda columns: factor * fit(columns)[name]


def amplitude(sine: str, cosine: str) -> Callable[[Columns], float]:
    """Amplitude of a sine of unknown phase."""

    def estimate(columns: Columns) -> float:
        fitted = fit(columns)
        return float(np.hypot(fitted[sine], fitted[cosine]))

    return estimate


def arrival_spread_ms(columns: Columns) -> float:
    """From the soonest to the latest arrival, against even ones."""
    late_s = columns.t_host_s - columns.t_host_s[0] - columns.seq * period_s(columns)
    return float(np.ptp(late_s) * 1e3)


def zero_width_dps(columns: Columns) -> float:
    """The smallest output that is not zero."""
    return float(np.abs(columns.rate_dps[columns.rate_dps != 0.0]).min())


def tone_dps(frequency_hz: float) -> Callable[[Columns], float]:
    """Amplitude at a frequency, at rest; above half the sample rate it is looked for where it folds to."""

    def estimate(columns: Columns) -> float:
        rate_dps = at_rest(columns)
        t_s = np.arange(len(rate_dps)) * period_s(columns)
        wave = np.exp(-2j * np.pi * frequency_hz * t_s)
        return float(2.0 * np.abs(np.mean((rate_dps - rate_dps.mean()) * wave)))

    return estimate


def slips_deg(columns: Columns) -> Floats:
    """Jumps of the encoder that the rate knows nothing of."""
    off_deg = np.diff(columns.encoder_deg) - columns.rate_dps[1:] * period_s(columns)
    return off_deg[np.abs(off_deg) > 0.15]
