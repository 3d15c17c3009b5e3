"""Templates: the change of the features by an effect at each point of its grid of variants, phases and sizes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any

import numpy as np

from gyrodrift.diagnose.features.vector import LINEAR
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.factors import MOST_FACTORS, covariance_of
from gyrodrift.diagnose.inference.log_variances import between_scaled, interpolated
from gyrodrift.diagnose.inference.observation import Observation
from gyrodrift.diagnose.inference.pooling import ONCE_PER_TURN
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.response_table import ENOUGH
from gyrodrift.values.arrays import Floats, Integers

NOTICEABLE = 2.0
"""Least norm of the change over all features, in standard deviations, of a size that counts as an effect. Smaller sizes
belong to the hypothesis without the effect. Chosen: two standard deviations hardly differ from chance."""

COARSE_STEP = 4
"""The search tries every fourth size first, then the sizes next to the best. Chosen: for speed."""

FINER = 8
"""Points into which an interval of sizes is divided about the best size. Chosen: for accuracy, steps of 1.2 %."""


@dataclass(frozen=True, slots=True, eq=False)
class Template:
    """One effect at P points.

    mean
        (P, S, F) change of the features, in units of the observation.
    interpolation_sigma
        (P, S, F) standard deviation of the mean by interpolation between simulated sizes.
    scatter, factors
        (P, S, F) variance of a random effect in each feature alone, and (P, S, K, F) common factors of its features;
        equation (4). Both are 0 for a deterministic effect.
    log_prior
        (P,) log prior of the points, given that the effect acts.
    response, size
        (P,) index of the response (variant and phase), and the size, rising within a response.
    coarse
        (C,) points that are tried first.
    """

    name: str
    responses: tuple[Response, ...]
    mean: Floats
    interpolation_sigma: Floats
    scatter: Floats
    factors: Floats
    log_prior: Floats
    response: Integers
    size: Floats
    coarse: Integers

    @property
    def is_out_of_catalogue(self) -> bool:
        """Whether this is an out-of-catalog form: a change that no effect of the simulator makes."""
        return self.responses[0].candidate.is_out_of_catalogue

    def subset(self, rows: Sequence[int] | Integers) -> "Template":
        """The template at some of its points."""
        index = np.array(rows, dtype=np.int64)
        every = {name: getattr(self, name)[index] for name in PER_POINT}
        return replace(self, **every, coarse=np.arange(len(index)))

    def of_sessions(self, rows: Sequence[int]) -> "Template":
        """The template in some of the sessions."""
        return replace(self, **{name: getattr(self, name)[:, rows] for name in PER_SESSION})

    def nearest_point(self, response: int, size: float) -> tuple["Template", int]:
        """Finer points about a size of a response, and the nearest of them."""
        own = np.flatnonzero(self.response == response)
        finer = self.finer(self.near(int(own[np.abs(self.size[own] - size).argmin()]), 1))
        return finer, int(np.abs(finer.size - size).argmin())

    def near(self, point: int, reach: int) -> list[int]:
        """Neighbors of a point in its response, up to `reach` points away."""
        rows = range(max(point - reach, 0), min(point + reach + 1, len(self.size)))
        return [row for row in rows if self.response[row] == self.response[point]]

    def finer(self, rows: Sequence[int]) -> "Template":
        """Successive points of a response on a finer grid, by linear interpolation.

        The grid reaches half a step beyond both ends, as far as the prior of the points does.
        """
        if len(rows) < 2:
            return self.subset(rows)
        own = np.flatnonzero(self.response == self.response[rows[0]])
        first, last = (np.clip(end, own[0], own[-1]) for end in (rows[0] - 0.5, rows[-1] + 0.5))
        positions = np.linspace(first, last, FINER * len(rows))
        lower = np.minimum(positions.astype(np.int64), own[-1] - 1)
        part = positions - lower

        def between(values: Floats) -> Floats:
            by = part.reshape(-1, *([1] * (values.ndim - 1)))
            line: Floats = (1.0 - by) * values[lower] + by * values[lower + 1]
            return line

        log_prior = np.full(len(positions), np.logaddexp.reduce(self.log_prior[rows]) - np.log(len(positions)))
        response = np.full(len(positions), self.response[rows[0]])
        every: dict[str, Any] = {name: between(getattr(self, name)) for name in (*PER_SESSION, "size")}
        return replace(self, **every, log_prior=log_prior, response=response, coarse=np.arange(len(positions)))


PER_SESSION = ("mean", "interpolation_sigma", "scatter", "factors")
PER_POINT = (*PER_SESSION, "log_prior", "response", "size")
"""Fields with an axis of sessions, and fields with an axis of points."""


def templates_of(observation: Observation, responses: Sequence[Response]) -> list[Template]:
    """One template for each effect with a noticeable size."""
    in_order = sorted(responses, key=lambda response: response.candidate.name)
    grouped = groupby(in_order, key=lambda response: response.candidate.name)
    templates = (_template(name, observation, tuple(variants)) for name, variants in grouped)
    return [template for template in templates if template is not None]


def _template(name: str, observation: Observation, responses: tuple[Response, ...]) -> Template | None:
    """Template of an effect from the responses of its variants; None if no size is noticeable."""
    parts = [_points(observation, response) for response in responses]
    counts = [len(part.size) for part in parts]
    if not sum(counts):
        return None
    return Template(
        name=name,
        responses=responses,
        mean=np.concatenate([part.mean for part in parts]),
        interpolation_sigma=np.concatenate([part.interpolation_sigma for part in parts]),
        scatter=np.concatenate([part.scatter for part in parts]),
        factors=np.concatenate([part.factors for part in parts]),
        log_prior=np.concatenate([part.log_prior for part in parts]) - np.log(len(responses)),
        response=np.repeat(np.arange(len(parts)), counts),
        size=np.concatenate([part.size for part in parts]),
        coarse=np.array([*_coarse(counts)]),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Points:
    """Noticeable points of one response."""

    mean: Floats
    interpolation_sigma: Floats
    scatter: Floats
    factors: Floats
    log_prior: Floats
    size: Floats


def _points(observation: Observation, response: Response) -> _Points:
    """Noticeable points of a response with their priors.

    Sizes are equally probable on a logarithmic scale. A phase that is fitted to each session has an Occam factor.
    """
    by_unit = observation.is_compared / observation.unit
    if response.realized is None:
        change, interpolation = response.mean, np.full_like(response.mean, response.interpolation_sigma)
        scatter, factors = np.zeros_like(change), np.zeros((*change.shape[:2], 0, change.shape[2]))
    else:
        change, scatter, factors = _random(response.candidate, response.realized)
        interpolation = np.zeros_like(change)
    mean, interpolation_sigma = change * by_unit, interpolation * by_unit
    scatter, factors = scatter * np.square(by_unit), factors * by_unit[:, None]
    squares = np.square(mean) + scatter + np.square(factors).sum(axis=2)
    kept = np.flatnonzero(np.sqrt(squares.sum(axis=(1, 2))) > NOTICEABLE)
    log_prior = np.full(len(kept), -np.log(max(len(kept) + response.candidate.ruled_out, 1)))
    if response.phases_deg is not None:
        curvature = np.square(mean[kept][:, :, ONCE_PER_TURN]).sum(axis=2)
        log_prior = log_prior - 0.5 * np.log1p(2.0 * np.pi * curvature).sum(axis=1)
    sizes = response.candidate.sizes[kept]
    return _Points(mean[kept], interpolation_sigma[kept], scatter[kept], factors[kept], log_prior, sizes)


def _random(candidate: Candidate, realized: Floats) -> tuple[Floats, Floats, Floats]:
    """(sizes, S, F) mean and variance and (sizes, S, K, F) factors, scaled from the nearest simulated size.

    realized
        (grid points, S, realizations, F). If there are few, the realizations of all sessions form one sample.
    """
    sessions = realized.shape[1]
    if realized.shape[2] < ENOUGH:
        pooled = realized.reshape(len(realized), 1, -1, realized.shape[3])
        realized = np.broadcast_to(pooled, (len(realized), sessions, *pooled.shape[2:]))
    at_sizes = between_scaled if candidate.touches in (Touches.SLOW_RATE, Touches.RATE) else interpolated
    mean, spread = _moments(at_sizes(candidate, realized))
    of_nodes, spread_of_nodes = _moments(realized)
    covariances = [
        [covariance_of(own - middle) for own, middle in zip(*node, strict=True)]
        for node in zip(realized, of_nodes, strict=True)
    ]
    nearest = np.abs(np.log(candidate.sizes[:, None] / candidate.grid_points)).argmin(axis=1)
    node_spread = spread_of_nodes[nearest]
    scale = np.where(node_spread > 0.0, spread / np.where(node_spread > 0.0, node_spread, 1.0), 0.0)
    scatter = np.array([[session.scatter for session in node] for node in covariances])[nearest] * np.square(scale)
    factors = np.array([_padded([session.factors for session in node], MOST_FACTORS) for node in covariances])
    return mean, scatter, factors[nearest] * scale[:, :, None]


def _moments(realized: Floats) -> tuple[Floats, Floats]:
    """Mean and standard deviation over realizations, the second last axis; linear features have mean 0."""
    mean: Floats = np.where(LINEAR, 0.0, realized.mean(axis=-2))
    return mean, np.sqrt(np.square(realized - mean[..., None, :]).mean(axis=-2))


def _padded(every: Sequence[Floats], count: int) -> Floats:
    """(…, count, F) factors, padded with zeros."""
    return np.array([np.pad(factors, ((0, count - len(factors)), (0, 0))) for factors in every])


def _coarse(counts: Sequence[int]) -> Iterator[int]:
    """Indices of the points that are tried first, from the numbers of points of the responses."""
    start = 0
    for count in counts:
        step = COARSE_STEP if count > COARSE_STEP else 1
        yield from range(start + (count // 2) % step, start + count, step)
        start += count
