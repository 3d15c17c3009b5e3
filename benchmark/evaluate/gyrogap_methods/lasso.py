"""A lasso on the regressors that are linear in the size of an effect, with stability selection.

Meinshausen and Bühlmann, "Stability selection", JRSS B 72 (2010): the probability of an effect is the share of half
samples in which the lasso selects it. PENALTY is the only number to tune: the smallest of 1, 2, 4, ... that selects
nothing in 95 % of training cases without a gap. It knows 10 of the 31 effects, and has no test for an unknown cause.
"""

from typing import Any

import numpy as np
from gyrogap.physics.motion import Floats
from sklearn.linear_model import Lasso

from evaluate.gyrogap_methods.cases import Answer, PublicCase
from evaluate.gyrogap_methods.rate_error import WARM_S, RateError, rate_error, stated_sizes

PENALTY = 8.0
HALVES = 40
SEGMENT_BLOCKS = 20

EFFECT_OF = {
    "lag": "latency",
    "temp_bias curve": "temp_bias",
    **{f"{name} {part}": name for name in ("g_sensitivity", "encoder_eccentricity") for part in ("sine", "cosine")},
    **{f"warmup {tau_s:g}": "warmup" for tau_s in WARM_S},
}


def answer(case: PublicCase, penalty: float = PENALTY) -> Answer:
    """Effects with their selection frequency, and sizes by least squares on those that are selected."""
    errors = [rate_error(columns, case.simulator) for columns in case.sessions]
    names = list(errors[0].regressors)
    design, values, segments = _stacked(errors, names)
    frequency, effect_of = np.zeros(len(names)), [EFFECT_OF.get(name, name) for name in names]
    shares = dict.fromkeys(effect_of, 0.0)
    rng = np.random.default_rng(0)
    for _ in range(HALVES):
        chosen = rng.permutation(segments.max() + 1)[: (segments.max() + 1) // 2]
        rows = np.isin(segments, chosen)
        selected = _selected(design[rows], values[rows], penalty)
        frequency += selected / HALVES
        for effect in {effect_of[index] for index in np.flatnonzero(selected)}:
            shares[effect] += 1.0 / HALVES
    kept = frequency >= 0.5
    sizes = np.zeros(len(names))
    if kept.any():
        sizes[kept] = np.linalg.lstsq(design[:, kept], values, rcond=None)[0]
    sized = dict(zip(names, sizes.tolist(), strict=True))
    causes = [
        {"effect": effect, "probability": round(share, 4), "parameters": _parameters(effect, sized, case.simulator)}
        for effect, share in shares.items()
        if share > 0.02
    ]
    return {"causes": causes, "none": round(1.0 - max(shares.values()), 4), "unknown": 0.0}


def _stacked(errors: list[RateError], names: list[str]) -> tuple[Floats, Floats, Any]:
    """Design and values in units of noise, without their means in each session; and the segment of each block."""
    designs, values, segments, first = [], [], [], 0
    for error in errors:
        design = np.column_stack([error.regressors[name] for name in names])
        designs.append((design - design.mean(axis=0)) / error.sigma_dps)
        values.append((error.error_dps - error.error_dps.mean()) / error.sigma_dps)
        own = np.arange(len(error.error_dps)) // SEGMENT_BLOCKS
        segments.append(first + own)
        first += int(own.max()) + 1
    return np.concatenate(designs), np.concatenate(values), np.concatenate(segments)


def _selected(design: Floats, values: Floats, penalty: float) -> Floats:
    """1 for each selected column; columns are scaled to a mean square of 1."""
    scale = np.sqrt(np.mean(design**2, axis=0)) + 1e-12
    alpha = penalty * np.sqrt(2.0 * np.log(design.shape[1]) / len(values))
    fitted = Lasso(alpha=alpha, fit_intercept=False, max_iter=5000, tol=1e-3).fit(design / scale, values)
    return np.asarray(np.abs(fitted.coef_) > 0.0, dtype=np.float64)


def _parameters(effect: str, sizes: dict[str, float], simulator: dict[str, Any]) -> dict[str, float]:
    """Parameters of an answer: the size in the simulator and the difference."""
    total = {name: size + stated_sizes(simulator).get(name, 0.0) for name, size in sizes.items()}
    if effect in {"g_sensitivity", "encoder_eccentricity"}:
        sine, cosine = total[f"{effect} sine"], total[f"{effect} cosine"]
        name = "amplitude_dps" if effect == "g_sensitivity" else "amplitude_deg"
        return {name: float(np.hypot(sine, cosine)), "phase_deg": float(np.degrees(np.arctan2(cosine, sine)))}
    if effect == "temp_bias":
        return {"slope_dps_per_c": sizes["temp_bias"], "curve_dps_per_c2": sizes["temp_bias curve"]}
    if effect == "warmup":
        amplitudes = {tau_s: sizes[f"warmup {tau_s:g}"] for tau_s in WARM_S}
        longest = max(amplitudes, key=lambda tau_s: abs(amplitudes[tau_s]))
        return {"amplitude_dps": sum(amplitudes.values()), "time_constant_s": longest}
    own = {
        "scale_factor": "error_percent",
        "scale_asymmetry": "error_percent",
        "nonlinearity": "error_percent_fs",
        "vibration_rectification": "bias_dps_at_100_dps",
        "latency": "delay_ms",
        "temp_scale": "slope_percent_per_c",
    }
    return {own[effect]: total["lag" if effect == "latency" else effect]}
