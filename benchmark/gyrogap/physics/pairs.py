"""Two effects at a time: such that hide each other, and such that do not."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class EffectPair:
    """Names, sizes and, where it is the signs that make them hide each other, the signs; None leaves it to the seed."""

    first: str
    second: str
    sizes: tuple[str, str] = ("typical", "typical")
    ways: tuple[float | None, float | None] = (None, None)


OPPOSITE = (1.0, -1.0)
BOTH_LARGE = ("large", "large")

PAIRS = (
    EffectPair("clock_drift", "scale_factor", ("large", "typical"), OPPOSITE),
    EffectPair("clock_drift", "scale_factor", ("typical", "typical"), (-1.0, 1.0)),
    EffectPair("scale_asymmetry", "g_sensitivity"),
    EffectPair("scale_asymmetry", "vibration_rectification", BOTH_LARGE, OPPOSITE),
    EffectPair("warmup", "temp_bias", ("large", "typical"), OPPOSITE),
    EffectPair("latency", "bandwidth"),
    EffectPair("scale_factor", "temp_scale", ("typical", "large"), OPPOSITE),
    EffectPair("scale_factor", "nonlinearity", ("typical", "large"), OPPOSITE),
    EffectPair("backlash", "latency"),
    EffectPair("g_sensitivity", "encoder_eccentricity", ("large", "typical")),
    EffectPair("timestamp_jitter", "usb_batching", ("typical", "large")),
    EffectPair("deadband", "quantization", ("large", "typical")),
    EffectPair("spikes", "encoder_slip"),
    EffectPair("rate_random_walk", "warmup", ("typical", "large")),
    EffectPair("bias_instability", "temp_bias"),
    EffectPair("scale_factor", "sample_drop"),
    EffectPair("temp_bias", "clock_drift"),
    EffectPair("latency", "usb_batching", ("large", "typical")),
    EffectPair("vibration", "encoder_eccentricity"),
    EffectPair("saturation", "warmup", ("typical", "large")),
    EffectPair("stale_hold", "temp_bias", ("large", "large")),
    EffectPair("encoder_quantization", "scale_factor", ("large", "typical")),
    EffectPair("popcorn", "scale_asymmetry", BOTH_LARGE),
    EffectPair("bandwidth", "clock_drift", ("large", "typical")),
)
