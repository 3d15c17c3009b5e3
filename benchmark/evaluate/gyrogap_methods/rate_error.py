"""Rate error of a session as block means, with the regressors that are linear in the size of an effect."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from gyrogap.estimators import period_s
from gyrogap.physics.bench import Columns
from gyrogap.physics.motion import Floats

BLOCK_S = (0.1, 2.0)
"""Shortest and longest block, s."""

BLOCK_COUNTS_S = 2000.0
"""Length of a block times counts of a turn: a coarse encoder needs longer blocks, because its noise is not white."""

CALIBRATED_C = 25.0
WARM_S = (30.0, 120.0)
"""Time constants of a warm-up."""


@dataclass(frozen=True, slots=True)
class RateError:
    """Block means of a session.

    error_dps
        Rate of the gyro less that of the encoder, (blocks,).
    regressors
        By name, (blocks,) each: the error of an effect of size 1 in the units of an answer.
    sigma_dps
        Noise of a block mean by the simulator: of the gyro and of the counts of the encoder.
    """

    error_dps: Floats
    regressors: dict[str, Floats]
    sigma_dps: float


def rate_error(columns: Columns, simulator: dict[str, Any]) -> RateError:
    """Rate error of a session; what the simulator states is subtracted."""
    step_s = period_s(columns)
    samples = block_samples(simulator, step_s)

    def blocks(values: Floats) -> Floats:
        means: Floats = values[: len(values) // samples * samples].reshape(-1, samples).mean(axis=1)
        return means

    rate = blocks(0.5 * (columns.rate_dps[1:] + columns.rate_dps[:-1]))
    turn = blocks(np.diff(columns.encoder_deg)) / step_s
    angle, over_c = np.radians(blocks(columns.encoder_deg[1:])), blocks(columns.temp_c[1:]) - CALIBRATED_C
    powered_s = blocks(columns.t_device_s[1:])
    regressors = {
        "scale_factor": turn / 100.0,
        "scale_asymmetry": np.abs(turn) / 100.0,
        "nonlinearity": turn**3 / 250.0**2 / 100.0,
        "vibration_rectification": (turn / 100.0) ** 2,
        "lag": -np.gradient(turn, samples * step_s) / 1000.0,
        "temp_bias": over_c,
        "temp_bias curve": over_c**2,
        "temp_scale": over_c * turn / 100.0,
        "g_sensitivity sine": np.sin(angle),
        "g_sensitivity cosine": np.cos(angle),
        "encoder_eccentricity sine": -np.cos(angle) * np.radians(turn),
        "encoder_eccentricity cosine": np.sin(angle) * np.radians(turn),
        **{f"warmup {tau_s:g}": np.exp(-powered_s / tau_s) for tau_s in WARM_S},
    }
    base, block_s = simulator["base"], samples * step_s
    count_dps = 360.0 / base["encoder_cpr"] / np.sqrt(6.0) / block_s
    sigma_dps = float(np.hypot(base["noise_dps_rthz"] / np.sqrt(block_s), count_dps))
    error = rate - turn
    for name, size in stated_sizes(simulator).items():
        error = error - size * regressors[name]
    return RateError(error, regressors, sigma_dps)


def block_samples(simulator: dict[str, Any], step_s: float) -> int:
    """Samples of a block: longer for a coarse encoder."""
    length_s = float(np.clip(BLOCK_COUNTS_S / simulator["base"]["encoder_cpr"], *BLOCK_S))
    return max(1, round(length_s / step_s))


def stated_sizes(simulator: dict[str, Any]) -> dict[str, float]:
    """Sizes of the regressors for the effects that the simulator has."""
    sizes: dict[str, float] = {}
    for effect in simulator["effects"]:
        name = effect["name"]
        if name in {"scale_factor", "scale_asymmetry"}:
            sizes[name] = effect["error_percent"]
        elif name == "vibration_rectification":
            sizes[name] = effect["bias_dps_at_100_dps"]
        elif name == "temp_scale":
            sizes[name] = effect["slope_percent_per_c"]
        elif name == "latency":
            sizes["lag"] = sizes.get("lag", 0.0) + effect["delay_ms"]
        elif name == "bandwidth":
            sizes["lag"] = sizes.get("lag", 0.0) + 1000.0 / (2.0 * np.pi * effect["cutoff_hz"])
        elif name in {"g_sensitivity", "encoder_eccentricity"}:
            amplitude = effect["amplitude_dps" if name == "g_sensitivity" else "amplitude_deg"]
            phase = np.radians(effect["phase_deg"])
            sizes |= {f"{name} sine": amplitude * np.cos(phase), f"{name} cosine": amplitude * np.sin(phase)}
    return sizes
