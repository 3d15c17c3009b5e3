"""Result of a tuning as values, for its files and its report."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from gyrodrift.evaluation.dataset import SessionSummary, Split, YawCurves
from gyrodrift.evaluation.score import Score
from gyrodrift.evaluation.space import Axis
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.io.result_table import ResultTable
from gyrodrift.values.arrays import Floats


@dataclass(frozen=True, slots=True)
class SessionScore:
    """Scores of a session: plain integration, the tuned filter, and the reduced model.

    curves
        Yaw by plain integration and by the tuned filter, in this order; None for a session that is not plotted.
    default
        Score of the filter with its default parameters.
    """

    session: SessionSummary
    split: Split
    euler: Score
    tuned: Score
    reduced: Score
    curves: YawCurves | None = None
    default: Score | None = None


@dataclass(frozen=True, slots=True)
class Pi:
    """A mean over the training and the test sessions, of PI in deg² if not said otherwise; None without test."""

    train: float
    test: float | None

    @property
    def judged(self) -> float:
        """The mean over the test sessions if there are any, else over the training sessions."""
        return self.train if self.test is None else self.test


@dataclass(frozen=True, slots=True)
class Alternative:
    """A way to integrate yaw, tuned or not, with its errors on both splits.

    filter
        None for plain integration and for a start calibration.
    params
        Parameters of the filter.
    pi, e_deg, crps_deg
        PI, deg², mean E, deg, and mean CRPS, deg, or None for a way without sigma. In a cross-validation `test` of a
        tuned filter is that of the sessions held out in turn, and `test` of anything else is over all sessions.
    """

    key: str
    title: str
    pi: Pi
    e_deg: Pi
    filter: Filter | None = None
    params: FilterParams | None = None
    is_tuned: bool = False
    crps_deg: Pi | None = None

    @property
    def judged_pi(self) -> float:
        """PI on held-out sessions if there are any, deg², else on the training sessions."""
        return self.pi.judged

    @property
    def judged_crps_deg(self) -> float:
        """CRPS as judged, deg; that of a yaw without sigma is E."""
        return (self.crps_deg or self.e_deg).judged


@dataclass(frozen=True, slots=True)
class Run:
    """A search: seed, costs in deg², shape (n,), evaluated points of the unit cube, shape (n, axes), and result.

    densities
        Densities of the automata at the end, shape (axes, GRID); None for methods without automata.
    """

    seed: int
    history: Floats
    cube: Floats
    params: FilterParams
    pi: Pi
    densities: Floats | None = None


@dataclass(frozen=True, slots=True, repr=False)
class Tuning(ResultTable):
    """Result of a tuning: the filter and the parameters found, and every alternative.

    run
        The search with the best result on the training sessions.
    other_runs
        Searches of the other seeds.
    euler, reduced
        PI of plain integration, and of the reduced model: few parameters tuned, all others fixed.
    cross_validation
        Score of each session, by name, with parameters tuned on all other sessions; empty with held-out sessions.
    warnings : tuple of str
        Sentences to read before the result is used.
    slices, slice_axes
        PI on the training sessions along each axis through the parameters found, deg², shape (axes, SCAN_POINTS), and
        these axes: CARLA as published searches linear axes, its slices may be logarithmic.
    alternatives
        Plain integration, start calibration, and every filter at its defaults and tuned.
    is_default_written
        Whether the config has the filter's defaults, because they are better on held-out sessions.
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
    other_runs: tuple[Run, ...] = ()
    cross_validation: dict[str, Score] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()
    slices: Floats = field(default_factory=lambda: np.empty((0, 0)))
    slice_axes: tuple[Axis, ...] = ()
    alternatives: tuple[Alternative, ...] = ()
    is_default_written: bool = False

    def __repr__(self) -> str:
        name = self.filter.title or self.filter.name
        source = "defaults" if self.is_default_written else "tuned"
        return f"Tuning({name}, {source}, {len(self.scores)} sessions, {len(self.run.history)} evaluations)"

    def columns(self) -> dict[str, list[Any]]:
        """The alternatives: name, filter, mean E in deg and PI in deg² on training and held-out sessions."""
        ways = self.alternatives
        return {
            "name": [way.title for way in ways],
            "filter": [None if way.filter is None else way.filter.name for way in ways],
            "e_train_deg": [way.e_deg.train for way in ways],
            "e_test_deg": [way.e_deg.test for way in ways],
            "crps_train_deg": [way.crps_deg and way.crps_deg.train for way in ways],
            "crps_test_deg": [way.crps_deg and way.crps_deg.test for way in ways],
            "pi_train": [way.pi.train for way in ways],
            "pi_test": [way.pi.test for way in ways],
        }

    @property
    def written(self) -> Alternative | None:
        """The alternative whose parameters the config has; None if there are no alternatives."""
        is_tuned = not self.is_default_written
        same = (way for way in self.alternatives if way.filter is self.filter and way.is_tuned is is_tuned)
        return next(same, None)

    @property
    def params(self) -> FilterParams:
        """Parameters for the config."""
        defaults: FilterParams = self.filter.params()
        return defaults if self.is_default_written else self.run.params

    def scores_on(self, split: Split) -> list[SessionScore]:
        """The sessions of a split."""
        return [score for score in self.scores if score.split is split]

    def mean_e_deg(self, split: Split) -> tuple[float, float]:
        """Mean E of plain integration and of the tuned filter over the sessions of a split, deg; NaN without any."""
        chosen = self.scores_on(split)
        if not chosen:
            return float("nan"), float("nan")
        return float(np.mean([s.euler.e_deg for s in chosen])), float(np.mean([s.tuned.e_deg for s in chosen]))
