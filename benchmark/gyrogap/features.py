"""Features of a session by plain estimators, to compare sessions of the same motion."""

import warnings
from collections.abc import Callable, Mapping
from functools import partial

import numpy as np

from gyrogap import estimators
from gyrogap.physics.bench import Columns
from gyrogap.physics.motion import Floats

ALLAN_S = (1.0, 5.0)
TINY = 1e-9
"""Added before a logarithm."""

OUTLIER_SIGMAS = 6.0
"""Distance from the median, in robust standard deviations, beyond which a residual counts as an outlier."""


LOGARITHMS = (
    "residual",
    "residual_tail",
    "roughness",
    "largest_jump",
    "encoder_jump",
    "allan_1",
    "allan_5",
    "stamps",
    "arrivals",
    "step",
    "counts",
    "line",
)
RESOLUTION = dict.fromkeys(LOGARITHMS, 0.02) | {"repeated": 0.05, "dropped": 0.02, "zeros": 5e-4, "outliers": 5e-4}
"""Difference of a feature that does not count, where its scatter is smaller: 2 %, and a few samples. Chosen."""

FINEST = 1e-6
"""Resolution of all other features."""


def resolution_of(name: str) -> float:
    """Smallest scatter of a feature."""
    return RESOLUTION.get(name, FINEST)


def features_of(columns: Columns) -> dict[str, float]:
    """Features of a session by name; a session that is too odd for an estimator has fewer of them."""
    features = dict(_fitted(columns))
    for name, estimate in _ESTIMATES.items():
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)  # no rest or no reversal: not a number
            value = estimate(columns)
        if np.isfinite(value):
            features[name] = value
    if columns.axes is not None:
        features |= _axis_features(columns)
    return features


def _log(estimate: Callable[[Columns], float], columns: Columns) -> float:
    return float(np.log(abs(estimate(columns)) + TINY))


def _fitted(columns: Columns) -> Mapping[str, float]:
    """Coefficients of rate less encoder rate, and what they leave: its spread, outliers and slow parts."""
    rate_dps, encoder_dps, _ = estimators.smooth_rates(columns)
    fitted = estimators.fit(columns)
    residual = rate_dps - encoder_dps - fitted["bias"] - fitted["scale"] * encoder_dps
    residual = residual - np.median(residual)
    spread = 1.4826 * float(np.median(np.abs(residual))) + TINY
    jumps = np.abs(np.diff(columns.rate_dps, 2))
    return {
        **{name: value for name, value in fitted.items() if name != "bias"},
        "residual": float(np.log(spread)),
        "residual_tail": float(np.log(np.std(residual) / spread + TINY)),
        "outliers": float(np.mean(np.abs(residual) > OUTLIER_SIGMAS * spread)),
        "roughness": float(np.log(np.mean(jumps) + TINY)),
        "largest_jump": float(np.log(jumps.max() + TINY)),
        "encoder_jump": float(np.log(np.abs(np.diff(columns.encoder_deg, 2)).max() + TINY)),
        **_slow(rate_dps - encoder_dps * (1.0 + fitted["scale"]), estimators.period_s(columns)),
    }


def _slow(bias_dps: Floats, period_s: float) -> dict[str, float]:
    """Bias in eight parts of the session against its mean, and its Allan deviation."""
    parts = [float(part.mean()) for part in np.array_split(bias_dps, 8)]
    allan = {f"allan_{tau_s:g}": _allan(bias_dps, max(1, round(tau_s / period_s))) for tau_s in ALLAN_S}
    return {f"part_{number}": part - float(np.mean(parts)) for number, part in enumerate(parts)} | allan


def _allan(bias_dps: Floats, samples: int) -> float:
    return float(np.log(estimators.allan_dps(bias_dps, samples) + TINY))


def _at_rest_line(columns: Columns) -> float:
    """Highest line of the spectrum of the rest, against its median, as a logarithm."""
    rate_dps = estimators.at_rest(columns)
    if len(rate_dps) < 64:
        return float("nan")
    spectrum = np.abs(np.fft.rfft(rate_dps - rate_dps.mean()))[1:]
    return float(np.log(spectrum.max() / (np.median(spectrum) + TINY) + TINY))


def _zero_share(columns: Columns) -> float:
    return float(np.mean(columns.rate_dps == 0.0))


def _play_deg(columns: Columns) -> float:
    return estimators.play_deg(columns) if np.ptp(columns.rate_dps) > 10.0 else float("nan")


def _host_delay_spread(columns: Columns) -> float:
    late_s = columns.t_host_s - columns.t_host_s[0] - (columns.seq - columns.seq[0]) * estimators.period_s(columns)
    return float(np.log(np.std(late_s) + TINY))


_ESTIMATES: Mapping[str, Callable[[Columns], float]] = {
    "clock": estimators.clock_ppm,
    "stamps": partial(_log, estimators.stamp_sigma_ms),
    "arrivals": _host_delay_spread,
    "dropped": estimators.dropped_percent,
    "step": partial(_log, estimators.least_step_dps),
    "counts": partial(_log, estimators.counts_per_turn),
    "largest": estimators.largest_dps,
    "zeros": _zero_share,
    "repeated": estimators.moving_equal_percent,
    "play": _play_deg,
    "line": _at_rest_line,
}


def _axis_features(columns: Columns) -> dict[str, float]:
    """Shares of the turn on x and y, means of the accelerometer, and the size of its force."""
    axes = columns.axes
    if axes is None:
        return {}
    rate_dps = np.gradient(columns.encoder_deg) / estimators.period_s(columns)
    design = np.column_stack([rate_dps, np.ones(len(rate_dps))])
    turn = np.linalg.lstsq(design, axes.gyro_dps[:, :2], rcond=None)[0][0]
    force = axes.accel_mps2.mean(axis=0)
    return {
        "turn_x": float(turn[0]),
        "turn_y": float(turn[1]),
        "force_x": float(force[0]),
        "force_y": float(force[1]),
        "force": float(np.linalg.norm(force)),
    }
