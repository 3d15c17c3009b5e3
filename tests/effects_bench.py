"""Helpers for tests of effects: a rig played into arrays, least squares, and sizes of an effect.

Nothing here knows how an effect acts: the truth is the profile's, the rest is what the bench gave out.
"""

from dataclasses import dataclass
from itertools import islice
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect, Floats
from firmware_sim.measure import measure
from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Base, Rig, load_rig, with_effects

SHIPPED = load_rig(None).base
FINE = Base(noise_dps_rthz=0.0, dps_per_lsb=1e-5)
"""No noise and a count of 1e-5 deg/s: for a table at rest, since it ends at 0.33 deg/s."""

REST: list[dict[str, Any]] = [{"kind": "rest", "seconds": 100.0}]


@dataclass(frozen=True, slots=True)
class Record:
    """Measurements beside the truth; every array has the shape (n,).

    t_s, angle_deg, true_dps
        When each was taken, and what the table did then.
    seq, t_device_us, t_host_s, rate_dps, temp_c, encoder_deg
        What came out.
    """

    t_s: Floats
    angle_deg: Floats
    true_dps: Floats
    seq: NDArray[np.int64]
    t_device_us: NDArray[np.int64]
    t_host_s: Floats
    rate_dps: Floats
    temp_c: Floats
    encoder_deg: Floats

    @property
    def error_dps(self) -> Floats:
        return self.rate_dps - self.true_dps

    @property
    def encoder_error_deg(self) -> Floats:
        return self.encoder_deg - self.angle_deg


def record(rig: Rig, profile: Profile, seconds: float, seed: int = 0, block_samples: int = 4096) -> Record:
    """The first `seconds` of a session."""
    count = round(seconds * rig.base.sample_rate_hz)
    blocks = list(islice(measure(rig, profile, seed, block_samples=block_samples), -(-count // block_samples)))

    def joined(name: str) -> NDArray[Any]:
        return np.concatenate([getattr(block, name) for block in blocks])

    kept = joined("seq") < count
    t_s = joined("seq")[kept] / rig.base.sample_rate_hz
    angle_deg, true_dps = profile.motion_at(t_s)
    return Record(
        t_s=t_s,
        angle_deg=angle_deg,
        true_dps=true_dps,
        seq=joined("seq")[kept],
        t_device_us=joined("t_device_us")[kept],
        t_host_s=joined("t_host_s")[kept],
        rate_dps=joined("rate_raw")[kept] * rig.base.dps_per_lsb,
        temp_c=joined("temp_centi_c")[kept] / 100.0,
        encoder_deg=joined("encoder_counts")[kept] * (360.0 / max(rig.base.encoder_cpr, 1)),
    )


def rig_of(*effects: Effect | None, base: Base = SHIPPED) -> Rig:
    return with_effects(Rig(base=base), [effect for effect in effects if effect is not None])


def profile_of(*segments: dict[str, Any], **fields: Any) -> Profile:
    return Profile.model_validate({"about": "Of a test.", "segments": segments, **fields})


def effect_of(name: str, size: str = "typical") -> Effect:
    """An effect of its small or typical size."""
    return CATALOGUE[name].model_validate(getattr(CATALOGUE[name], size))


def sized(name: str) -> pytest.MarkDecorator:
    """The test runs without the effect, at its small size and at its typical size."""
    effects = [None, effect_of(name, "small"), effect_of(name, "typical")]
    return pytest.mark.parametrize("effect", effects, ids=["off", "small", "typical"])


def put_in(effect: Effect | None, parameter: str) -> float:
    """The parameter that the rig has; 0 where the effect is off."""
    return 0.0 if effect is None else float(getattr(effect, parameter))


def phasor(effect: Effect | None, amplitude: str) -> complex:
    """Amplitude and `phase_deg` of an effect as one complex number; 0 where it is off."""
    phase_deg = put_in(effect, "phase_deg")
    return put_in(effect, amplitude) * complex(np.exp(1j * np.deg2rad(phase_deg)))


def fitted(values: Floats, *regressors: Floats | float) -> Floats:
    """Coefficients of least squares, one for each regressor, a number standing for a constant one."""
    columns = np.column_stack([np.broadcast_to(regressor, values.shape) for regressor in regressors])
    coefficients: Floats = np.linalg.lstsq(columns, values, rcond=None)[0]
    return coefficients


def tone(values: Floats, t_s: Floats, frequency_hz: float) -> complex:
    """a·exp(jφ) of the part a·sin(2πft + φ), by least squares beside a constant."""
    turn = 2.0 * np.pi * frequency_hz * t_s
    _, sine, cosine = fitted(values, 1.0, np.sin(turn), np.cos(turn))
    return complex(sine, cosine)


def means(values: Floats, count: int) -> Floats:
    """Means over runs of `count` values; what is left at the end is not used."""
    whole = values[: len(values) // count * count]
    averaged: Floats = whole.reshape(-1, count).mean(axis=1)
    return averaged


def once_per_turn(values: Floats, angle_deg: Floats) -> complex:
    """a·exp(jφ) of the part a·sin(θ + φ)."""
    return tone(values, angle_deg / 360.0, 1.0)


def share_bound(share: float, count: int) -> float:
    """Five standard errors of a share that was counted over `count` trials."""
    return float(5.0 * np.sqrt(share * (1.0 - share) / count))
