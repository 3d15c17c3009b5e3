"""A second opinion where theory is exact: effects that are linear in the rate error, under a bias that may walk.

The mean rate error of each second is a sum of known regressors, white noise and a bias that is constant or a random
walk. Its steady Kalman filter is a whitening filter of one pole (the local level model; A. C. Harvey, Forecasting,
Structural Time Series Models and the Kalman Filter, 1989, chapter 4), which makes generalised least squares ordinary.
Nothing of the simulator, the features or their scores is used.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.signal import lfilter

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.block_residuals import block_residual_dps
from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.inference.verdict import Verdict, unit_of
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.twin import Subject

GAINS = (0.0, 0.003, 0.01, 0.03, 0.1, 0.3)
"""Of the filter: how fast the bias is believed to walk; 0 is a constant one."""

WARMUP_TAUS_S = (20.0, 60.0, 160.0, 450.0)
CLEAR = 12.0
"""Of the logarithm of the likelihood: what an effect has to add."""

Regressors = list[tuple[str, str, float, tuple[Floats, ...]]]
"""Effect, parameter, from the coefficient to the parameter, and its one or two columns."""


@dataclass(frozen=True, slots=True)
class SecondOpinion:
    """The effect that a likelihood by itself would name; None where it sees none.

    value, low, high
        Of its parameter, with 95 %.
    agrees
        Whether the verdict names it too; None where it cannot judge the causes of the verdict.
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


def second_opinion(subjects: Sequence[Subject], verdict: Verdict) -> SecondOpinion:
    """Ask for one."""
    whitened = [_whitened(subject) for subject in subjects]
    fits = [_fit([session[number] for session in whitened]) for number in range(len(whitened[0]))]
    names = [(effect, parameter, factor) for effect, parameter, factor, _ in _regressors(subjects[0].design)]
    sizes = [abs(coefficient * factor) for (_, coefficient, _), (_, _, factor) in zip(fits, names, strict=True)]
    matters = [size > (KINDS[effect].matters_from or 0.0) for size, (effect, _, _) in zip(sizes, names, strict=True)]
    best = int(np.argmax([fit[0] if matter else 0.0 for fit, matter in zip(fits, matters, strict=True)]))
    gain, coefficient, error = fits[best] if matters[best] else (0.0, 0.0, 0.0)
    effect, parameter, factor = names[best]
    causes = [cause.effect.name for cause in verdict.causes]
    judged = {name for name, _, _ in names}
    if gain < CLEAR:
        agrees = None if causes and not judged & set(causes) else not judged & set(causes)
        says = "sees no linear effect" + ("" if agrees is not False else ", where the verdict names one")
        return SecondOpinion(None, "", 0.0, 0.0, 0.0, "", gain, agrees, says)
    value, spread = coefficient * factor, 1.96 * error * abs(factor)
    agrees = effect in {*causes, *(name for cause in verdict.causes for name in cause.tied_with)}
    if not agrees and causes and not judged & set(causes):
        says = f"sees {effect}; of {', '.join(causes)} it cannot judge"
        return SecondOpinion(
            effect, parameter, value, value - spread, value + spread, unit_of(parameter), gain, None, says
        )
    says = f"{'agrees on' if agrees else 'disagrees: it would name'} {effect}"
    return SecondOpinion(
        effect, parameter, value, value - spread, value + spread, unit_of(parameter), gain, agrees, says
    )


def _regressors(design: DesignMatrix) -> Regressors:
    """Of the linear effects, block by block."""
    motion, block = design.motion, design.block
    rate, turn = motion.rate_dps, np.deg2rad(motion.angle_deg)
    warm_c = motion.sensor_c - 25.0
    powered_s = np.arange(len(rate)) * motion.period_s + motion.powered_s

    def column(values: Floats) -> Floats:
        return block_means(values, block)

    return [
        ("scale_factor", "error_percent", 100.0, (column(rate),)),
        ("scale_asymmetry", "error_percent", 100.0, (column(np.abs(rate)),)),
        ("vibration_rectification", "bias_dps_at_100_dps", 1e4, (column(rate**2),)),
        ("nonlinearity", "error_percent_fs", 100.0 * 250.0**2, (column(rate**3),)),
        ("temp_bias", "slope_dps_per_c", 1.0, (column(warm_c),)),
        ("temp_scale", "slope_percent_per_c", 100.0, (column(warm_c * rate),)),
        *(("warmup", "amplitude_dps", 1.0, (column(np.exp(-powered_s / tau_s)),)) for tau_s in WARMUP_TAUS_S),
        ("g_sensitivity", "amplitude_dps", 1.0, (column(np.sin(turn)), column(np.cos(turn)))),
        (
            "encoder_eccentricity",
            "amplitude_deg",
            180.0 / np.pi,
            (column(np.sin(turn) * rate), column(np.cos(turn) * rate)),
        ),
    ]


def _whitened(subject: Subject) -> list[tuple[Floats, Floats]]:
    """Of each effect its columns, and the residual, through the filter that makes the residual whitest, in sigmas."""
    residual_dps = block_residual_dps(subject.seen, subject.design)
    every = _regressors(subject.design)
    nuisance = np.column_stack([column for _, _, _, columns in every for column in columns])
    gain = min(GAINS, key=lambda gain: _left(_through(gain, nuisance), _through(gain, residual_dps[:, None])[:, 0]))
    white = _through(gain, residual_dps[:, None])[:, 0]
    sigma = 1.4826 * float(np.median(np.abs(white - np.median(white)))) + 1e-6
    return [(_through(gain, np.column_stack(columns)) / sigma, white / sigma) for _, _, _, columns in every]


def _through(gain: float, columns: Floats) -> Floats:
    """Innovations of the local level model with this gain; a constant bias is taken away as a mean."""
    if gain == 0.0:
        away: Floats = columns - columns.mean(axis=0)
        return away
    innovations: Floats = lfilter([1.0, -1.0], [1.0, gain - 1.0], columns - columns[0], axis=0)
    return innovations


def _left(columns: Floats, values: Floats) -> float:
    """Spread of what the columns leave, robustly."""
    scale = np.linalg.norm(columns, axis=0) + 1e-12
    left = values - (columns / scale) @ np.linalg.lstsq(columns / scale, values, rcond=1e-9)[0]
    return float(np.mean(np.abs(left)))


def _fit(sessions: Sequence[tuple[Floats, Floats]]) -> tuple[float, float, float]:
    """One coefficient for all sessions: gain of the logarithm of the likelihood, coefficient (amplitude), its error."""
    columns = np.concatenate([columns for columns, _ in sessions])
    values = np.concatenate([values for _, values in sessions])
    information = columns.T @ columns
    if not np.all(np.isfinite(information)) or np.linalg.matrix_rank(information) < len(information):
        return 0.0, 0.0, 0.0
    coefficients = np.linalg.solve(information, columns.T @ values)
    before = float(values @ values)
    after = float(np.square(values - columns @ coefficients).sum())
    spread = max(after / len(values), 1e-12)
    error = float(np.sqrt(spread * np.linalg.inv(information)[0, 0]))
    amplitude = float(coefficients[0]) if len(coefficients) == 1 else float(np.hypot(*coefficients))
    return 0.5 * len(values) * float(np.log(before / max(after, 1e-12))), amplitude, error
