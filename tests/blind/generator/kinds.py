"""Every effect by name: where it acts, and how."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import IntEnum

from blind.generator import environment, link, outside_bias, outside_gain, outside_link, reference
from blind.generator import sensor_bias as bias
from blind.generator import sensor_curve as curve
from blind.generator import sensor_time as time
from blind.generator.motion import Floats


class Place(IntEnum):
    """What an effect is handed.

    SEEN     the rate that the gyro feels, on the fine grid
    PASSED   the same, and noise of its own, through the filters of the sensor, on the fine grid
    GAIN     the sampled rate
    OUTPUT   the rate with noise and bias
    READ     the rate in whole counts, as it is read out
    ANGLE    the angle of the encoder's shaft, on the fine grid
    COUNTED  the angle at the samples
    STAMP    device times
    ARRIVAL  host times
    ROWS     numbers of the samples, in the order in which they come
    """

    SEEN = 0
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

KINDS: dict[str, tuple[Place, Act]] = {
    "latency": (Place.SEEN, time.latency),
    "vibration": (Place.SEEN, time.vibration),
    "one_pole": (Place.PASSED, time.one_pole),
    "bandwidth": (Place.PASSED, time.bandwidth),
    "scale_factor": (Place.GAIN, curve.scale_factor),
    "scale_asymmetry": (Place.GAIN, curve.scale_asymmetry),
    "nonlinearity": (Place.GAIN, curve.nonlinearity),
    "vibration_rectification": (Place.GAIN, curve.vibration_rectification),
    "g_sensitivity": (Place.GAIN, bias.g_sensitivity),
    "bias_instability": (Place.GAIN, bias.bias_instability),
    "rate_random_walk": (Place.GAIN, bias.rate_random_walk),
    "popcorn": (Place.GAIN, bias.popcorn),
    "temp_bias": (Place.GAIN, environment.temp_bias),
    "temp_scale": (Place.GAIN, environment.temp_scale),
    "warmup": (Place.GAIN, environment.warmup),
    "deadband": (Place.OUTPUT, curve.deadband),
    "saturation": (Place.OUTPUT, curve.saturation),
    "quantization": (Place.OUTPUT, curve.quantization),
    "spikes": (Place.OUTPUT, curve.spikes),
    "stale_hold": (Place.READ, curve.stale_hold),
    "backlash": (Place.ANGLE, reference.backlash),
    "encoder_eccentricity": (Place.ANGLE, reference.encoder_eccentricity),
    "encoder_slip": (Place.ANGLE, reference.encoder_slip),
    "encoder_quantization": (Place.COUNTED, reference.encoder_quantization),
    "clock_drift": (Place.STAMP, link.clock_drift),
    "timestamp_jitter": (Place.STAMP, link.timestamp_jitter),
    "usb_batching": (Place.ARRIVAL, link.usb_batching),
    "sample_drop": (Place.ROWS, link.sample_drop),
    "motor_bias": (Place.GAIN, outside_bias.motor_bias),
    "direction_memory": (Place.GAIN, outside_bias.direction_memory),
    "stress_bias": (Place.GAIN, outside_bias.stress_bias),
    "slow_cycle": (Place.GAIN, outside_bias.slow_cycle),
    "cable_twist": (Place.GAIN, outside_bias.cable_twist),
    "shake_bias": (Place.GAIN, outside_bias.shake_bias),
    "temp_hysteresis": (Place.GAIN, outside_bias.temp_hysteresis),
    "ripple": (Place.GAIN, outside_bias.ripple),
    "ageing_gain": (Place.GAIN, outside_gain.ageing_gain),
    "turn_on_gain": (Place.GAIN, outside_gain.turn_on_gain),
    "gain_switch": (Place.GAIN, outside_gain.gain_switch),
    "rate_noise": (Place.GAIN, outside_gain.rate_noise),
    "noise_bursts": (Place.GAIN, outside_gain.noise_bursts),
    "correlated_noise": (Place.GAIN, outside_gain.correlated_noise),
    "gliding_tones": (Place.GAIN, outside_gain.gliding_tones),
    "missing_codes": (Place.OUTPUT, outside_gain.missing_codes),
    "encoder_harmonic": (Place.ANGLE, outside_link.encoder_harmonic),
    "encoder_delay": (Place.ANGLE, outside_link.encoder_delay),
    "clock_steps": (Place.STAMP, outside_link.clock_steps),
    "host_wander": (Place.ARRIVAL, outside_link.host_wander),
    "swapped_rows": (Place.ROWS, outside_link.swapped_rows),
    "doubled_rows": (Place.ROWS, outside_link.doubled_rows),
}
"""Within a place they act in this order."""

ORDER = {name: number for number, name in enumerate(KINDS)}


@dataclass(frozen=True, slots=True)
class Fault:
    """An effect with its parameters, named as the catalogue names them where it is there."""

    name: str
    parameters: dict[str, float]
