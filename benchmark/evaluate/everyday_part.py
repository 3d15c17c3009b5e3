"""Filters on everyday motions, everything at its defaults: mean E, harm, and what a memory gives a start in motion."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from evaluate.everyday_motions import MOTIONS, Dice, Session, session
from evaluate.figures import Figure, mean_figure, share_figure
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.evaluation.kernels.restlevel import _follow, array_of
from gyrodrift.filters.restlevel.memory import RestlevelMemory, begun, learned
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.values.arrays import Floats

HARM, HARMLESS_DEG = 1.5, 0.5
"""Restlevel harms where its E is above 1.5 times the better of the plain two, and of half a degree."""

OWN, PLAIN = ("restlevel", "hdr"), ("euler", "start")
OTHERS = ("kalman", "xio", "vqf")
"""Shown beside our own filters while measuring; their figures are not ours to keep."""

BY_KEY = by_key()
SHORTEST_PERIOD_S = 0.06
"""At 20 Hz and more, 20 s can be a sure rest."""


@dataclass(frozen=True, slots=True)
class _Errors:
    """E in deg by method, an array of the sessions of a motion."""

    name: str
    is_still: bool
    e_deg: dict[str, Floats]

    @property
    def harmed(self) -> int:
        """Number of sessions in which restlevel harms."""
        plain_deg = np.maximum(HARMLESS_DEG, np.minimum(self.e_deg["euler"], self.e_deg["start"]))
        return int((self.e_deg["restlevel"] > HARM * plain_deg).sum())


def measure(seed: int, count: int, folder: Path, say: Callable[[str], None]) -> list[Figure]:
    """Mean E by motion of our filters, the share of sessions harmed, and E of starts in motion with a memory."""
    rows = [_errors(motion, seed, count, is_still=still) for motion in MOTIONS for still in (True, False)]
    for row in rows:
        say(f"{row.name}: " + ", ".join(f"{BY_KEY[key].title} {e_deg.mean():.3g}" for key, e_deg in row.e_deg.items()))
    means = [mean_figure(f"{row.name}: E of {key} in deg", row.e_deg[key].tolist()) for row in rows for key in OWN]
    return [*means, *(_harm(rows, is_still=still) for still in (True, False)), *_memory_figures(seed, count)]


def _errors(motion: str, seed: int, count: int, *, is_still: bool) -> _Errors:
    sessions = [session(motion, number, is_still=is_still, seed=seed) for number in range(count)]
    keys = [key for key in (*PLAIN, *OWN, *OTHERS) if BY_KEY[key].is_installed]
    e_deg = {key: np.array([error_of(key, one) for one in sessions]) for key in keys}
    return _Errors(f"{motion}, {'still' if is_still else 'moving'}", is_still, e_deg)


def error_of(method: str, one: Session) -> float:
    """Mean |yaw error| in deg at its defaults."""
    found = BY_KEY[method].run(one.t_s, one.rate_dps, BY_KEY[method].defaults)
    return float(np.abs(found - one.yaw_deg).mean())


def _harm(rows: list[_Errors], *, is_still: bool) -> Figure:
    chosen = [row for row in rows if row.is_still == is_still]
    sessions = sum(len(row.e_deg["restlevel"]) for row in chosen)
    name = f"restlevel does harm, {'still' if is_still else 'moving'} at first"
    return share_figure(name, sum(row.harmed for row in chosen), sessions, is_less_better=True)


def _memory_figures(seed: int, count: int) -> list[Figure]:
    """Starts in motion with a memory of 5 s, and with one of an hour and another turn-on bias."""
    found = [errors for motion in MOTIONS for number in range(count) if (errors := _with_memory(motion, seed, number))]
    names = ("moving, memory of 5 s", "moving, memory of an hour and another start")
    return [
        mean_figure(f"{name}: E of restlevel in deg", list(e_deg))
        for name, e_deg in zip(names, zip(*found, strict=True), strict=True)
    ]


def _with_memory(motion: str, seed: int, number: int) -> tuple[float, float] | None:
    """E in deg with either memory; None where 20 s at rest are not enough for a memory."""
    one, dice = session(motion, number, is_still=False, seed=seed), np.random.default_rng([seed + 2, number])
    if one.t_s[1] > SHORTEST_PERIOD_S:
        return None
    now, hour = _memory_of(one, 0.0, dice), _memory_of(one, 0.05, dice)
    if now is None or hour is None:
        return None
    return _error_with(now, one, 5.0), _error_with(hour, one, 3600.0)


def _memory_of(one: Session, turn_on_dps: float, dice: Dice) -> RestlevelMemory | None:
    """After 20 s at rest, at a bias that is `turn_on_dps` (a standard deviation) off; None if that was no sure rest."""
    rate_hz, before = 1.0 / one.t_s[1], RestlevelState()
    c, samples = coefficients(RestlevelParams()), round(20.0 * rate_hz)
    noise_dps = max(0.02, 0.02 * np.sqrt(rate_hz / 2.0)) * dice.standard_normal(samples)
    for n, dps in enumerate((one.bias_dps + turn_on_dps * dice.standard_normal() + noise_dps).tolist()):
        step(c, before, n / rate_hz, dps)
    return learned(before, None, 0.0)


def _error_with(memory: RestlevelMemory, one: Session, age_s: float) -> float:
    """E in deg of restlevel that begins with a memory of this age."""
    params, found, nothing = RestlevelParams(), np.zeros((3, len(one.t_s))), np.empty(0)
    state = array_of(begun(params, memory, age_s, None))
    _follow(array_of(coefficients(params)), state, np.diff(one.t_s, prepend=0.0), one.rate_dps, nothing, nothing, found)
    return float(np.abs(found[0] - one.yaw_deg).mean())
