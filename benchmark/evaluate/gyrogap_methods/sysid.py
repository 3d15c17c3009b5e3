"""MuJoCo's sysid (`mujoco.sysid.optimize`, wheel mujoco-core[sysid]) with all parameters of a gyro free.

The toolbox takes any residual function. The one here is a model of the gyro and its encoder: 18 parameters and a bias
per session, and seven more with three axes. It fits rates, stamps and forces by least squares, and names no cause. So
its answer is the parameter with the largest normalized change: the distance from the simulator over a typical size of
the effect, or over the confidence interval that the toolbox calculates, whichever is larger. The answer is none below
LEAST_CHANGE, which had the most right answers on 18 cases of another seed. A prior of typical size regularizes the fit.
"""

from contextlib import redirect_stdout
from dataclasses import dataclass
from io import StringIO
from typing import Any

import numpy as np
from gyrogap.estimators import period_s
from gyrogap.physics.bench import Columns
from gyrogap.physics.motion import Floats
from mujoco import sysid
from scipy.signal import lfilter

from evaluate.gyrogap_methods.cases import Answer, PublicCase
from evaluate.gyrogap_methods.rate_error import block_samples

LEAST_CHANGE = 0.8
GRAVITY_MPS2 = 9.80665
ITERATIONS = 25
INSIDE = 0.1
"""Distance of a start from the bounds, in typical sizes: at a bound a least squares step has no gradient inward."""

PRIOR = 1.0
"""Spread of the prior of a parameter in typical sizes: without it, similar effects grow against each other."""


FREE: dict[str, tuple[str, str, float, float]] = {
    "scale": ("scale_factor", "error_percent", 1.0, 20.0),
    "asymmetry": ("scale_asymmetry", "error_percent", 0.3, 10.0),
    "cubic": ("nonlinearity", "error_percent_fs", 0.1, 5.0),
    "square": ("vibration_rectification", "bias_dps_at_100_dps", 0.05, 5.0),
    "delay": ("latency", "delay_ms", 8.0, 100.0),
    "low_pass": ("bandwidth", "cutoff_hz", 10.0, 60.0),
    "slope": ("temp_bias", "slope_dps_per_c", 0.02, 0.5),
    "curve": ("temp_bias", "curve_dps_per_c2", 0.01, 0.1),
    "gain_slope": ("temp_scale", "slope_percent_per_c", 0.02, 0.5),
    "warmup": ("warmup", "amplitude_dps", 0.1, 3.0),
    "gravity_sine": ("g_sensitivity", "amplitude_dps", 0.03, 1.0),
    "gravity_cosine": ("g_sensitivity", "amplitude_dps", 0.03, 1.0),
    "disc_sine": ("encoder_eccentricity", "amplitude_deg", 0.3, 5.0),
    "disc_cosine": ("encoder_eccentricity", "amplitude_deg", 0.3, 5.0),
    "clock": ("clock_drift", "ppm", 600.0, 30000.0),
    "range": ("saturation", "limit_dps", 0.4, 0.9),
    "band": ("deadband", "width_dps", 0.2, 2.0),
}
"""Parameters of one axis: effect, parameter of the answer, typical size and bound in the units of the model."""

FREE_3: dict[str, tuple[str, str, float, float]] = {
    "tilt_x": ("misalignment", "tilt_deg", 6.0, 40.0),
    "tilt_y": ("misalignment", "tilt_deg", 6.0, 40.0),
    "cross_x": ("gyro_cross_axis", "xz_percent", 4.0, 30.0),
    "cross_y": ("gyro_cross_axis", "yz_percent", 4.0, 30.0),
    "force_x": ("accel_bias", "offset_mps2", 0.5, 5.0),
    "force_y": ("accel_bias", "offset_mps2", 0.5, 5.0),
    "force": ("accel_scale", "error_percent", 2.0, 20.0),
}

LARGEST_DPS = 200.0
"""Largest rate of the motion; a range below it is seen."""


