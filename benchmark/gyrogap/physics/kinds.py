"""All effects by name: the point at which each acts, and its function."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from gyrogap.physics import environment, link, outside_bias, outside_gain, outside_link, reference
from gyrogap.physics import sensor_bias as bias
from gyrogap.physics import sensor_curve as curve
from gyrogap.physics import sensor_time as time
from gyrogap.physics.motion import Floats


class InjectionPoint(IntEnum):
    """Values on which an effect acts.

    FELT
        The rate that the gyro feels, on the fine grid.
    PASSED
        The rate and the noise before the filters of the sensor, on the fine grid.
    GAIN
        The sampled rate.
    OUTPUT
        The rate with noise and bias.
    READ
        The rate in whole counts, as it is read out.
    ANGLE
        The angle of the encoder's shaft, on the fine grid.
    COUNTED
        The angle at the samples.
    STAMP
        Device times.
    ARRIVAL
        Host times.
    ROWS
        Numbers of the samples, in the order of arrival.
    """

    FELT = 0
    PASSED = 1
    GAIN = 2
    OUTPUT = 3
    READ = 4
    ANGLE = 5
    COUNTED = 6
    STAMP = 7
    ARRIVAL = 8
    ROWS = 9


Act = Callable[..., Floats]

KINDS: dict[str, tuple[InjectionPoint, Act]] = {
    "latency": (InjectionPoint.FELT, time.latency),
    "vibration": (InjectionPoint.FELT, time.vibration),
    "one_pole": (InjectionPoint.PASSED, time.one_pole),
    "bandwidth": (InjectionPoint.PASSED, time.bandwidth),
    "scale_factor": (InjectionPoint.GAIN, curve.scale_factor),
    "scale_asymmetry": (InjectionPoint.GAIN, curve.scale_asymmetry),
    "nonlinearity": (InjectionPoint.GAIN, curve.nonlinearity),
    "vibration_rectification": (InjectionPoint.GAIN, curve.vibration_rectification),
    "g_sensitivity": (InjectionPoint.GAIN, bias.g_sensitivity),
    "bias_instability": (InjectionPoint.GAIN, bias.bias_instability),
    "rate_random_walk": (InjectionPoint.GAIN, bias.rate_random_walk),
    "popcorn": (InjectionPoint.GAIN, bias.popcorn),
    "temp_bias": (InjectionPoint.GAIN, environment.temp_bias),
    "temp_scale": (InjectionPoint.GAIN, environment.temp_scale),
    "warmup": (InjectionPoint.GAIN, environment.warmup),
    "deadband": (InjectionPoint.OUTPUT, curve.deadband),
    "saturation": (InjectionPoint.OUTPUT, curve.saturation),
    "quantization": (InjectionPoint.OUTPUT, curve.quantization),
    "spikes": (InjectionPoint.OUTPUT, curve.spikes),
    "stale_hold": (InjectionPoint.READ, curve.stale_hold),
    "backlash": (InjectionPoint.ANGLE, reference.backlash),
    "encoder_eccentricity": (InjectionPoint.ANGLE, reference.encoder_eccentricity),
    "encoder_slip": (InjectionPoint.ANGLE, reference.encoder_slip),
    "encoder_quantization": (InjectionPoint.COUNTED, reference.encoder_quantization),
    "clock_drift": (InjectionPoint.STAMP, link.clock_drift),
    "timestamp_jitter": (InjectionPoint.STAMP, link.timestamp_jitter),
    "usb_batching": (InjectionPoint.ARRIVAL, link.usb_batching),
    "sample_drop": (InjectionPoint.ROWS, link.sample_drop),
    "motor_bias": (InjectionPoint.GAIN, outside_bias.motor_bias),
    "direction_memory": (InjectionPoint.GAIN, outside_bias.direction_memory),
    "stress_bias": (InjectionPoint.GAIN, outside_bias.stress_bias),
    "slow_cycle": (InjectionPoint.GAIN, outside_bias.slow_cycle),
    "cable_twist": (InjectionPoint.GAIN, outside_bias.cable_twist),
    "shake_bias": (InjectionPoint.GAIN, outside_bias.shake_bias),
    "temp_hysteresis": (InjectionPoint.GAIN, outside_bias.temp_hysteresis),
    "ripple": (InjectionPoint.GAIN, outside_bias.ripple),
    "ageing_gain": (InjectionPoint.GAIN, outside_gain.ageing_gain),
    "turn_on_gain": (InjectionPoint.GAIN, outside_gain.turn_on_gain),
    "gain_switch": (InjectionPoint.GAIN, outside_gain.gain_switch),
    "rate_noise": (InjectionPoint.GAIN, outside_gain.rate_noise),
    "noise_bursts": (InjectionPoint.GAIN, outside_gain.noise_bursts),
    "correlated_noise": (InjectionPoint.GAIN, outside_gain.correlated_noise),
    "gliding_tones": (InjectionPoint.GAIN, outside_gain.gliding_tones),
    "missing_codes": (InjectionPoint.OUTPUT, outside_gain.missing_codes),
    "encoder_harmonic": (InjectionPoint.ANGLE, outside_link.encoder_harmonic),
    "encoder_delay": (InjectionPoint.ANGLE, outside_link.encoder_delay),
    "clock_steps": (InjectionPoint.STAMP, outside_link.clock_steps),
    "host_wander": (InjectionPoint.ARRIVAL, outside_link.host_wander),
    "swapped_rows": (InjectionPoint.ROWS, outside_link.swapped_rows),
    "doubled_rows": (InjectionPoint.ROWS, outside_link.doubled_rows),
}
"""Order of effects within a point."""

ORDER = {name: number for number, name in enumerate(KINDS)}


@dataclass(frozen=True, slots=True)
class InjectedEffect:
    """An effect with its parameters, named as the catalogue names them where it is there."""

    name: str
    parameters: dict[str, float]
