"""Effects and deviations in plain words, with their sign and size."""

from collections.abc import Callable, Mapping
from math import cos, radians

from gyrodrift.diagnose.inference.gap import Deviation
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.report.numbers import significant

Values = Mapping[str, float]

DIGITS = 2
"""Digits of a size in a headline. Chosen: a headline is read at a glance."""


def _size(value: float) -> str:
    return significant(abs(value), DIGITS)


def _high(value: float) -> str:
    return "high" if value > 0.0 else "low"


def _rises(value: float) -> str:
    return "rises" if value > 0.0 else "falls"


def _lost(tilt_deg: float) -> float:
    """Loss of rate by a tilt, %."""
    return 100.0 * (1.0 - cos(radians(tilt_deg)))


def _scale_asymmetry(values: Values) -> str:
    error = values["error_percent"]
    return f"the rate reads {_size(error)} % too {_high(error)} counter-clockwise and too {_high(-error)} clockwise"


def _warmup(values: Values) -> str:
    start, tau_s = values["amplitude_dps"], values["time_constant_s"]
    return f"the bias is {_size(start)} deg/s too {_high(start)} at power-on and decays in {_size(tau_s)} s"


def _batches(values: Values) -> str:
    spread = f", ± {_size(values['spread_percent'])} %" if values["spread_percent"] else ""
    return f"samples reach the host in batches every {_size(values['interval_ms'])} ms{spread}"


SENTENCES: dict[str, Callable[[Values], str]] = {
    "misalignment": lambda v: (
        f"the sensor is tilted by {_size(v['tilt_deg'])}°: the rate reads {_size(_lost(v['tilt_deg']))} % too low"
    ),
    "scale_factor": lambda v: f"the rate reads {_size(v['error_percent'])} % too {_high(v['error_percent'])}",
    "scale_asymmetry": _scale_asymmetry,
    "nonlinearity": lambda v: (
        f"the rate reads {_size(v['error_percent_fs'])} % too {_high(v['error_percent_fs'])} at full scale"
    ),
    "deadband": lambda v: f"rates below {_size(v['width_dps'])} deg/s read 0",
    "saturation": lambda v: f"rates above {_size(v['limit_dps'])} deg/s are clipped",
    "quantization": lambda v: f"the rate has steps of {_size(v['step_dps'])} deg/s",
    "bandwidth": lambda v: f"a low-pass at {_size(v['cutoff_hz'])} Hz smooths the rate",
    "latency": lambda v: f"the rate lags {_size(v['delay_ms'])} ms behind the encoder",
    "bias_instability": lambda v: f"the bias wanders (1/f noise) with a floor of {_size(v['floor_dph'])} deg/h",
    "rate_random_walk": lambda v: f"the bias walks at random, {_size(v['density_dps_rts'])} deg/s/√s",
    "popcorn": lambda v: f"the bias jumps by {_size(v['step_dps'])} deg/s between two levels",
    "spikes": lambda v: f"{_size(v['share_percent'])} % of samples are spikes of {_size(v['height_dps'])} deg/s",
    "vibration": lambda v: f"the rate has a tone of {_size(v['amplitude_dps'])} deg/s at {_size(v['frequency_hz'])} Hz",
    "vibration_rectification": lambda v: (
        f"the bias {_rises(v['bias_dps_at_100_dps'])} with the square of the rate, by "
        f"{_size(v['bias_dps_at_100_dps'])} deg/s at 100 deg/s"
    ),
    "g_sensitivity": lambda v: f"the bias changes by ±{_size(v['amplitude_dps'])} deg/s once per turn",
    "temp_bias": lambda v: f"the bias {_rises(v['slope_dps_per_c'])} by {_size(v['slope_dps_per_c'])} deg/s per °C",
    "temp_scale": lambda v: (
        f"the gain {_rises(v['slope_percent_per_c'])} by {_size(v['slope_percent_per_c'])} % per °C"
    ),
    "warmup": _warmup,
    "encoder_eccentricity": lambda v: f"the encoder angle is off by ±{_size(v['amplitude_deg'])}° once per turn",
    "encoder_slip": lambda v: f"the encoder slips by {_size(v['step_deg'])}°, {_size(v['per_hour'])} times per hour",
    "encoder_quantization": lambda v: f"the encoder has {v['cpr']:.0f} counts per turn",
    "backlash": lambda v: f"the encoder lags by {_size(v['play_deg'])}° after a reversal",
    "clock_drift": lambda v: f"the device clock runs {_size(v['ppm'])} ppm {'fast' if v['ppm'] > 0.0 else 'slow'}",
    "timestamp_jitter": lambda v: f"device times scatter by {_size(v['sigma_ms'])} ms",
    "usb_batching": _batches,
    "sample_drop": lambda v: f"{_size(v['share_percent'])} % of samples are missing",
    "stale_hold": lambda v: f"{_size(v['share_percent'])} % of samples repeat the sample before",
}
"""A sentence for each effect, from its parameters."""

SIGNED: dict[str, tuple[str, str]] = {
    "rate": ("the rate reads too low", "the rate reads too high"),
    "reach": ("the largest rates are below those of the encoder", "the largest rates exceed those of the encoder"),
}
"""Deviations whose sign has a plain meaning: recordings below the simulator, and above."""


def effect_sentence(cause: NamedCause) -> str:
    """The effect with its sign, size and name, and the size in the rig if the rig has the effect."""
    first, notes = cause.parameters[0], [cause.effect.name]
    if cause.in_rig is not None:
        size = significant(float(getattr(cause.in_rig, first.name)), DIGITS + 1).replace("-", "−")
        notes.append(f"the rig has {size} {first.unit}")
    return f"{effect_words(cause)} ({'; '.join(notes)})"


def effect_words(cause: NamedCause) -> str:
    """The effect with its sign, and its size or a bound of the size."""
    sentence = SENTENCES.get(cause.effect.name)
    if sentence is None:
        return cause.meaning
    first = cause.parameters[0]
    fitted = {parameter.name: parameter.value for parameter in cause.parameters} | {first.name: first.bound}
    words = sentence({**cause.effect.model_dump(exclude={"name"}), **fitted})
    if not first.is_bound:
        return words
    limit = "at least" if first.is_at_least == (first.bound > 0.0) else "at most"
    return words.replace(_size(first.bound), f"{limit} {_size(first.bound)}", 1)


def deviation_words(feature: str, z: float, says: str) -> str:
    """A deviation in words, with its direction if the direction has a plain meaning."""
    below, above = SIGNED.get(feature, (says, says))
    return above if z > 0.0 else below


def says(deviation: Deviation) -> str:
    """A deviation of a verdict in words."""
    return deviation_words(deviation.feature, deviation.z, deviation.says)
