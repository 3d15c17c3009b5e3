"""Words of an answer: effects, their groups, and their parameters with unit, default and range."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gyrogap.catalogue import EFFECTS, GROUP, JUDGED, STAGE
from gyrogap.physics.kinds import InjectedEffect

THREE_AXIS_GROUPS = {
    "misalignment": "mount",
    "gyro_cross_axis": "mount",
    "accel_bias": "accelerometer",
    "accel_scale": "accelerometer",
}
"""Groups of the effects of a device with three axes."""

GROUP_OF: Mapping[str, str] = GROUP | THREE_AXIS_GROUPS
"""Group by effect, all effects of an answer."""

STAGE_OF: Mapping[str, str] = STAGE | dict.fromkeys(THREE_AXIS_GROUPS, "sensor")

JUDGED_BY: Mapping[str, str] = JUDGED | {
    "misalignment": "tilt_deg",
    "gyro_cross_axis": "xz_percent",
    "accel_bias": "offset_mps2",
    "accel_scale": "error_percent",
}
"""Parameter whose error is reported. Four effects have none, because another form of them is as right:
nonlinearity, bandwidth, temp_bias and warmup."""


@dataclass(frozen=True, slots=True)
class AnswerParameter:
    """A parameter of an effect in an answer.

    default
        Value where an answer leaves it out.
    low, high
        Range; a value outside of it is clipped before the effect is simulated.
    """

    name: str
    unit: str
    default: float
    low: float
    high: float
    about: str


def _strength(name: str, unit: str, low: float, high: float, about: str) -> AnswerParameter:
    """A parameter whose default is no effect."""
    return AnswerParameter(name, unit, 0.0, low, high, about)


PHASE = AnswerParameter("phase_deg", "deg", 0.0, -360.0, 360.0, "of the sine, at the angle 0 of the table")
ABOUT = AnswerParameter("about_deg", "deg", 0.0, -360.0, 360.0, "direction in the sensor, from x to y")
SHARE = _strength("share_percent", "%", 0.0, 50.0, "of the samples")

# fmt: off
PARAMETERS: Mapping[str, tuple[AnswerParameter, ...]] = {
    "scale_factor": (_strength("error_percent", "%", -50.0, 50.0, "gain minus 1"),),
    "scale_asymmetry": (_strength("error_percent", "%", -50.0, 50.0, "of the gain; minus it at negative rates"),),
    "nonlinearity": (_strength("error_percent_fs", "%", -20.0, 20.0, "error at 250 deg/s, of 250 deg/s"),),
    "deadband": (_strength("width_dps", "deg/s", 0.0, 50.0, "rates below it read 0"),),
    "saturation": (AnswerParameter("limit_dps", "deg/s", 1000.0, 1.0, 1000.0, "largest rate"),),
    "quantization": (AnswerParameter("step_dps", "deg/s", 1e-6, 1e-6, 50.0, "step of the rate"),),
    "bandwidth": (AnswerParameter("cutoff_hz", "Hz", 300.0, 0.05, 300.0, "-3 dB of a low-pass of second order"),),
    "latency": (_strength("delay_ms", "ms", 0.0, 1000.0, "delay of the rate"),),
    "bias_instability": (_strength("floor_dph", "deg/h", 0.0, 20000.0, "1/f noise; Allan deviation 0.664 of it"),),
    "rate_random_walk": (_strength("density_dps_rts", "deg/s/sqrt(s)", 0.0, 5.0, "standard deviation after 1 s"),),
    "popcorn": (
        _strength("step_dps", "deg/s", 0.0, 50.0, "distance of the two levels"),
        AnswerParameter("dwell_s", "s", 25.0, 0.5, 1000.0, "mean time on a level"),
    ),
    "spikes": (
        _strength("height_dps", "deg/s", 0.0, 2000.0, "mean size of an outlier"),
        AnswerParameter("share_percent", "%", 0.15, 0.0, 50.0, "of the samples"),
    ),
    "vibration": (
        _strength("amplitude_dps", "deg/s", 0.0, 500.0, "amplitude of a tone"),
        AnswerParameter("frequency_hz", "Hz", 30.0, 0.1, 395.0, "before sampling"),
    ),
    "vibration_rectification": (_strength("bias_dps_at_100_dps", "deg/s", -50.0, 50.0, "grows with the squared rate"),),
    "g_sensitivity": (_strength("amplitude_dps", "deg/s", -50.0, 50.0, "bias once per turn of the table"), PHASE),
    "temp_bias": (
        _strength("slope_dps_per_c", "deg/s/C", -5.0, 5.0, "at 25 C"),
        _strength("curve_dps_per_c2", "deg/s/C2", -1.0, 1.0, "factor of the square of the distance from 25 C"),
    ),
    "temp_scale": (_strength("slope_percent_per_c", "%/C", -5.0, 5.0, "of the gain, 0 at 25 C"),),
    "warmup": (
        _strength("amplitude_dps", "deg/s", -50.0, 50.0, "bias at power-on above its final value"),
        AnswerParameter("time_constant_s", "s", 120.0, 1.0, 5000.0, "of the slow exponential"),
        _strength("fast_share", "", 0.0, 1.0, "part of the amplitude that decays faster"),
        AnswerParameter("fast_time_constant_s", "s", 30.0, 1.0, 5000.0, "of that part"),
    ),
    "backlash": (_strength("play_deg", "deg", 0.0, 90.0, "whole play"),),
    "encoder_eccentricity": (_strength("amplitude_deg", "deg", -45.0, 45.0, "angle error once per turn"), PHASE),
    "encoder_slip": (
        _strength("step_deg", "deg", 0.0, 180.0, "size of a jump"),
        AnswerParameter("per_hour", "1/h", 40.0, 0.01, 5000.0, "number of jumps"),
    ),
    "encoder_quantization": (AnswerParameter("cpr", "1/turn", 1e6, 4.0, 1e6, "counts of a turn"),),
    "clock_drift": (_strength("ppm", "ppm", -200000.0, 200000.0, "positive if the device clock is fast"),),
    "timestamp_jitter": (_strength("sigma_ms", "ms", 0.0, 1000.0, "standard deviation of a device stamp"),),
    "usb_batching": (AnswerParameter("interval_ms", "ms", 0.001, 0.001, 5000.0, "between two polls of the host"),),
    "sample_drop": (SHARE,),
    "stale_hold": (SHARE,),
    "misalignment": (_strength("tilt_deg", "deg", 0.0, 80.0, "tilt of the part about a level axis"), ABOUT),
    "gyro_cross_axis": (
        _strength("xz_percent", "%", -50.0, 50.0, "share of z that x of the gyro reads"),
        _strength("yz_percent", "%", -50.0, 50.0, "share of z that y of the gyro reads"),
    ),
    "accel_bias": (_strength("offset_mps2", "m/s2", -20.0, 20.0, "level offset of the accelerometer"), ABOUT),
    "accel_scale": (_strength("error_percent", "%", -50.0, 50.0, "gain of all axes of the accelerometer"),),
}
# fmt: on
"""Parameters by effect, the strength first."""

ONE_AXIS, THREE_AXES = EFFECTS, tuple(THREE_AXIS_GROUPS)


def effect_of_answer(name: str, stated: Mapping[str, float]) -> InjectedEffect:
    """Effect of the benchmark's physics with the parameters of an answer; what it leaves out has its default."""
    values = {
        parameter.name: min(max(stated.get(parameter.name, parameter.default), parameter.low), parameter.high)
        for parameter in PARAMETERS[name]
    }
    if name == "warmup":
        values |= {"fast_s": values.pop("fast_time_constant_s"), "slow_s": values.pop("time_constant_s")}
    if name == "popcorn":
        values["dwell_shape"] = 1.0
    return InjectedEffect(name, values)


def table() -> dict[str, Any]:
    """The vocabulary for `effects.json`."""
    return {
        name: {
            "group": GROUP_OF[name],
            "stage": STAGE_OF[name],
            "axes": [3] if name in THREE_AXES else [1, 3],
            "judged_by": JUDGED_BY.get(name),
            "parameters": [
                {"name": p.name, "unit": p.unit, "default": p.default, "low": p.low, "high": p.high, "about": p.about}
                for p in parameters
            ],
        }
        for name, parameters in PARAMETERS.items()
    }
