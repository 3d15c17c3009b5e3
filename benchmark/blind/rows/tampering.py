"""Effects put into recordings: what a few lines of numpy do to the columns of a session, and nothing of anybody else's.

Sizes suit cheap devices at 19 to 286 Hz whose reference is good to half a degree: large, but not absurd.
"""

from collections.abc import Callable

import numpy as np
from gyrogap.physics.dice import Rng, sign
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.motion import Floats

from blind.rows.recordings import Rows

Tamper = Callable[..., Rows]


def _rated(rows: Rows, rate_dps: Floats) -> Rows:
    return rows.with_columns(rate_dps=rate_dps)


def scale_factor(rows: Rows, rng: Rng, *, error_percent: float) -> Rows:
    """Gain."""
    return _rated(rows, rows.columns["rate_dps"] * (1.0 + error_percent / 100.0))


def scale_asymmetry(rows: Rows, rng: Rng, *, error_percent: float) -> Rows:
    """Another gain for each direction."""
    rate_dps = rows.columns["rate_dps"]
    return _rated(rows, rate_dps + np.abs(rate_dps) * error_percent / 100.0)


def warmup(rows: Rows, rng: Rng, *, amplitude_dps: float, settle_s: float) -> Rows:
    """A bias that settles from power-on."""
    return _rated(rows, rows.columns["rate_dps"] + amplitude_dps * np.exp(-rows.t_s / settle_s))


def bandwidth(rows: Rows, rng: Rng, *, cutoff_hz: float) -> Rows:
    """An RC filter from stamp to stamp."""
    shares = 1.0 - np.exp(-2.0 * np.pi * cutoff_hz * np.diff(rows.t_s, prepend=rows.t_s[0]))
    level, passed = float(rows.columns["rate_dps"][0]), []
    for value, share in zip(rows.columns["rate_dps"].tolist(), shares.tolist(), strict=True):
        level += share * (value - level)
        passed.append(level)
    return _rated(rows, np.array(passed))


def latency(rows: Rows, rng: Rng, *, delay_ms: float) -> Rows:
    """The rate of a while ago."""
    return _rated(rows, np.interp(rows.t_s - delay_ms * 1e-3, rows.t_s, rows.columns["rate_dps"]))


def deadband(rows: Rows, rng: Rng, *, width_dps: float) -> Rows:
    """Small rates are zero."""
    rate_dps = rows.columns["rate_dps"]
    return _rated(rows, np.where(np.abs(rate_dps) < width_dps, 0.0, rate_dps))


def quantization(rows: Rows, rng: Rng, *, step_dps: float) -> Rows:
    """Coarser steps."""
    return _rated(rows, np.round(rows.columns["rate_dps"] / step_dps) * step_dps)


def stale_hold(rows: Rows, rng: Rng, *, share_percent: float) -> Rows:
    """Some rows repeat the rate of the one before."""
    is_fresh = rng.random(len(rows.t_s)) >= share_percent / 100.0
    is_fresh[0] = True
    last_fresh = np.maximum.accumulate(np.where(is_fresh, np.arange(len(is_fresh)), 0))
    return _rated(rows, rows.columns["rate_dps"][last_fresh])


def saturation(rows: Rows, rng: Rng, *, limit_dps: float) -> Rows:
    """The end of the range."""
    return _rated(rows, np.clip(rows.columns["rate_dps"], -limit_dps, limit_dps))


def spikes(rows: Rows, rng: Rng, *, height_dps: float, share_percent: float) -> Rows:
    """Wild samples either way."""
    wild = (rng.random(len(rows.t_s)) < share_percent / 100.0) * rng.choice([-1.0, 1.0], len(rows.t_s))
    return _rated(rows, rows.columns["rate_dps"] + height_dps * wild)


def vibration(rows: Rows, rng: Rng, *, amplitude_dps: float, frequency_hz: float) -> Rows:
    """A tone."""
    phase = 2.0 * np.pi * (frequency_hz * rows.t_s + rng.random())
    return _rated(rows, rows.columns["rate_dps"] + amplitude_dps * np.sin(phase))