@dataclass(frozen=True, slots=True)
class SessionModel:
    """A session for the residual: measured block means, and the inputs of the model."""

    columns: Columns
    step_s: float
    samples: int
    turn_dps: Floats
    sigma_dps: float

    def blocks(self, values: Floats) -> Floats:
        """Block means along the first axis."""
        count = len(values) // self.samples
        means: Floats = values[: count * self.samples].reshape(count, self.samples, -1).mean(axis=1)
        return means

    def rate_dps(self, x: dict[str, float]) -> Floats:
        """Rate of the gyro without its bias."""
        turn = self.turn_dps
        angle, over_c = np.radians(self.columns.encoder_deg), self.columns.temp_c - 25.0
        turn = turn - np.radians(turn) * (x["disc_sine"] * np.cos(angle) - x["disc_cosine"] * np.sin(angle))
        tau_s = abs(x["low_pass"]) / 1000.0
        if tau_s > 1e-5:
            pole = np.exp(-self.step_s / tau_s)
            turn = lfilter([1.0 - pole], [1.0, -pole], turn)
        grid = np.arange(len(turn)) * self.step_s
        turn = np.interp(grid - x["delay"] / 1000.0, grid, turn)
        rate: Floats = turn * (1.0 + (x["scale"] + x["gain_slope"] * over_c) / 100.0)
        rate = rate + np.abs(turn) * x["asymmetry"] / 100.0 + turn**3 / 250.0**2 * x["cubic"] / 100.0
        rate = rate + (turn / 100.0) ** 2 * x["square"] + x["slope"] * over_c + x["curve"] * over_c**2
        rate = rate + x["warmup"] * np.exp(-self.columns.t_device_s / x["warmup_s"])
        return rate + x["gravity_sine"] * np.sin(angle) + x["gravity_cosine"] * np.cos(angle)


def session_model(columns: Columns, simulator: dict[str, Any]) -> SessionModel:
    """Prepare a session; counts of the encoder are the noise of its rate."""
    base, step_s = simulator["base"], period_s(columns)
    samples = block_samples(simulator, step_s)
    block_s = samples * step_s
    count_dps = 360.0 / base["encoder_cpr"] / np.sqrt(6.0) / block_s
    sigma_dps = float(np.hypot(base["noise_dps_rthz"] / np.sqrt(block_s), count_dps))
    return SessionModel(columns, step_s, samples, np.gradient(columns.encoder_deg) / step_s, sigma_dps)


def residual(x: dict[str, float], model: SessionModel, bias_dps: float) -> list[Floats]:
    """Residuals of a session in units of noise: rates, stamps, and with three axes the other rates and forces."""
    columns, rate = model.columns, model.rate_dps(x) + bias_dps
    limit = LARGEST_DPS * (1.0 - x["range"])
    rate = np.clip(rate, -limit, limit) if x["range"] > 0.0 else rate
    rate = rate * (1.0 - np.exp(-((rate / x["band"]) ** 4))) if x["band"] > 1e-4 else rate
    parts = [(model.blocks(columns.rate_dps) - model.blocks(rate)).ravel() / model.sigma_dps]
    host_s = columns.t_host_s - columns.t_host_s[0]
    device_s = columns.t_device_s - columns.t_device_s[0]
    parts.append(model.blocks(device_s - host_s * (1.0 + x["clock"] * 1e-6)).ravel() / 1e-3)
    if columns.axes is not None:
        parts += _axes_residual(x, model)
    return parts


def _axes_residual(x: dict[str, float], model: SessionModel) -> list[Floats]:
    """Shares of the turn on x and y, and the force; each is compared without the bias of its axis."""
    axes = model.columns.axes
    assert axes is not None
    turn = model.blocks(model.turn_dps)[:, 0]
    gyro, force = model.blocks(axes.gyro_dps), model.blocks(axes.accel_mps2)
    tilt_x, tilt_y = np.radians(x["tilt_x"]), np.radians(x["tilt_y"])
    shares = (tilt_x + x["cross_x"] / 100.0, tilt_y + x["cross_y"] / 100.0)
    parts = [(gyro[:, i] - gyro[:, i].mean() - shares[i] * (turn - turn.mean())) / model.sigma_dps for i in (0, 1)]
    gain = 1.0 + x["force"] / 100.0
    level = (GRAVITY_MPS2 * gain * tilt_x + x["force_x"], GRAVITY_MPS2 * gain * tilt_y + x["force_y"])
    upward = GRAVITY_MPS2 * gain * np.sqrt(max(0.0, 1.0 - tilt_x**2 - tilt_y**2))
    return [*parts, *((force[:, i] - value) / 0.05 for i, value in enumerate((*level, upward)))]


