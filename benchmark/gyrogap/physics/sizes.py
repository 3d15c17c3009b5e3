"""How large an effect is: small, typical, large, each varied by the seed.

Small is about three times what the data leave uncertain of that effect, where 0.03 % of scale and 0.3 ms of lag count
as uncertain: less does not matter for yaw.
"""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from math import exp, log, sqrt

from gyrogap.physics.dice import Rng, sign
from gyrogap.physics.kinds import InjectedEffect

SIZES = ("small", "typical", "large")

FACTORS = (0.8, 1.2)
"""Range from which the factor of a size is drawn."""


@dataclass(frozen=True, slots=True)
class EffectSizes:
    """The strength of an effect at three sizes.

    spread
        How far it varies: 1 for 20 %, less where that would make it vanish or hit the next count.
    signed
        Whether it goes either way.
    """

    parameter: str
    sizes: tuple[float, float, float]
    spread: float = 1.0
    signed: bool = False


STRENGTHS = {
    "scale_factor": EffectSizes("error_percent", (0.1, 1.0, 3.0), signed=True),
    "scale_asymmetry": EffectSizes("error_percent", (0.06, 0.3, 1.0), signed=True),
    "nonlinearity": EffectSizes("error_percent_fs", (0.03, 0.1, 0.3), signed=True),
    "deadband": EffectSizes("width_dps", (0.05, 0.2, 0.6)),
    "saturation": EffectSizes("limit_dps", (170.0, 125.0, 90.0), spread=0.3),
    "quantization": EffectSizes("step_dps", (0.032, 0.0625, 0.25)),
    "bandwidth": EffectSizes("cutoff_hz", (45.0, 15.0, 5.0)),
    "latency": EffectSizes("delay_ms", (1.5, 8.0, 25.0)),
    "bias_instability": EffectSizes("floor_dph", (8.0, 30.0, 100.0)),
    "rate_random_walk": EffectSizes("density_dps_rts", (0.0005, 0.003, 0.01)),
    "popcorn": EffectSizes("step_dps", (0.015, 0.06, 0.25)),
    "spikes": EffectSizes("height_dps", (1.0, 20.0, 150.0)),
    "vibration": EffectSizes("amplitude_dps", (0.03, 0.2, 1.0)),
    "vibration_rectification": EffectSizes("bias_dps_at_100_dps", (0.01, 0.05, 0.2), signed=True),
    "g_sensitivity": EffectSizes("amplitude_dps", (0.008, 0.03, 0.1)),
    "temp_bias": EffectSizes("slope_dps_per_c", (0.003, 0.02, 0.1), signed=True),
    "temp_scale": EffectSizes("slope_percent_per_c", (0.008, 0.02, 0.06), signed=True),
    "warmup": EffectSizes("amplitude_dps", (0.03, 0.1, 0.4), signed=True),
    "backlash": EffectSizes("play_deg", (0.02, 0.08, 0.4)),
    "encoder_eccentricity": EffectSizes("amplitude_deg", (0.04, 0.3, 1.2)),
    "encoder_slip": EffectSizes("step_deg", (0.06, 0.3, 2.0)),
    "encoder_quantization": EffectSizes("cpr", (14000.0, 4096.0, 720.0), spread=0.7),
    "clock_drift": EffectSizes("ppm", (60.0, 600.0, 10000.0), signed=True),
    "timestamp_jitter": EffectSizes("sigma_ms", (0.06, 0.5, 3.0)),
    "usb_batching": EffectSizes("interval_ms", (4.0, 16.0, 64.0)),
    "sample_drop": EffectSizes("share_percent", (0.02, 0.3, 2.0)),
    "stale_hold": EffectSizes("share_percent", (0.06, 0.5, 4.0)),
}


def _phase(rng: Rng, strength: float) -> dict[str, float]:
    return {"phase_deg": rng.uniform(-180.0, 180.0)}


def _curve(rng: Rng, strength: float) -> dict[str, float]:
    return {"curve_dps_per_c2": strength * rng.uniform(0.006, 0.015) * sign(rng)}


def _settling(rng: Rng, strength: float) -> dict[str, float]:
    return {
        "fast_s": rng.uniform(20.0, 45.0),
        "slow_s": rng.uniform(100.0, 220.0),
        "fast_share": rng.uniform(0.25, 0.5),
    }


def _dwell(rng: Rng, strength: float) -> dict[str, float]:
    return {"dwell_s": rng.uniform(10.0, 40.0), "dwell_shape": float(rng.choice([1.0, 1.0, 3.0]))}


def _often(rng: Rng, strength: float) -> dict[str, float]:
    return {"per_hour": rng.uniform(20.0, 60.0)}


def _outliers(rng: Rng, strength: float) -> dict[str, float]:
    return {"share_percent": (0.05 if strength < 5.0 else 0.15) * rng.uniform(0.7, 1.4)}


def _tone(rng: Rng, strength: float) -> dict[str, float]:
    """Not near a multiple of 12.5 Hz, where a sampler of 50, 100 or 200 Hz would see a slow bias."""
    return {"frequency_hz": 12.5 * (int(rng.integers(1, 23)) + rng.uniform(0.4, 0.6))}


REST: dict[str, Callable[[Rng, float], dict[str, float]]] = {
    "popcorn": _dwell,
    "spikes": _outliers,
    "vibration": _tone,
    "g_sensitivity": _phase,
    "encoder_eccentricity": _phase,
    "temp_bias": _curve,
    "warmup": _settling,
    "encoder_slip": _often,
}
"""Parameters of an effect apart from its strength."""


def draw_strength(rng: Rng, name: str, size: str) -> float:
    """Strength of an effect, every octave as likely, within the range of a size.

    The ranges of neighboring sizes meet halfway between them on a logarithmic scale, so a strength tells no size.
    """
    sized, index = STRENGTHS[name], SIZES.index(size)
    ends = [sqrt(low * high) for low, high in pairwise(sized.sizes)]
    first, last = (
        sized.sizes[0] * (ends[0] / sized.sizes[0]) ** -EDGE,
        sized.sizes[-1] * (sized.sizes[-1] / ends[-1]) ** EDGE,
    )
    low, high = sorted((first, *ends, last)[index : index + 2])
    return float(exp(rng.uniform(log(low), log(high))))


EDGE = 0.2
"""Share of half the distance to the next size by which the smallest and the largest strength lie beyond theirs."""


def varied(rng: Rng, value: float, spread: float) -> float:
    """A value times a random factor."""
    return value * (1.0 + spread * (rng.uniform(*FACTORS) - 1.0))


def draw_fault(
    rng: Rng, name: str, size: str, way: float | None = None, strength: float | None = None
) -> InjectedEffect:
    """An effect of the catalogue at a size; `way` is its sign, where a sign makes sense.

    strength
        Its strength without a sign; None draws one near the size.
    """
    sized = STRENGTHS[name]
    if strength is None:
        strength = varied(rng, sized.sizes[SIZES.index(size)], sized.spread)
    strength = round(strength) if sized.parameter == "cpr" else float(f"{strength:.4g}")
    drawn = sign(rng)
    signed = strength * (drawn if way is None else way) if sized.signed else strength
    rest = REST[name](rng, signed) if name in REST else {}
    return InjectedEffect(name, {sized.parameter: signed, **{key: round(value, 6) for key, value in rest.items()}})
