"""From the tables of single sessions to the evidence of all: nulls pooled, responses interpolated between sizes."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.arrays import Floats, Mask
from gyrodrift.diagnose.features.vector import LINEAR, NUMBER, OF_MOTION, REGRESSORS_OF_MOTION
from gyrodrift.diagnose.inference.evidence import NOT_COMPARED, Evidence, Response
from gyrodrift.diagnose.inference.free_phases import free_phases_deg
from gyrodrift.diagnose.inference.log_variances import interpolated, scaled
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key, simulated_key

PRIOR_RUNS = 2.0
"""Null runs that it is worth to begin with independent sessions."""


ONCE_PER_TURN = np.array([number for name, number in NUMBER.items() if name.startswith("turn_")])
"""Features that know a phase: what another cause does to all others is none of its business."""

ABSENT_SHARE = 0.1
"""Of the replays: a regressor that so many of them have not is on the edge of being one."""


def evidence_of(tables: Sequence[ResponseTable], tried: Sequence[Candidate]) -> Evidence:
    """Pool the nulls, and work out the responses at all sizes."""
    own_nulls = np.array([table.nulls for table in tables])
    differences = np.array([table.difference for table in tables])
    has = own_nulls.any(axis=1) | (differences != 0.0)
    runs = np.maximum(has.sum(axis=0) * own_nulls.shape[1], 1)
    centre = np.where(has, own_nulls.sum(axis=(0, 1)) / runs, 0.0)
    away = own_nulls - centre[:, None]
    variance = np.square(away).sum(axis=(0, 1)) / np.maximum(runs - 1, 1)
    thresholds = np.array([table.thresholds for table in tables])
    common = np.maximum(variance, 0.5 * (variance + np.square(away).mean(axis=1))) * common_share(away)
    again = np.where(OF_MOTION, beyond_chance(own_nulls.sum(axis=(0, 1)) / runs, variance / runs), 0.0)
    changes = np.array([table.smoother for table in tables])
    smoother = beyond_chance(changes.mean(axis=0), variance_of_mean(changes))
    chance = np.sqrt(common + len(tables) * (again + smoother))
    sigma = np.hypot(chance, thresholds)
    sigma[absent_of(tables)] = NOT_COMPARED
    sigma[sigma == 0.0] = 1.0  # of regressors that these motions have not
    difference = differences - centre
    one_each = [one for one in tried if not one.is_phase_free or one.phase_deg == 0.0]
    responses = [_response(tables, candidate, difference, sigma) for candidate in one_each]
    return Evidence(
        names=tuple(table.name for table in tables),
        difference=difference,
        sigma=sigma,
        nulls=away / sigma[:, None],
        responses=(*responses, *_beside_each_other(tables, responses, difference, sigma)),
        caution=np.mean([np.hypot(1.0, table.doubt / own) for table, own in zip(tables, sigma, strict=True)], axis=0),
    )


def beyond_chance(mean: Floats, variance: Floats) -> Floats:
    """(F,) variance of what all sessions share for their motion not being rebuilt exactly, by the size of two steps.

    What the null is off by on average is the step from the first rebuilding to the second: the step from the recording
    to the first is taken to be as large, of either sign. And where features follow how rough a motion is, it may be as
    smooth as the mean of all that are possible.

    variance
        What chance makes of the mean.
    """
    found: Floats = np.maximum(np.square(mean) - variance, 0.0)
    return found


def variance_of_mean(values: Floats) -> Floats:
    """(F,) by the scatter of sessions, (sessions, F); that of a single one is not known, and taken to be none."""
    sessions = len(values)
    if sessions == 1:
        return np.zeros(values.shape[1])
    found: Floats = values.var(axis=0, ddof=1) / sessions
    return found


def absent_of(tables: Sequence[ResponseTable]) -> Mask:
    """(sessions, F) regressors that some replays of a session have and others have not."""
    shares = np.array([(table.nulls == 0.0).mean(axis=0) for table in tables])
    differs = np.array([table.difference != 0.0 for table in tables])
    found: Mask = REGRESSORS_OF_MOTION & (shares > ABSENT_SHARE) & (differs | (shares < 1.0))
    return found


def common_share(nulls: Floats) -> Floats:
    """(F,) by how much the variance of a mean over sessions is more than that of independent ones; at least 1.

    Sessions that play the same motion share what is wrong in rebuilding it.

    nulls
        (sessions, runs, F) differences without a gap; run by run their motions are drawn by the same random numbers
        where the course of the motion is the same.
    """
    sessions, runs, _ = nulls.shape
    if sessions == 1 or runs == 1:
        return np.ones(nulls.shape[-1])
    own = np.square(nulls).mean(axis=(0, 1))
    together = np.square(nulls.mean(axis=0)).sum(axis=0) / (runs - 1)
    ratio = sessions * together / np.where(own > 0.0, own, 1.0)
    shrunk = (PRIOR_RUNS + (runs - 1) * ratio) / (PRIOR_RUNS + runs - 1)
    share: Floats = np.clip(shrunk, 1.0, sessions)
    return share


def _response(tables: Sequence[ResponseTable], candidate: Candidate, wanted: Floats, sigma: Floats) -> Response:
    """(sessions, F) each: what there is to explain, and what chance makes of it."""
    if candidate.is_phase_free:
        return _turned(tables, candidate, _phases_deg(tables, candidate, wanted, sigma))
    if candidate.phase_deg is not None:
        return _turned(tables, candidate, np.full(len(tables), candidate.phase_deg))
    simulated = np.array([table.responses[key(candidate)] for table in tables])  # sessions, nodes, realisations, F
    if candidate.realisations > 1:
        realised = simulated.transpose(1, 0, 2, 3)
        return Response(candidate, realised.mean(axis=2), realised=realised)
    return Response(candidate, interpolated(candidate, simulated[:, :, 0].transpose(1, 0, 2)))


def _beside_each_other(
    tables: Sequence[ResponseTable], responses: Sequence[Response], wanted: Floats, sigma: Floats
) -> list[Response]:
    """What has free phases once more, at those that fit what is left beside the other of its kind.

    Two that come once per turn change the same features: the phases of the weaker one would be those of the stronger.
    """
    free = [one for one in responses if one.phases_deg is not None]
    pairs = [(one, other) for one in free for other in free if one is not other]
    return [
        _turned(
            tables, one.candidate, _phases_deg(tables, one.candidate, wanted - _nearest(other, wanted, sigma), sigma)
        )
        for one, other in pairs
    ]


def _nearest(response: Response, wanted: Floats, sigma: Floats) -> Floats:
    """(sessions, F) change at the size that leaves the least of what comes once per turn."""
    left = ((wanted - response.mean) / sigma)[:, :, ONCE_PER_TURN]
    nearest: Floats = response.mean[int(np.square(left).sum(axis=(1, 2)).argmin())]
    return nearest


def _phases_deg(tables: Sequence[ResponseTable], candidate: Candidate, wanted: Floats, sigma: Floats) -> Floats:
    """(sessions,) the phases that leave the least to explain."""
    at_0, at_90 = _quadratures(tables, candidate)
    standardised, *turns = (values[:, ONCE_PER_TURN] / sigma[:, ONCE_PER_TURN] for values in (wanted, at_0, at_90))
    return free_phases_deg(standardised, (turns[0], turns[1]), candidate.sizes / candidate.grid_points[0])


def _quadratures(tables: Sequence[ResponseTable], candidate: Candidate) -> tuple[Floats, Floats]:
    """(sessions, F) changes at phases of 0 and 90 degrees."""
    at_0, at_90 = (
        np.array([table.responses[simulated_key(candidate, deg)][0, 0] for table in tables]) for deg in (0.0, 90.0)
    )
    return at_0, at_90


def _turned(tables: Sequence[ResponseTable], candidate: Candidate, phases_deg: Floats) -> Response:
    """A sine of any phase out of those of 0 and 90 degrees: exact where features are linear."""
    phase = np.deg2rad(phases_deg)[:, None]
    at_0, at_90 = _quadratures(tables, candidate)
    node = np.where(LINEAR, np.cos(phase) * at_0 + np.sin(phase) * at_90, 0.5 * (at_0 + at_90))
    share = candidate.sizes / candidate.grid_points[0]
    free = phases_deg if candidate.is_phase_free else None
    return Response(candidate, scaled(node, share), free)
