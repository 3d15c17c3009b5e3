"""What a tuning found and how good it is, as values: what the files and the report are made of."""

from dataclasses import dataclass, field

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.curves import YawCurves
from gyrodrift.evaluation.dataset import SessionSummary, Split
from gyrodrift.evaluation.score import Score
from gyrodrift.evaluation.space import Axis
from gyrodrift.filters.filter import Filter, FilterParams


@dataclass(frozen=True, slots=True)
class SessionScore:
    """One session under plain integration, the tuned filter, and the filter with a reduced set of parameters tuned.

    curves
        Yaw by plain integration and by the tuned filter, in this order; None where the session is not plotted.
    """

    session: SessionSummary
    split: Split
    euler: Score
    tuned: Score
    reduced: Score
    curves: YawCurves | None = None


@dataclass(frozen=True, slots=True)
class Pi:
    """PI in deg² on the training and the test sessions; None where none were held out."""

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
    params: FilterParams
    pi: Pi
    densities: Floats | None = None


@dataclass(frozen=True, slots=True)
class Tuning:
    """All of it.

    run
        The search whose parameters were chosen: the one that is best on the training sessions.
    others
        The searches of the other seeds.
    euler, reduced
        PI of plain integration, and of the reduced model: few parameters tuned, the others held fixed.
    cross_validation
        Of each session, by name, under parameters tuned on all others; empty where sessions were held out.
    warnings : tuple of str
        What should be known before believing it, a sentence each.
    """

    filter: Filter
    method: str
    evaluations: int
    axes: tuple[Axis, ...]
    run: Run
    euler: Pi
    reduced: Pi
    reduced_params: FilterParams
    scores: tuple[SessionScore, ...]
    sample_rate_hz: float
    seconds: float
    others: tuple[Run, ...] = ()
    cross_validation: dict[str, Score] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()

    def scores_on(self, split: Split) -> list[SessionScore]:
        """The sessions of a split."""
        return [score for score in self.scores if score.split is split]

    def mean_e_deg(self, split: Split) -> tuple[float, float]:
        """Mean E of plain integration and of the tuned filter over the sessions of a split, deg; NaN without any."""
        chosen = self.scores_on(split)
        if not chosen:
            return float("nan"), float("nan")
        return float(np.mean([s.euler.e_deg for s in chosen])), float(np.mean([s.tuned.e_deg for s in chosen]))
