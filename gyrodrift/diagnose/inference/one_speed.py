"""Effects that are one and the same in a device that turns at one speed: no likelihood tells them apart there.

A disc off its centre makes the angle err once per turn, and so its rate in proportion to the speed; gravity makes the
rate itself err once per turn. At one speed, whatever its sign, that is one effect.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from gyrodrift.diagnose.features.regimes import Regimes
from gyrodrift.diagnose.inference.alternatives import Alternatives, Rival

ALIKE = frozenset({"g_sensitivity", "encoder_eccentricity"})

LIKE_ONE = 1.3
"""Speeds whose 5 % and 95 % quantiles have no larger ratio are one speed."""


def is_one_speed(motions: Sequence[Regimes]) -> bool:
    """Whether all sessions together turn at one speed."""
    speeds_dps = np.abs(np.concatenate([one.speed_dps[one.is_turning] for one in motions]))
    if not len(speeds_dps):
        return False
    slow_dps, fast_dps = np.quantile(speeds_dps, [0.05, 0.95])
    return bool(fast_dps < LIKE_ONE * slow_dps)


def tied_at_one_speed(every: Sequence[Alternatives], tried: Sequence[str]) -> tuple[Alternatives, ...]:
    """Alternatives in which causes of ALIKE are tied with the others of them that were tried."""
    return tuple(_tied(one, sorted(ALIKE.intersection(tried) - {one.cause.name})) for one in every)


def _tied(one: Alternatives, alike: Sequence[str]) -> Alternatives:
    if one.cause.name not in ALIKE:
        return one
    others = tuple(rival for rival in one.rivals if rival.name not in alike)
    return replace(one, rivals=(*(Rival(name, 0.0, is_out_of_catalogue=False) for name in alike), *others))
