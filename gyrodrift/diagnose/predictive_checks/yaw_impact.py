"""Cost of the gap in yaw: errors of a filter, and sim-to-real transfer of parameters tuned in simulation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.inference.verdict import NEGLIGIBLE_DEG, NamedCause
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.diagnose.simulate.recalibration import corrected_recording, corrected_session
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.reference import Reference, reference_of
from gyrodrift.evaluation.space import axes_of, values_of
from gyrodrift.filters.registry import PUBLISHED
from gyrodrift.session.session import Session
from gyrodrift.tune.search.methods import METHODS, run_to_budget
from gyrodrift.tune.search.objective import Objective
from gyrodrift.values.arrays import Floats

EVALUATIONS = 150
"""Evaluations of the cost in each of the three tunings. Chosen: for speed."""

HELD_OUT_EVERY = 3
"""Every third session is held out, used for scoring and not for tuning. Chosen: two thirds remain for tuning."""


WORSE = 0.2
"""Increase of the error of yaw from which on a correction is worse, as a share of the recorded error; it is at least
NEGLIGIBLE_DEG. Chosen, since a simulated walk of the bias is another one than the recorded."""


@dataclass(frozen=True, slots=True)
class YawImpact:
    """Yaw errors of a filter on recordings and in the simulator, without (before) and with the causes (after).

    e_real_deg, e_sim_before_deg, e_sim_after_deg
        Mean absolute yaw errors, deg, with parameters tuned in the simulator without the causes.
    pi_real_tuned_on_sim_before, pi_real_tuned_on_sim_after, pi_real_tuned_on_real
        Mean squared yaw errors of held-out recordings, deg². Parameters are tuned in the simulator without the
        causes, in the simulator with them, and on recordings.
    """

    e_real_deg: float
    e_sim_before_deg: float
    e_sim_after_deg: float
    pi_real_tuned_on_sim_before: float
    pi_real_tuned_on_sim_after: float
    pi_real_tuned_on_real: float

    @property
    def is_worse_with_causes(self) -> bool:
        """Whether yaw with the causes is further from the recordings, by more than NEGLIGIBLE_DEG and WORSE."""
        before, after = (abs(e_deg - self.e_real_deg) for e_deg in (self.e_sim_before_deg, self.e_sim_after_deg))
        return after - before > max(NEGLIGIBLE_DEG, WORSE * self.e_real_deg)


def yaw_impact_of(subjects: Sequence[Subject], causes: Sequence[NamedCause]) -> YawImpact:
    """Tune a filter on simulated and on real sessions, and score it on held-out real sessions."""
    real = [reference_of(_as_session(subject.cleaned.recording)) for subject in subjects]
    before = [reference_of(subject.session((), seed)) for seed, subject in enumerate(subjects)]
    after = [
        reference_of(corrected_session(subject, effects_in(causes, index, subject), index))
        for index, subject in enumerate(subjects)
    ]
    indices = range(len(subjects))
    tuned_on = [index for index in indices if index % HELD_OUT_EVERY != HELD_OUT_EVERY - 1 or len(subjects) == 1]
    scored_on = [index for index in indices if index not in tuned_on] or tuned_on
    best = [_tuned([references[index] for index in tuned_on]) for references in (before, after, real)]
    with Cost(real) as on_real, Cost(before) as on_before, Cost(after) as on_after:
        pi = on_real.cost(np.vstack(best), scored_on).pi
        errors = [float(cost.cost(best[0]).mean_absolutes.mean()) for cost in (on_real, on_before, on_after)]
    return YawImpact(*errors, *(float(value) for value in pi))


def cost_deg(subjects: Sequence[Subject], causes: Sequence[NamedCause], cause: NamedCause) -> float:
    """Mean absolute change of the integrated yaw by one of the causes, deg: simulations with all minus without it."""
    remaining = [item for item in causes if item is not cause]
    costs = []
    for index, subject in enumerate(subjects[:2]):  # two sessions suffice
        with_it, without = (
            yaw_error_deg(corrected_recording(subject, effects_in(acting, index, subject), index))
            for acting in (causes, remaining)
        )
        costs.append(float(np.nanmean(np.abs(with_it - without))))
    return float(np.mean(costs))


def yaw_error_deg(recording: Recording) -> Floats:
    """(n,) integrated rate minus the angle of the encoder, deg; NaN at missing samples."""
    steps_s = np.diff(filled(recording.device_s), prepend=0.0)
    away_deg: Floats = np.cumsum(filled(recording.rate_dps) * steps_s) - recording.encoder_deg
    return away_deg


def effects_in(causes: Sequence[NamedCause], index: int, subject: Subject) -> tuple[Effect, ...]:
    """Effects of the causes in a session, given by its index from 0."""
    return tuple(cause.in_session(index, subject.rig.effects) for cause in causes)


def _as_session(recording: Recording) -> Session:
    """A checked recording as a session, without its missing samples."""
    is_present = np.isfinite(recording.rate_dps)
    return Session(
        recording.name,
        recording.device_s[is_present],
        recording.rate_dps[is_present],
        encoder_deg=recording.encoder_deg[is_present],
    )


def _tuned(references: Sequence[Reference]) -> Floats:
    """(1, 5) parameters of the published filter with the least cost on these sessions."""
    with Cost(references) as cost:
        axes = axes_of(PUBLISHED)
        objective = Objective(cost.pi, axes, EVALUATIONS)
        run_to_budget(METHODS["race"](), objective, 0)
        return values_of(axes, objective.cube[objective.best][np.newaxis])
