"""Two effects at a time: such that hide each other, and such that do not."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Pair:
    """Names, sizes and, where it is the signs that make them hide each other, the signs; None leaves it to the seed."""

    first: str
    second: str
    sizes: tuple[str, str] = ("typical", "typical")
    ways: tuple[float | None, float | None] = (None, None)


OPPOSITE = (1.0, -1.0)
BOTH_LARGE = ("large", "large")

PAIRS = (
    Pair("clock_drift", "scale_factor", ("large", "typical"), OPPOSITE),
    Pair("clock_drift", "scale_factor", ("typical", "typical"), (-1.0, 1.0)),
    Pair("scale_asymmetry", "g_sensitivity"),
    Pair("scale_asymmetry", "vibration_rectification", BOTH_LARGE, OPPOSITE),
    Pair("warmup", "temp_bias", ("large", "typical"), OPPOSITE),
    Pair("latency", "bandwidth"),
    Pair("scale_factor", "temp_scale", ("typical", "large"), OPPOSITE),
    Pair("scale_factor", "nonlinearity", ("typical", "large"), OPPOSITE),
    Pair("backlash", "latency"),
    Pair("g_sensitivity", "encoder_eccentricity", ("large", "typical")),
    Pair("timestamp_jitter", "usb_batching", ("typical", "large")),
    Pair("deadband", "quantization", ("large", "typical")),
    Pair("spikes", "encoder_slip"),
    Pair("rate_random_walk", "warmup", ("typical", "large")),
    Pair("bias_instability", "temp_bias"),
    Pair("scale_factor", "sample_drop"),
    Pair("temp_bias", "clock_drift"),
    Pair("latency", "usb_batching", ("large", "typical")),
    Pair("vibration", "encoder_eccentricity"),
    Pair("saturation", "warmup", ("typical", "large")),
    Pair("stale_hold", "temp_bias", ("large", "large")),
    Pair("encoder_quantization", "scale_factor", ("large", "typical")),
    Pair("popcorn", "scale_asymmetry", BOTH_LARGE),
    Pair("bandwidth", "clock_drift", ("large", "typical")),
)
