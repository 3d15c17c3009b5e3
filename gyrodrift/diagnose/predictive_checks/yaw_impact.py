"""What the gap costs in yaw: errors of the real filter, and sim-to-real transfer of parameters tuned in simulation."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.diagnose.simulate.noise_beneath import corrected_recording, corrected_session
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.evaluation.cost import Cost
from gyrodrift.evaluation.reference import Reference, reference_of
from gyrodrift.evaluation.space import axes_of, values_of
from gyrodrift.filters.registry import PUBLISHED
from gyrodrift.session.session import Session
from gyrodrift.tune.search.methods import METHODS, run_to_budget
from gyrodrift.tune.search.objective import Objective

EVALUATIONS = 300
"""Of the cost, for each of the three tunings."""

HELD_OUT_EVERY = 3
"""Every third session is scored and not tuned on."""


@dataclass(frozen=True, slots=True)
class YawImpact:
    """What a gap costs where it matters.

    e_real_deg, e_sim_before_deg, e_sim_after_deg
        Mean absolute yaw errors under the parameters tuned on the simulator as it stands, deg.
    pi_real_tuned_on_sim_before, pi_real_tuned_on_sim_after, pi_real_tuned_on_real
        Mean squared yaw errors of real sessions that were held out, deg², by what the parameters were tuned on.
    """

    e_real_deg: float
    e_sim_before_deg: float
    e_sim_after_deg: float
    pi_real_tuned_on_sim_before: float
    pi_real_tuned_on_sim_after: float
    pi_real_tuned_on_real: float


def yaw_impact_of(subjects: Sequence[Subject], causes: Sequence[NamedCause]) -> YawImpact:
    """Tune on simulated and real sessions, and score on real ones held out."""
    real = [reference_of(_as_session(subject.cleaned.recording)) for subject in subjects]
    before = [reference_of(subject.session((), seed)) for seed, subject in enumerate(subjects)]
    after = [
        reference_of(corrected_session(subject, effects_in(causes, number, subject), number))
        for number, subject in enumerate(subjects)
    ]
    number = range(len(subjects))
    tuned_on = [at for at in number if at % HELD_OUT_EVERY != HELD_OUT_EVERY - 1 or len(subjects) == 1]
    scored_on = [at for at in number if at not in tuned_on] or tuned_on
    best = [_tuned([references[at] for at in tuned_on]) for references in (before, after, real)]
    with Cost(real) as on_real, Cost(before) as on_before, Cost(after) as on_after:
        pi = on_real.cost(np.vstack(best), scored_on).pi
        errors = [float(cost.cost(best[0]).mean_absolutes.mean()) for cost in (on_real, on_before, on_after)]
    return YawImpact(*errors, *(float(value) for value in pi))


def cost_deg(subjects: Sequence[Subject], causes: Sequence[NamedCause], one: NamedCause) -> float:
    """What an effect beside others adds to or takes from the yaw error of the integrated rate: mean absolute, deg."""
    others = [cause for cause in causes if cause is not one]
    costs = []
    for number, subject in enumerate(subjects[:2]):  # two sessions suffice
        with_it, without = (
            yaw_error_deg(corrected_recording(subject, effects_in(each, number, subject), number))
            for each in (causes, others)
        )
        costs.append(float(np.nanmean(np.abs(with_it - without))))
    return float(np.mean(costs))


def yaw_error_deg(recording: Recording) -> Floats:
    """Integrated rate less the encoder's angle, degrees, shape (n,); NaN where a sample never came."""
    steps_s = np.diff(filled(recording.device_s), prepend=0.0)
    away_deg: Floats = np.cumsum(filled(recording.rate_dps) * steps_s) - recording.encoder_deg
    return away_deg


def effects_in(causes: Sequence[NamedCause], number: int, subject: Subject) -> tuple[Effect, ...]:
    """Of session `number`."""
    return tuple(cause.in_session(number, subject.rig.effects) for cause in causes)


def _as_session(recording: Recording) -> Session:
    """What the recording checks made of a session, without its holes."""
    came = np.isfinite(recording.rate_dps)
    return Session(
        recording.name, recording.device_s[came], recording.rate_dps[came], encoder_deg=recording.encoder_deg[came]
    )


def _tuned(references: Sequence[Reference]) -> Floats:
    """(1, 5) parameters."""
    with Cost(references) as cost:
        axes = axes_of(PUBLISHED)
        objective = Objective(cost.pi, axes, EVALUATIONS)
        run_to_budget(METHODS["race"](), objective, 0)
        return values_of(axes, objective.cube[objective.best][np.newaxis])