def backlash(rows: Rows, rng: Rng, *, play_deg: float) -> Rows:
    """The reference follows when the play is used up."""
    held_deg, followed = float(rows.columns["encoder_deg"][0]), []
    for angle_deg in rows.columns["encoder_deg"].tolist():
        held_deg = min(max(held_deg, angle_deg - play_deg / 2.0), angle_deg + play_deg / 2.0)
        followed.append(held_deg)
    return rows.with_columns(encoder_deg=np.array(followed))


def encoder_quantization(rows: Rows, rng: Rng, *, cpr: float) -> Rows:
    """Fewer counts."""
    return rows.with_columns(encoder_deg=np.floor(rows.columns["encoder_deg"] * cpr / 360.0) * 360.0 / cpr)


def timestamp_jitter(rows: Rows, rng: Rng, *, sigma_ms: float) -> Rows:
    """Stamps scatter and stay in order."""
    scattered_s = rows.t_s + sigma_ms * 1e-3 * rng.standard_normal(len(rows.t_s))
    return rows.with_columns(t_device_s=np.maximum.accumulate(scattered_s - scattered_s.min()))


def sample_drop(rows: Rows, rng: Rng, *, share_percent: float) -> Rows:
    """Rows that never came."""
    return rows.only(rng.random(len(rows.t_s)) >= share_percent / 100.0)


MOVING: dict[str, Tamper] = {
    "scale_factor": scale_factor,
    "scale_asymmetry": scale_asymmetry,
    "bandwidth": bandwidth,
    "latency": latency,
    "deadband": deadband,
    "saturation": saturation,
    "backlash": backlash,
    "encoder_quantization": encoder_quantization,
}
"""What shows where something moves."""

ANYWHERE: dict[str, Tamper] = {
    "warmup": warmup,
    "quantization": quantization,
    "stale_hold": stale_hold,
    "spikes": spikes,
    "vibration": vibration,
    "timestamp_jitter": timestamp_jitter,
    "sample_drop": sample_drop,
}
"""What shows at rest too."""

COUNTED = ("sample_drop",)
"""What shows in a counter alone."""


def draw_tampering(rng: Rng, name: str, rate_hz: float, top_dps: float) -> InjectedEffect:
    """An effect at a size that suits a device of this rate and this speed."""
    interval_ms, near = 1000.0 / rate_hz, rng.uniform(0.8, 1.2)
    parameters = {
        "scale_factor": {"error_percent": 4.0 * near * sign(rng)},
        "scale_asymmetry": {"error_percent": 3.0 * near * sign(rng)},
        "warmup": {"amplitude_dps": 2.0 * near * sign(rng), "settle_s": 10.0 * near},
        "bandwidth": {"cutoff_hz": 1.5 * near},
        "latency": {"delay_ms": 60.0 * near},
        "deadband": {"width_dps": 2.0 * near},
        "quantization": {"step_dps": 1.5 * near},
        "stale_hold": {"share_percent": 15.0 * near},
        "saturation": {"limit_dps": 0.4 * top_dps * near},
        "spikes": {"height_dps": 40.0 * near, "share_percent": 0.5},
        "vibration": {"amplitude_dps": 3.0 * near, "frequency_hz": 0.3 * rate_hz * near},
        "backlash": {"play_deg": 2.0 * near},
        "encoder_quantization": {"cpr": float(round(180.0 * near))},
        "timestamp_jitter": {"sigma_ms": 0.35 * interval_ms * near},
        "sample_drop": {"share_percent": 8.0 * near},
    }[name]
    return InjectedEffect(name, {key: float(f"{value:.4g}") for key, value in parameters.items()})


def tamper(rows: Rows, fault: InjectedEffect, rng: Rng) -> Rows:
    """The recording with the effect in it."""
    return (MOVING | ANYWHERE)[fault.name](rows, rng, **fault.parameters)
