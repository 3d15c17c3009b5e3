"""Estimators of a textbook on the columns of a session: for features, and for the tests of the generator."""

import numpy as np
from scipy.ndimage import gaussian_filter1d

from gyrogap.physics.bench import Columns
from gyrogap.physics.motion import Floats

SMOOTH_S = 0.02
REST_DPS = 0.3
HOLD, APART = 50, 150
"""Samples for which a direction is held before a reversal and after it, and how far apart the two lie."""


def period_s(columns: Columns) -> float:
    """Distance of two samples by the host's clock and the counter."""
    return float(np.polyfit(columns.seq, columns.t_host_s - columns.t_host_s[0], 1)[0])


def smooth_rates(columns: Columns) -> tuple[Floats, Floats, Floats]:
    """Rate of the gyro and of the encoder between samples, and acceleration by the encoder, all equally smoothed."""
    step_s = period_s(columns)
    wide = np.concatenate([columns.rate_dps[:1], columns.rate_dps, columns.rate_dps[-1:]])
    between_dps = (-wide[:-3] + 13.0 * wide[1:-2] + 13.0 * wide[2:-1] - wide[3:]) / 24.0
    rate_dps: Floats = gaussian_filter1d(between_dps, SMOOTH_S / step_s)
    encoder_dps: Floats = gaussian_filter1d(np.diff(columns.encoder_deg) / step_s, SMOOTH_S / step_s)
    return rate_dps, encoder_dps, np.gradient(encoder_dps, step_s)


def fit(columns: Columns) -> dict[str, float]:
    """Least squares of rate less encoder rate, on all that a static error or a lag can be."""
    rate_dps, encoder_dps, acceleration = smooth_rates(columns)
    turn = np.radians(columns.encoder_deg[1:] - 0.5 * np.diff(columns.encoder_deg))
    over_c = columns.temp_c[1:] - 25.0
    regressors = {
        "bias": np.ones(len(rate_dps)),
        "scale": encoder_dps,
        "asymmetry": np.abs(encoder_dps),
        "square": np.square(encoder_dps / 100.0),
        "lead_s": acceleration,
        "temp": over_c,
        "temp_scale": over_c * encoder_dps,
        "sine": np.sin(turn),
        "cosine": np.cos(turn),
        "sine_rate": np.sin(turn) * np.radians(encoder_dps),
        "cosine_rate": np.cos(turn) * np.radians(encoder_dps),
    }
    values = np.linalg.lstsq(np.column_stack(list(regressors.values())), rate_dps - encoder_dps, rcond=None)[0]
    return dict(zip(regressors, values.tolist(), strict=True))


def at_rest(columns: Columns) -> Floats:
    """The rate of the still from power-on."""
    _, encoder_dps, _ = smooth_rates(columns)
    return columns.rate_dps[: int(np.argmax(np.abs(encoder_dps) > REST_DPS)) - 20]


def clock_ppm(columns: Columns) -> float:
    """Device against host."""
    host_s = columns.t_host_s - columns.t_host_s[0]
    return float((np.polyfit(host_s, columns.t_device_s, 1)[0] - 1.0) * 1e6)


def stamp_sigma_ms(columns: Columns) -> float:
    """Scatter of stamps about even ones."""
    return float(np.std(np.diff(columns.t_device_s, 2)) / np.sqrt(6.0) * 1e3)


def dropped_percent(columns: Columns) -> float:
    """Share of lost samples by the counter."""
    return float(100.0 * (1.0 - len(columns.seq) / (columns.seq[-1] - columns.seq[0] + 1.0)))


def least_step_dps(columns: Columns) -> float:
    """Between different values."""
    return float(np.diff(np.unique(np.round(columns.rate_dps, 6))).min())


def counts_per_turn(columns: Columns) -> float:
    """Counts by the smallest distance of different angles."""
    return float(360.0 / np.diff(np.unique(np.round(columns.encoder_deg, 6))).min())


def largest_dps(columns: Columns) -> float:
    """Either way."""
    return float(np.abs(columns.rate_dps).max())


def moving_equal_percent(columns: Columns) -> float:
    """Neighbors that are equal while the rate changes fast."""
    _, _, acceleration = smooth_rates(columns)
    fast = np.abs(acceleration) > 300.0
    return float(100.0 * np.mean(np.diff(columns.rate_dps)[fast] == 0.0))


def play_deg(columns: Columns) -> float:
    """How far encoder and integrated rate part from before a reversal to after it."""
    step_s = period_s(columns)
    rate_dps = columns.rate_dps - np.median(at_rest(columns))
    off_deg = columns.encoder_deg[1:] - np.cumsum(rate_dps[1:] + rate_dps[:-1]) * step_s / 2.0
    ways = np.where(np.abs(rate_dps) > 4.0, np.sign(rate_dps), 0.0)[1:]
    direction = np.convolve(ways, np.ones(HOLD), "valid") / HOLD
    mean_deg = np.convolve(off_deg, np.ones(HOLD), "valid") / HOLD
    is_reversal = direction[APART:] * direction[:-APART] == -1.0
    moved_deg = direction[APART:] * (mean_deg[APART:] - mean_deg[:-APART])
    return -float(np.median(moved_deg[is_reversal]))


def allan_dps(rate_dps: Floats, points: int) -> float:
    """Allan deviation of means of so many samples."""
    means = rate_dps[: len(rate_dps) // points * points].reshape(-1, points).mean(axis=1)
    return float(np.sqrt(0.5 * np.mean(np.square(np.diff(means)))))
