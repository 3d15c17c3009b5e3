"""Effects that are one and the same in what was recorded: no likelihood tells them apart there.

A disc off its centre makes the angle err once per turn, and so its rate in proportion to the speed; gravity makes the
rate itself err once per turn. At one speed, whatever its sign, that is one effect.

A device that warms by itself has a temperature that follows from the time since power-on alone. A bias by temperature
is a warm-up then; a warm-up may be quicker or slower than that.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.regimes import Regimes
from gyrodrift.diagnose.inference.alternatives import Alternatives, Rival

Same = Mapping[str, str]
"""Names of effects, and of those that they cannot be told from."""

AT_ONE_SPEED: Same = {"g_sensitivity": "encoder_eccentricity", "encoder_eccentricity": "g_sensitivity"}
AT_ONE_HEATING: Same = {"temp_bias": "warmup"}

LIKE_ONE = 1.3
"""Speeds whose 5 % and 95 % quantiles have no larger ratio are one speed."""

DECAYS_S = np.geomspace(15.0, 900.0, 40)
"""Time constants that the warming of a device may have."""

OTHER_SHARE = 0.003
"""Of the variance of the temperature: air that changes it by less, a twentieth of its amplitude, tells nothing."""

MOST_WARMING_C = 40.0
"""By which a device may warm: late after power-on a slope in the air is no end of that."""


class Heating(NamedTuple):
    """Temperatures of a session, °C, at times since power-on, s; shape (n,) each."""

    powered_s: Floats
    sensor_c: Floats


def is_one_speed(motions: Sequence[Regimes]) -> bool:
    """Whether all sessions together turn at one speed."""
    speeds_dps = np.abs(np.concatenate([one.speed_dps[one.is_turning] for one in motions]))
    if not len(speeds_dps):
        return False
    slow_dps, fast_dps = np.quantile(speeds_dps, [0.05, 0.95])
    return bool(fast_dps < LIKE_ONE * slow_dps)


def is_one_heating(sessions: Sequence[Heating]) -> bool:
    """Whether the temperature of all sessions is one decay since power-on, each about a level of its own."""
    temps_c = _centred([one.sensor_c for one in sessions])
    decays = (_centred([np.exp(-one.powered_s / decay_s) for one in sessions]) for decay_s in DECAYS_S)
    return min(_left(temps_c, decay) for decay in decays) < OTHER_SHARE * float(temps_c @ temps_c)


def tied_where_same(every: Sequence[Alternatives], tried: Sequence[str], same: Same) -> tuple[Alternatives, ...]:
    """Alternatives in which each cause is tied with what it cannot be told from, where that was tried."""
    return tuple(_tied(one, same[one.cause.name]) if same.get(one.cause.name) in tried else one for one in every)


def _tied(one: Alternatives, other: str) -> Alternatives:
    others = tuple(rival for rival in one.rivals if rival.name != other)
    return replace(one, rivals=(Rival(other, 0.0, is_out_of_catalogue=False, is_kin=True), *others))


def _centred(sessions: Sequence[Floats]) -> Floats:
    """All values behind one another, less the mean of their session."""
    return np.concatenate([values - values.mean() for values in sessions])


def _left(values: Floats, decay: Floats) -> float:
    """Sum of squares that a decay from what a device warms by leaves."""
    amplitude_c = float(values @ decay) / max(float(decay @ decay), np.finfo(float).tiny)
    left = values - np.clip(amplitude_c, -MOST_WARMING_C, MOST_WARMING_C) * decay
    return float(left @ left)
