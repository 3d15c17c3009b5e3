"""Effects of a real gyro on the rate of a simulator, in 60 lines of numpy that any wrapper may use or copy.

`gyrodrift diagnose --export json` writes the effects: `json.loads(Path("report/export/effects.json").read_text())` has
them under `effects`, and the measured noise and bias under `noise`. Parameters have the units of their names.

`apply` changes whole arrays, `SimulatedGyro` one sample after the other. The order is that of a device: the sensor is
late, the rate gets vibration and noise, a low-pass, scale and bias errors, and is put out in steps.
"""

from collections.abc import Mapping, Sequence
from math import cos, exp, inf, isnan, log, nan, pi, radians, sin, sqrt
from typing import Any

import numpy as np
from numpy.typing import ArrayLike as Array
from numpy.typing import NDArray

Floats = NDArray[np.float64]
Effects = Sequence[Mapping[str, Any]]
"""Entries with the name under `effect` and the numbers under `parameters`."""

EFFECTS = {
    "bandwidth": {"cutoff_hz", "order"},
    "bias_instability": {"floor_dph"},
    "constant_bias": {"bias_dps"},
    "deadband": {"width_dps"},
    "g_sensitivity": {"amplitude_dps", "phase_deg"},
    "latency": {"delay_ms"},
    "misalignment": {"tilt_deg", "about_deg"},
    "nonlinearity": {"error_percent_fs"},
    "popcorn": {"step_dps", "dwell_s"},
    "quantization": {"step_dps"},
    "rate_random_walk": {"density_dps_rts"},
    "saturation": {"limit_dps"},
    "scale_asymmetry": {"error_percent"},
    "scale_factor": {"error_percent"},
    "spikes": {"height_dps", "share_percent"},
    "stale_hold": {"share_percent"},
    "temp_bias": {"slope_dps_per_c", "curve_per_c"},
    "temp_scale": {"slope_percent_per_c"},
    "vibration": {"amplitude_dps", "frequency_hz"},
    "vibration_rectification": {"bias_dps_at_100_dps"},
    "warmup": {"amplitude_dps", "time_constant_s", "fast_share", "fast_time_constant_s"},
    "white_noise": {"density_dps_rthz"},
}
"""Effects on the rate and their parameters. Effects of clocks, links and encoders do not change a rate."""

FULL_SCALE_DPS = 250.0
REFERENCE_C = 25.0
"""Scale of the nonlinearity, and temperature at which the temperature effects are zero."""

FLICKER_RATIO = 3.0
FLICKER_TAUS_S = 2.7 * FLICKER_RATIO ** np.arange(-12, 8)
"""Time constants of Markov processes whose sum has a 1/f spectrum, up to 1.6 h; faster than a sample is white."""


POLES = {1.0: (-1.0 + 0.0j, 1.0 + 0.0j), 2.0: (np.exp(0.75j * pi), 1.0 - 1.0j)}
"""Poles over 2πf, and gains, of low-passes with one pole and with two (Butterworth); the output is the real part."""


def apply(rates: Array, times: Array, effects: Effects, temp_c: Array = 25.0, seed: int | None = None) -> Floats:
    """Rates that a gyro with these effects would have read, deg/s, shape (n,).

    Parameters
    ----------
    rates
        True rates, deg/s, shape (n,), counter-clockwise positive.
    times
        Times since power-on, s, shape (n,), evenly spaced.
    effects
        Entries of `effects.json`: `effects`, or `effects` and `noise` together.
    temp_c
        Temperature of the sensor, °C, a number or shape (n,).
    seed
        Of the random numbers; None for other numbers in each call.

    Raises
    ------
    ValueError
        An effect is not one of the rate, a parameter does not exist, or a value is not finite.
    """
    rows = np.asarray_chkfinite(np.stack(np.broadcast_arrays(np.asarray(rates, float), times, temp_c), axis=1))
    gyro = SimulatedGyro(effects, float(np.median(np.diff(rows[:, 1]))), seed)
    return np.array([gyro.read(*row) for row in rows.tolist()])


