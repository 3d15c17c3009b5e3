"""The tables of all sessions in one place: how far each feature is off, and what each candidate would do to it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import IS_LOG, LINEAR
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.responses import ResponseTable, key, simulated_key


@dataclass(frozen=True, slots=True, eq=False)
class Answer:
    """What a candidate does at each of its sizes.

    mean
        (sizes, sessions, F) change of the features.
    spread
        (sizes, F) standard deviation of that change where chance plays a part, else 0.
    """

    candidate: Candidate
    mean: Floats
    spread: Floats


@dataclass(frozen=True, slots=True)
class Evidence:
    """Sessions as rows, features as columns.

    names
        Of the sessions.
    difference
        (sessions, F) recording less simulation, and less what the replay itself leaves.
    sigma
        (sessions, F) spread of that where there is no gap, and what does not matter, together.
    nulls
        (runs, F) differences without a gap, in units of sigma, for thresholds.
    """

    names: tuple[str, ...]
    difference: Floats
    sigma: Floats
    nulls: Floats
    answers: tuple[Answer, ...]

    @property
    def z(self) -> Floats:
        """(sessions, F) how far each feature is off before anything is added."""
        return self.difference / self.sigma

    def only(self, names: Sequence[str]) -> "Evidence":
        """The same with some of the candidates."""
        kept = tuple(answer for answer in self.answers if answer.candidate.name in names)
        return Evidence(self.names, self.difference, self.sigma, self.nulls, kept)


def evidence_of(tables: Sequence[ResponseTable], asked: Sequence[Candidate]) -> Evidence:
    """Pool the nulls, and work out the answers at all sizes."""
    nulls = np.concatenate([table.nulls for table in tables])
    centre = nulls.mean(axis=0)
    spread = np.sqrt(np.square(nulls - centre).sum(axis=0) / max(1, len(nulls) - 1))
    floors = np.array([table.floors for table in tables])
    sigma = np.sqrt(spread**2 + floors**2)
    sigma[sigma == 0.0] = 1.0  # of regressors that these motions have not
    runs = len(nulls) // len(tables)
    return Evidence(
        names=tuple(table.name for table in tables),
        difference=np.array([table.difference for table in tables]) - centre,
        sigma=sigma,
        nulls=(nulls - centre) / np.repeat(sigma, runs, axis=0),
        answers=tuple(_answer(tables, candidate) for candidate in asked),
    )


def _answer(tables: Sequence[ResponseTable], candidate: Candidate) -> Answer:
    if candidate.phase_deg is not None:
        return _turned(tables, candidate)
    seen = np.array([table.responses[key(candidate)] for table in tables])  # sessions, nodes, dice, F
    if candidate.realisations > 1:
        return _random(seen, candidate)
    nodes = seen[:, :, 0].transpose(1, 0, 2)
    return Answer(candidate, _at_sizes(candidate, nodes), np.zeros((len(candidate.sizes), seen.shape[-1])))


def _random(seen: Floats, candidate: Candidate) -> Answer:
    """Runs of all sessions are one sample; what may go either way has no mean."""
    pooled = seen.transpose(1, 0, 2, 3).reshape(seen.shape[1], -1, seen.shape[-1])
    mean = np.where(LINEAR, 0.0, pooled.mean(axis=1))
    spread = np.sqrt(np.square(pooled - mean[:, None]).mean(axis=1))
    wide = np.repeat(_at_sizes(candidate, mean[:, None]), seen.shape[0], axis=1)
    return Answer(candidate, wide, _at_sizes(candidate, spread[:, None])[:, 0])


def _turned(tables: Sequence[ResponseTable], candidate: Candidate) -> Answer:
    """A sine of any phase out of those of 0 and 90 degrees: exact where features are linear."""
    phase = np.deg2rad(candidate.phase_deg or 0.0)
    at_0, at_90 = (
        np.array([table.responses[simulated_key(candidate, deg)][0, 0] for table in tables]) for deg in (0.0, 90.0)
    )
    node = np.where(LINEAR, np.cos(phase) * at_0 + np.sin(phase) * at_90, 0.5 * (at_0 + at_90))
    share = candidate.sizes / candidate.grid_points[0]
    return Answer(candidate, _scaled(node, share), np.zeros((len(share), node.shape[-1])))


def _at_sizes(candidate: Candidate, nodes: Floats) -> Floats:
    """Changes at a candidate's nodes, (nodes, …, F), taken to all of its sizes."""
    if candidate.grid_points[0] < 0.0:
        up = _scaled(nodes[1], candidate.sizes[candidate.sizes > 0.0] / candidate.grid_points[1])
        down = _scaled(nodes[0], candidate.sizes[candidate.sizes < 0.0] / candidate.grid_points[0])
        return np.concatenate([down, up])
    if len(candidate.grid_points) == 1:
        return nodes
    place = np.interp(np.log(candidate.sizes), np.log(candidate.grid_points), np.arange(len(candidate.grid_points)))
    left = np.minimum(place.astype(np.int64), len(nodes) - 2)
    part = (place - left).reshape(-1, *([1] * (nodes.ndim - 1)))
    found: Floats = (1.0 - part) * nodes[left] + part * nodes[left + 1]
    return found


def _scaled(node: Floats, share: Floats) -> Floats:
    """A linear effect at shares of a size: variances grow with the square, shares of samples no further."""
    by = share.reshape(-1, *([1] * node.ndim))
    squares = np.log1p(np.expm1(np.clip(node, 0.0, 20.0)) * by**2)
    logs = np.where(node > 0.0, squares, node * np.minimum(by, 1.0))
    found: Floats = np.where(LINEAR, node * by, np.where(IS_LOG, logs, node * np.minimum(by, 1.0)))
    return found
