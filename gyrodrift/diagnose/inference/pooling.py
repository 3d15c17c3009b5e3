"""From the tables of single sessions to the evidence of all: nulls pooled, responses interpolated between sizes."""

from collections.abc import Sequence

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import IS_LOG, LINEAR
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.likelihood import LOG_RANGE
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key, simulated_key


def evidence_of(tables: Sequence[ResponseTable], tried: Sequence[Candidate]) -> Evidence:
    """Pool the nulls, and work out the responses at all sizes."""
    nulls = np.concatenate([table.nulls for table in tables])
    centre = nulls.mean(axis=0)
    spread = np.sqrt(np.square(nulls - centre).sum(axis=0) / max(1, len(nulls) - 1))
    thresholds = np.array([table.thresholds for table in tables])
    sigma = np.sqrt(spread**2 + thresholds**2)
    sigma[sigma == 0.0] = 1.0  # of regressors that these motions have not
    runs = len(nulls) // len(tables)
    return Evidence(
        names=tuple(table.name for table in tables),
        difference=np.array([table.difference for table in tables]) - centre,
        sigma=sigma,
        nulls=(nulls - centre) / np.repeat(sigma, runs, axis=0),
        responses=tuple(_response(tables, candidate) for candidate in tried),
    )


def _response(tables: Sequence[ResponseTable], candidate: Candidate) -> Response:
    if candidate.phase_deg is not None:
        return _turned(tables, candidate)
    simulated = np.array([table.responses[key(candidate)] for table in tables])  # sessions, nodes, realisations, F
    if candidate.realisations > 1:
        return _random(simulated, candidate)
    nodes = simulated[:, :, 0].transpose(1, 0, 2)
    none = np.zeros((len(candidate.sizes), simulated.shape[-1]))
    return Response(candidate, interpolated(candidate, nodes), none)


def _random(simulated: Floats, candidate: Candidate) -> Response:
    """Realisations of all sessions are one sample; what may go either way has no mean."""
    pooled = simulated.transpose(1, 0, 2, 3).reshape(simulated.shape[1], -1, simulated.shape[-1])
    mean = np.where(LINEAR, 0.0, pooled.mean(axis=1))
    spread = np.sqrt(np.square(pooled - mean[:, None]).mean(axis=1))
    wide = np.repeat(interpolated(candidate, mean[:, None]), simulated.shape[0], axis=1)
    return Response(candidate, wide, interpolated(candidate, spread[:, None])[:, 0])


def _turned(tables: Sequence[ResponseTable], candidate: Candidate) -> Response:
    """A sine of any phase out of those of 0 and 90 degrees: exact where features are linear."""
    phase = np.deg2rad(candidate.phase_deg or 0.0)
    at_0, at_90 = (
        np.array([table.responses[simulated_key(candidate, deg)][0, 0] for table in tables]) for deg in (0.0, 90.0)
    )
    node = np.where(LINEAR, np.cos(phase) * at_0 + np.sin(phase) * at_90, 0.5 * (at_0 + at_90))
    share = candidate.sizes / candidate.grid_points[0]
    return Response(candidate, scaled(node, share), np.zeros((len(share), node.shape[-1])))


def interpolated(candidate: Candidate, nodes: Floats) -> Floats:
    """Changes at the sizes that were simulated, (nodes, …, F), taken to all sizes of a candidate, (sizes, …, F).

    Linear effects are scaled; all others are interpolated along the logarithm of the size.
    """
    if candidate.grid_points[0] < 0.0:
        up = scaled(nodes[1], candidate.sizes[candidate.sizes > 0.0] / candidate.grid_points[1])
        down = scaled(nodes[0], candidate.sizes[candidate.sizes < 0.0] / candidate.grid_points[0])
        return np.concatenate([down, up])
    if len(candidate.grid_points) == 1:
        return nodes
    place = np.interp(np.log(candidate.sizes), np.log(candidate.grid_points), np.arange(len(candidate.grid_points)))
    left = np.minimum(place.astype(np.int64), len(nodes) - 2)
    part = (place - left).reshape(-1, *([1] * (nodes.ndim - 1)))
    found: Floats = (1.0 - part) * nodes[left] + part * nodes[left + 1]
    return found


def scaled(node: Floats, share: Floats) -> Floats:
    """A linear effect at shares of a size: variances grow with the square, shares of samples no further."""
    by = share.reshape(-1, *([1] * node.ndim))
    squares = np.log1p(np.expm1(np.clip(node, 0.0, LOG_RANGE)) * by**2)
    logs = np.where(node > 0.0, squares, node * np.minimum(by, 1.0))
    found: Floats = np.where(LINEAR, node * by, np.where(IS_LOG, logs, node * np.minimum(by, 1.0)))
    return found
