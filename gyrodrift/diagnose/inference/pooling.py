"""Evidence from the response tables of single sessions: pooled nulls, and responses at all sizes."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.diagnose.features.vector import LINEAR, NUMBER, OF_AXES, REGRESSORS_OF_MOTION
from gyrodrift.diagnose.inference.evidence import NOT_COMPARED, Evidence, Response
from gyrodrift.diagnose.inference.log_variances import scaled, straight
from gyrodrift.diagnose.inference.nulls import pooled_nulls
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key, simulated_key
from gyrodrift.values.arrays import Floats, Mask

PHASES_DEG = np.arange(-180.0, 180.0, 2.0)
"""Phases that are tried."""


def free_phases_deg(unexplained: Floats, quadratures: tuple[Floats, Floats], shares: Floats) -> Floats:
    """(sessions,) phases of sines with a common amplitude that fit all sessions best, by least squares.

    The amplitude is common, because a session that hardly turns would accept any amplitude.

    unexplained
        (sessions, F) differences to explain, in standard deviations of chance.
    quadratures
        (sessions, F) changes at phases of 0 and 90 degrees, in the same units.
    shares
        (sizes,) possible multiples of these changes.
    """
    at_0, at_90 = quadratures
    phase = np.deg2rad(PHASES_DEG)[:, None]
    cosine, sine = np.cos(phase), np.sin(phase)
    along = cosine * _product(unexplained, at_0) + sine * _product(unexplained, at_90)
    cross = 2.0 * sine * cosine * _product(at_0, at_90)
    power = np.square(cosine) * _product(at_0, at_0) + np.square(sine) * _product(at_90, at_90) + cross
    sizes = shares[:, None, None]
    cost = np.square(sizes) * power - 2.0 * sizes * along  # sizes, phases, sessions
    best = int(cost.min(axis=1).sum(axis=-1).argmin())
    phases: Floats = PHASES_DEG[cost[best].argmin(axis=0)]
    return phases


def _product(first: Floats, second: Floats) -> Floats:
    """(sessions,) scalar products."""
    product: Floats = (first * second).sum(axis=-1)
    return product


ONCE_PER_TURN = np.array([number for name, number in NUMBER.items() if name.startswith("turn_")])
"""Features that depend on a phase; all other features are ignored when a phase is fitted."""


def evidence_of(tables: Sequence[ResponseTable], tried: Sequence[Candidate]) -> Evidence:
    """Pool the nulls, and compute the responses at all sizes."""
    pooled = pooled_nulls(tables)
    thresholds = np.array([table.thresholds for table in tables])
    chance = np.sqrt(pooled.variance * pooled.common_share + len(tables) * pooled.rebuilding)
    sigma = np.hypot(chance, thresholds)
    sigma[absent_of(tables)] = NOT_COMPARED
    sigma[sigma == 0.0] = 1.0  # a regressor that no motion excites
    difference = pooled.difference
    distinct = [candidate for candidate in tried if not candidate.is_phase_free or candidate.phase_deg == 0.0]
    responses = [_response(tables, candidate, difference, sigma) for candidate in distinct]
    return Evidence(
        names=tuple(table.name for table in tables),
        difference=difference,
        sigma=sigma,
        nulls=pooled.away / sigma[:, None],
        device_variance=np.square([table.device_sigma / own for table, own in zip(tables, sigma, strict=True)]),
        responses=(*responses, *_with_phases_of_residual(tables, responses, difference, sigma)),
        sigma_factor=np.mean(
            [np.hypot(1.0, table.extra_sigma / own) for table, own in zip(tables, sigma, strict=True)], axis=0
        ),
    )


def absent_of(tables: Sequence[ResponseTable]) -> Mask:
    """(sessions, F) features that a session does not determine.

    These are regressors that only some of its replays have, and features of three axes if it has one axis.
    """
    shares = np.array([(table.nulls == 0.0).mean(axis=0) for table in tables])
    differs = np.array([table.difference != 0.0 for table in tables])
    # If a tenth of the replays lack a regressor, the motion hardly excites it.
    is_absent: Mask = REGRESSORS_OF_MOTION & (shares > 0.1) & (differs | (shares < 1.0))
    lacks_axes: Mask = OF_AXES & ~differs & (shares == 1.0)
    return is_absent | lacks_axes


def _response(tables: Sequence[ResponseTable], candidate: Candidate, unexplained: Floats, sigma: Floats) -> Response:
    """Response to a candidate; `unexplained` and `sigma`, (sessions, F), fit free phases."""
    if candidate.is_phase_free:
        return _at_phases(tables, candidate, _phases_deg(tables, candidate, unexplained, sigma))
    if candidate.phase_deg is not None:
        return _at_phases(tables, candidate, np.full(len(tables), candidate.phase_deg))
    simulated = np.array([table.responses[key(candidate)] for table in tables])  # sessions, nodes, realizations, F
    if candidate.realisations > 1:
        realized = simulated.transpose(1, 0, 2, 3)
        return Response(candidate, realized.mean(axis=2), realized=realized)
    mean, error = straight(candidate, simulated[:, :, 0].transpose(1, 0, 2))
    return Response(candidate, mean, interpolation_sigma=error)


def _with_phases_of_residual(
    tables: Sequence[ResponseTable], responses: Sequence[Response], unexplained: Floats, sigma: Floats
) -> list[Response]:
    """Each effect with free phases again, at the phases that fit the residual of the other such effect.

    Two once-per-turn effects change the same features. Alone, the weaker would take the phases of the stronger.
    """
    free = [first for first in responses if first.phases_deg is not None]
    pairs = [(first, second) for first in free for second in free if first is not second]
    return [
        _at_phases(
            tables,
            first.candidate,
            _phases_deg(tables, first.candidate, unexplained - _nearest(second, unexplained, sigma), sigma),
        )
        for first, second in pairs
    ]


def _nearest(response: Response, unexplained: Floats, sigma: Floats) -> Floats:
    """(sessions, F) change at the size that explains the once-per-turn features best."""
    z = ((unexplained - response.mean) / sigma)[:, :, ONCE_PER_TURN]
    nearest: Floats = response.mean[int(np.square(z).sum(axis=(1, 2)).argmin())]
    return nearest


def _phases_deg(tables: Sequence[ResponseTable], candidate: Candidate, unexplained: Floats, sigma: Floats) -> Floats:
    """(sessions,) phases of a candidate that fit the once-per-turn features best."""
    at_0, at_90 = _quadratures(tables, candidate)
    standardized, *turns = (values[:, ONCE_PER_TURN] / sigma[:, ONCE_PER_TURN] for values in (unexplained, at_0, at_90))
    return free_phases_deg(standardized, (turns[0], turns[1]), candidate.sizes / candidate.grid_points[0])


def _quadratures(tables: Sequence[ResponseTable], candidate: Candidate) -> tuple[Floats, Floats]:
    """(sessions, F) changes at phases of 0 and 90 degrees."""
    at_0, at_90 = (
        np.array([table.responses[simulated_key(candidate, deg)][0, 0] for table in tables]) for deg in (0.0, 90.0)
    )
    return at_0, at_90


def _at_phases(tables: Sequence[ResponseTable], candidate: Candidate, phases_deg: Floats) -> Response:
    """Response of an effect with given phases, composed of those at 0 and 90 degrees; exact for linear features."""
    phase = np.deg2rad(phases_deg)[:, None]
    at_0, at_90 = _quadratures(tables, candidate)
    node = np.where(LINEAR, np.cos(phase) * at_0 + np.sin(phase) * at_90, 0.5 * (at_0 + at_90))
    share = candidate.sizes / candidate.grid_points[0]
    free = phases_deg if candidate.is_phase_free else None
    return Response(candidate, scaled(node, share), free)
