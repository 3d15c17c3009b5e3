"""The linear model: effects that are linear in the rate error, by generalized least squares with a local level.

The mean rate error of each second is a sum of known regressors, white noise and a bias that is constant or a random
walk. The model uses neither simulator nor features, so it is an independent check.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from firmware_sim.effects.sensor_curve import FULL_SCALE_DPS
from gyrodrift.diagnose.features.block_means import integral_of, slopes
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.values.arrays import Floats
from gyrodrift.values.constants import NORMAL_MAD

GAINS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)
"""Gains of the filter, from a constant bias, 0, to a fast random walk."""

LEAST_DPS = 1e-6
"""Added to a spread, so that it is never 0."""

LEAST_VARIANCE = 1e-12
"""Least variance or norm in a division."""


class Whitened(NamedTuple):
    """Columns, (blocks, some), and values, (blocks,), of a session, in standard deviations of white noise."""

    columns: Floats
    values: Floats


class Fit(NamedTuple):
    """Gain in log likelihood, coefficient (for two columns their amplitude), and its standard error."""

    log_likelihood_gain: float
    coefficient: float
    error: float


def whitened(effects: Sequence[Floats], values: Floats) -> list[Whitened]:
    """Innovations of the columns of each effect, (blocks, 1 or 2), and of the values, (blocks,), in units of sigma.

    The gain of the filter is that with the smallest residual of a regression on all columns.
    """
    every = np.column_stack(effects)
    gain = min(
        GAINS, key=lambda gain: _mean_residual(innovations(gain, every), innovations(gain, values[:, None])[:, 0])
    )
    white = innovations(gain, values[:, None])[:, 0]
    sigma = NORMAL_MAD * float(np.median(np.abs(white - np.median(white)))) + LEAST_DPS
    return [Whitened(innovations(gain, columns) / sigma, white / sigma) for columns in effects]


def innovations(gain: float, columns: Floats) -> Floats:
    """Innovations of the local level model with this steady gain; a constant bias is subtracted as a mean."""
    if gain == 0.0:
        away: Floats = columns - columns.mean(axis=0)
        return away
    filtered: Floats = lfilter([1.0, -1.0], [1.0, gain - 1.0], columns - columns[0], axis=0)
    return filtered


def fit(sessions: Sequence[Whitened]) -> Fit:
    """Fit one coefficient, or a sine and a cosine, to all sessions; zeros if the columns hold no information."""
    columns = np.concatenate([session.columns for session in sessions])
    values = np.concatenate([session.values for session in sessions])
    information = columns.T @ columns
    if not np.all(np.isfinite(information)) or np.linalg.matrix_rank(information) < len(information):
        return Fit(0.0, 0.0, 0.0)
    coefficients = np.linalg.solve(information, columns.T @ values)
    before = float(values @ values)
    after = float(np.square(values - columns @ coefficients).sum())
    variance = max(after / len(values), LEAST_VARIANCE)
    error = float(np.sqrt(variance * np.linalg.inv(information)[0, 0]))
    amplitude = float(coefficients[0]) if len(coefficients) == 1 else float(np.hypot(*coefficients))
    return Fit(0.5 * len(values) * float(np.log(before / max(after, LEAST_VARIANCE))), amplitude, error)


def _mean_residual(columns: Floats, values: Floats) -> float:
    """Mean absolute residual of a regression on the columns."""
    scale = np.linalg.norm(columns, axis=0) + LEAST_VARIANCE
    unexplained = values - (columns / scale) @ np.linalg.lstsq(columns / scale, values, rcond=1e-9)[0]
    return float(np.mean(np.abs(unexplained)))


WARMUP_TAUS_S = (20.0, 60.0, 160.0, 450.0)
"""Time constants of a warm-up that are tried."""

CLEAR = 12.0
"""Gain in log likelihood from which on the linear model names an effect. Chosen, not derived."""


class Regressor(NamedTuple):
    """A linear effect: its parameter, the factor from coefficient to parameter, and (blocks, 1 or 2) columns."""

    effect: str
    parameter: str
    factor: float
    columns: Floats


@dataclass(frozen=True, slots=True)
class LinearModel:
    """The effect that the linear model names; None if it names none.

    value, low, high
        Size of its parameter, and the 95 % interval.
    agrees
        Whether the verdict names the effect too; None if no cause of the verdict is linear.
    """

    effect: str | None
    parameter: str
    value: float
    low: float
    high: float
    unit: str
    log_likelihood_gain: float
    agrees: bool | None
    says: str


def linear_model_of(
    residuals_dps: Sequence[Floats], designs: Sequence[DesignMatrix], causes: Sequence[NamedCause]
) -> LinearModel:
    """Fit every linear effect alone, and compare the best with the named causes.

    residuals_dps
        (blocks,) of each session: mean rate of each block minus that of the encoder.
    """
    regressors = [regressors_of(design) for design in designs]
    sessions = [
        whitened([regressor.columns for regressor in session], residual_dps)
        for session, residual_dps in zip(regressors, residuals_dps, strict=True)
    ]
    fits = [fit([session[number] for session in sessions]) for number in range(len(regressors[0]))]
    relevant = [_if_relevant(single, regressor) for single, regressor in zip(fits, regressors[0], strict=True)]
    best = int(np.argmax([candidate.log_likelihood_gain for candidate in relevant]))
    return _compared(relevant[best], regressors[0][best], {regressor.effect for regressor in regressors[0]}, causes)


def regressors_of(design: DesignMatrix) -> list[Regressor]:
    """Regressors of the linear effects, with their means over blocks."""
    motion, block = design.motion, design.block
    rate, turn = motion.rate_dps, np.deg2rad(motion.angle_deg)
    warm_c = motion.sensor_c - 25.0  # effects of temperature are 0 at 25 °C
    powered_s = np.arange(len(rate)) * motion.period_s + motion.powered_s
    cubic = 100.0 * FULL_SCALE_DPS**2

    def columns(*values: Floats) -> Floats:
        return np.column_stack(
            [slopes(integral_of(value, motion.period_s), motion.period_s, block) for value in values]
        )

    return [
        Regressor("scale_factor", "error_percent", 100.0, columns(rate)),
        Regressor("scale_asymmetry", "error_percent", 100.0, columns(np.abs(rate))),
        Regressor("vibration_rectification", "bias_dps_at_100_dps", 1e4, columns(rate**2)),
        Regressor("nonlinearity", "error_percent_fs", cubic, columns(rate**3)),
        Regressor("temp_bias", "slope_dps_per_c", 1.0, columns(warm_c)),
        Regressor("temp_scale", "slope_percent_per_c", 100.0, columns(warm_c * rate)),
        *(Regressor("warmup", "amplitude_dps", 1.0, columns(np.exp(-powered_s / tau_s))) for tau_s in WARMUP_TAUS_S),
        Regressor("g_sensitivity", "amplitude_dps", 1.0, columns(np.sin(turn), np.cos(turn))),
        Regressor(
            "encoder_eccentricity", "amplitude_deg", 180.0 / np.pi, columns(np.sin(turn) * rate, np.cos(turn) * rate)
        ),
    ]


def _if_relevant(result: Fit, regressor: Regressor) -> Fit:
    """The fit, or zeros if the effect is practically negligible."""
    return (
        result
        if abs(result.coefficient * regressor.factor) > (KINDS[regressor.effect].matters_from or 0.0)
        else Fit(0.0, 0.0, 0.0)
    )


def _compared(best: Fit, regressor: Regressor, judged: set[str], causes: Sequence[NamedCause]) -> LinearModel:
    """The best linear effect compared with the causes of the verdict; `judged` are the linear effects."""
    names = [cause.effect.name for cause in causes]
    cannot_judge = bool(names) and not judged & set(names)
    effect, gain = regressor.effect, best.log_likelihood_gain
    if gain < CLEAR:
        agrees = None if cannot_judge else not judged & set(names)
        says = "sees no linear effect" + ("" if agrees is not False else ", where the verdict names one")
        return LinearModel(None, "", 0.0, 0.0, 0.0, "", gain, agrees, says)
    # Two-sided 95 % of a normal number.
    value, spread = best.coefficient * regressor.factor, 1.96 * best.error * abs(regressor.factor)
    agrees = effect in {*names, *(name for cause in causes for name in cause.tied_with)}
    if agrees or not cannot_judge:
        says = f"{'agrees on' if agrees else 'disagrees: it would name'} {effect}"
    else:
        agrees, says = None, f"sees {effect}; cannot judge {', '.join(names)}"
    unit = unit_of(regressor.parameter)
    return LinearModel(effect, regressor.parameter, value, value - spread, value + spread, unit, gain, agrees, says)
