"""What a tuning found and how good it is, as values: what the files and the report are made of."""

from dataclasses import dataclass, field

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.dataset import Split
from gyrodrift.evaluation.space import Axis
from gyrodrift.evaluation.tunables import Tunable
from gyrodrift.filters.registry import Params


@dataclass(frozen=True, slots=True)
class SessionScore:
    """One session under the filter: E in deg (equation 10) and NE, E over the true duration, in deg/min (11).

    euler, tuned, few
        Plain integration; the tuned filter; the filter with few of its parameters tuned.
    digest
        SHA-256 of the session's content.
    """

    name: str
    split: Split
    minutes: float
    e_euler_deg: float
    e_tuned_deg: float
    e_few_deg: float
    digest: str = ""

    @property
    def ne_euler(self) -> float:
        """Of plain integration, deg/min."""
        return self.e_euler_deg / self.minutes

    @property
    def ne_tuned(self) -> float:
        """Of the tuned filter, deg/min."""
        return self.e_tuned_deg / self.minutes


@dataclass(frozen=True, slots=True)
class Pi:
    """Equation 9 in deg² on the training and the test sessions; None where none were kept apart."""

    train: float
    test: float | None


@dataclass(frozen=True, slots=True)
class Run:
    """One search: its seed, every cost in deg², shape (n,), the points asked, shape (n, axes), and what it found.

    densities
        Of the automata over their axes at the end, shape (axes, GRID); None for methods without automata.
    """

    seed: int
    history: Floats
    cube: Floats
    params: Params
    pi: Pi
    densities: Floats | None = None


@dataclass(frozen=True, slots=True)
class Curve:
    """Yaw error of a session over time, thinned for a picture: minutes, and deg for plain integration and filter."""

    name: str
    split: Split
    minutes: Floats
    euler_deg: Floats
    tuned_deg: Floats


@dataclass(frozen=True, slots=True)
class Tuning:
    """All of it.

    run
        The search whose parameters were chosen: the one that is best on the training sessions.
    others
        The searches of the other seeds.
    tunable
        The filter.
    euler, few
        PI of plain integration, and of the filter with few of its parameters tuned, the others idle.
    left_out
        E in deg of each session under parameters tuned on all others, by name; empty where sessions were kept apart.
    warnings : tuple of str
        What should be known before believing it, a sentence each.
    """

    tunable: Tunable
    method: str
    evaluations: int
    axes: tuple[Axis, ...]
    run: Run
    euler: Pi
    few: Pi
    few_params: Params
    scores: tuple[SessionScore, ...]
    sample_rate_hz: float
    seconds: float
    others: tuple[Run, ...] = ()
    curves: tuple[Curve, ...] = ()
    left_out: dict[str, float] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def mean_e_deg(self, split: Split) -> tuple[float, float]:
        """Mean E of plain integration and of the tuned filter over the sessions of a split, deg; NaN without any."""
        chosen = [score for score in self.scores if score.split is split]
        if not chosen:
            return float("nan"), float("nan")
        return float(np.mean([s.e_euler_deg for s in chosen])), float(np.mean([s.e_tuned_deg for s in chosen]))