class SimulatedGyro:
    """Gyro that is read each `step_s`, in order; a time that is not later than the last gives the last rate again."""

    def __init__(self, effects: Effects, step_s: float, seed: int | None = None) -> None:
        for name, given in ((entry["effect"], entry["parameters"].keys()) for entry in effects):
            if name not in EFFECTS or given - EFFECTS[name]:
                names = ", ".join(sorted(EFFECTS.get(name, EFFECTS)))
                raise ValueError(f"no effect on the rate is called {name} with {', '.join(given)}; there are {names}")
        self._of = {(entry["effect"], name): value for entry in effects for name, value in entry["parameters"].items()}
        self._step_s, self._rng = step_s, np.random.default_rng(seed)
        self._tone, phase_deg = self._rng.uniform(0.0, 2.0 * pi), self._rng.uniform(0.0, 360.0)
        self._turned_deg = self._get("g_sensitivity", "phase_deg", phase_deg)
        self._sigma_dps = self._get("bias_instability", "floor_dph") / 3600.0 * sqrt(log(FLICKER_RATIO) / pi)
        is_slow = (step_s / 4.0 < FLICKER_TAUS_S) & (self._sigma_dps > 0.0)
        self._kept = np.exp(-step_s / FLICKER_TAUS_S[is_slow])
        self._flicker = self._rng.standard_normal(len(self._kept))
        self._walk, self._level, self._output, self._past = 0.0, -0.5, nan, [(-inf, nan)]
        self._lag: tuple[float, complex] | None = None

    def _get(self, effect: str, parameter: str, absent: float = 0.0) -> float:
        return float(self._of.get((effect, parameter), absent))

    def read(self, rate_dps: float, t_s: float, temp_c: float = REFERENCE_C) -> float:
        """Rate that the gyro reads, deg/s, for the true rate at a time since power-on."""
        if t_s > self._past[-1][0]:
            seen_s = t_s - self._get("latency", "delay_ms") / 1e3
            self._past = [*(past for past in self._past if past[0] > seen_s - 2.0 * self._step_s), (t_s, rate_dps)]
            self._turned_deg += self._step_s * float(np.mean([rate for _, rate in self._past[-2:]]))
            true_dps = float(np.interp(seen_s, *np.transpose(self._past))) if seen_s < t_s else rate_dps
            turns = self._get("vibration", "frequency_hz") * t_s
            hum = self._get("vibration", "amplitude_dps") * sin(2.0 * pi * turns + self._tone)
            noise = self._get("white_noise", "density_dps_rthz") / sqrt(self._step_s) * self._rng.standard_normal()
            analog_dps = true_dps * cos(radians(self._get("misalignment", "tilt_deg"))) + hum + noise
            passed_dps = self._low_passed(analog_dps, true_dps)
            self._output = self._read_out(passed_dps + self._error(passed_dps, true_dps, t_s, temp_c - REFERENCE_C))
        return self._output

    def _low_passed(self, rate_dps: float, true_dps: float) -> float:
        """Rate after the low-pass, exact for straight lines between the samples; it begins in steady state."""
        if not (cutoff_hz := self._get("bandwidth", "cutoff_hz")):
            return rate_dps
        pole, gain = POLES[self._get("bandwidth", "order", 1.0)]
        along = 2.0 * pi * cutoff_hz * pole * self._step_s
        kept, part = np.exp(along), (np.exp(along) - 1.0) / along
        before_dps, passed = self._lag or (true_dps, gain * true_dps)
        passed = kept * passed + gain * ((1.0 - part) * rate_dps + (part - kept) * before_dps)
        self._lag = (rate_dps, passed)
        return float(passed.real)

    def _error(self, rate_dps: float, true_dps: float, t_s: float, over_c: float) -> float:
        """Errors of scale and bias."""
        get, rng, step_s = self._get, self._rng, self._step_s
        self._walk += get("rate_random_walk", "density_dps_rts") * sqrt(step_s) * rng.standard_normal()
        self._flicker = self._kept * self._flicker + np.sqrt(1.0 - self._kept**2) * rng.standard_normal(len(self._kept))
        self._level *= 1.0 if rng.random() < exp(-step_s / get("popcorn", "dwell_s", 20.0)) else -1.0
        random = self._walk + self._sigma_dps * self._flicker.sum() + get("popcorn", "step_dps") * self._level
        slow, fast = (exp(-t_s / get("warmup", f"{which}time_constant_s", 30.0)) for which in ("", "fast_"))
        warm = get("warmup", "amplitude_dps") * (slow + get("warmup", "fast_share") * (fast - slow))
        warm += get("temp_bias", "slope_dps_per_c") * over_c * (1.0 + get("temp_bias", "curve_per_c") * over_c)
        scale = get("scale_factor", "error_percent") * rate_dps + get("scale_asymmetry", "error_percent") * abs(
            true_dps
        )
        scale += get("temp_scale", "slope_percent_per_c") * over_c * true_dps
        scale += get("nonlinearity", "error_percent_fs") * true_dps**3 / FULL_SCALE_DPS**2
        square = get("vibration_rectification", "bias_dps_at_100_dps") * (true_dps / 100.0) ** 2
        turn = get("g_sensitivity", "amplitude_dps") * sin(radians(self._turned_deg))
        return float(scale / 100.0 + square + turn + warm + random + get("constant_bias", "bias_dps"))

    def _read_out(self, rate_dps: float) -> float:
        """Rate after dead band, limit and rounding, with spikes, or the rate before."""
        limit_dps, step_dps = self._get("saturation", "limit_dps", inf), self._get("quantization", "step_dps")
        rate_dps = max(-limit_dps, min(limit_dps, rate_dps * (abs(rate_dps) >= self._get("deadband", "width_dps"))))
        rate_dps = round(rate_dps / step_dps) * step_dps if step_dps else rate_dps
        draws, half = self._rng.random(2).tolist(), self._get("spikes", "share_percent") / 200.0
        rate_dps += self._get("spikes", "height_dps") * ((draws[0] < half) - (draws[0] > 1.0 - half))
        is_stale = draws[1] < self._get("stale_hold", "share_percent") / 100.0 and not isnan(self._output)
        return self._output if is_stale else rate_dps