def changes(case: PublicCase) -> tuple[dict[str, float], dict[str, float]]:
    """Fitted parameters of the model, and their distance from the simulator over typical sizes."""
    has_axes = case.sessions[0].axes is not None
    free, stated = FREE | (FREE_3 if has_axes else {}), stated_values(case.simulator)
    models = [session_model(columns, case.simulator) for columns in case.sessions]
    parameters = sysid.ParameterDict()
    for name, (_, _, typical, bound) in free.items():
        nominal = stated.get(name, 0.0)
        low = 0.0 if name in {"low_pass", "range", "band", "delay"} else -bound
        start = float(np.clip(nominal, low + INSIDE * typical, bound - INSIDE * typical))
        parameters.add(sysid.Parameter(name, start, low - 1e-3 * typical, max(bound, start) + 1e-3 * typical))
    parameters.add(sysid.Parameter("warmup_s", stated.get("warmup_s", 80.0), 10.0, 400.0))
    for index, columns in enumerate(case.sessions):
        parameters.add(sysid.Parameter(f"bias {index}", float(np.median(columns.rate_dps)), -50.0, 50.0))
    names = parameters.keys()
    scale = np.array([free[name][2] if name in free else 50.0 if name == "warmup_s" else 1.0 for name in names])

    def residuals(vector: Floats, _: Any) -> tuple[list[Floats], None, None]:
        x = dict(zip(names, np.asarray(vector).ravel().tolist(), strict=True))
        parts = [part for i, model in enumerate(models) for part in residual(x, model, x[f"bias {i}"])]
        parts.append(np.array([(x[name] - stated.get(name, 0.0)) / (PRIOR * free[name][2]) for name in free]))
        return parts, None, None

    toolbox: Any = sysid
    options: dict[str, Any] = {"max_iters": ITERATIONS, "x_scale": scale, "loss": "soft_l1", "diff_step": 1e-4}
    with redirect_stdout(StringIO()):  # the optimizer prints each step
        _, result = toolbox.optimize(parameters, residuals, optimizer="scipy", verbose=False, **options)
    fitted = dict(zip(names, result.x.tolist(), strict=True))
    _, intervals = toolbox.calculate_intervals(residuals(result.x, None)[0], result.jac)
    units = {
        name: max(free[name][2], float(interval)) if np.isfinite(interval) else np.inf
        for name, interval in zip(names, intervals, strict=True)
        if name in free
    }
    return fitted, {name: (fitted[name] - stated.get(name, 0.0)) / unit for name, unit in units.items()}


def stated_values(simulator: dict[str, Any]) -> dict[str, float]:
    """Parameters of the model for the effects that the simulator has."""
    values: dict[str, float] = {}
    for effect in simulator["effects"]:
        names = [name for name, (of, _, _, _) in FREE.items() if of == effect["name"]]
        if effect["name"] == "bandwidth":
            values["low_pass"] = 1000.0 / (2.0 * np.pi * effect["cutoff_hz"])
        elif effect["name"] == "saturation":
            values["range"] = max(0.0, 1.0 - effect["limit_dps"] / LARGEST_DPS)
        elif effect["name"] in {"g_sensitivity", "encoder_eccentricity"}:
            amplitude = effect[FREE[names[0]][1]]
            phase = np.radians(effect["phase_deg"])
            values |= {names[0]: float(amplitude * np.cos(phase)), names[1]: float(amplitude * np.sin(phase))}
        elif names:
            values[names[0]] = effect[FREE[names[0]][1]]
    return values


def answer(case: PublicCase, least_change: float = LEAST_CHANGE) -> Answer:
    """The largest normalized change; its probability is its share of all changes."""
    fitted, change = changes(case)
    free = FREE | FREE_3
    by_effect: dict[str, float] = {}
    for name, value in change.items():
        by_effect[free[name][0]] = float(np.hypot(by_effect.get(free[name][0], 0.0), value))
    largest = max(by_effect.values())
    if largest < least_change:
        return {"causes": [], "none": 1.0, "unknown": 0.0}
    total = sum(by_effect.values())
    causes = [
        {"effect": effect, "probability": round(size / total, 4), "parameters": _parameters(effect, fitted)}
        for effect, size in by_effect.items()
        if size / total > 0.02
    ]
    return {"causes": causes, "none": 0.0, "unknown": 0.0}


def _parameters(effect: str, fitted: dict[str, float]) -> dict[str, float]:
    """Parameters of an answer from those of the model."""
    free = FREE | FREE_3
    values = {name: fitted[name] for name, (of, _, _, _) in free.items() if of == effect}
    if effect == "bandwidth":
        return {"cutoff_hz": 1000.0 / (2.0 * np.pi * max(1e-3, abs(values["low_pass"])))}
    if effect == "saturation":
        return {"limit_dps": LARGEST_DPS * (1.0 - max(0.0, values["range"]))}
    if effect in {"g_sensitivity", "encoder_eccentricity", "misalignment", "accel_bias"}:
        first, second = values.values()
        angle = "phase_deg" if effect in {"g_sensitivity", "encoder_eccentricity"} else "about_deg"
        return {
            free[next(iter(values))][1]: float(np.hypot(first, second)),
            angle: float(np.degrees(np.arctan2(second, first))),
        }
    stated = {free[name][1]: value for name, value in values.items()}
    return stated | ({"time_constant_s": fitted["warmup_s"]} if effect == "warmup" else {})
