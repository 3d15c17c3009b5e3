"""Templates: what an effect does to the features at each point of its grid of variants, phases and sizes."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np

from gyrodrift.arrays import Floats, Integers
from gyrodrift.diagnose.inference.evidence import Response
from gyrodrift.diagnose.inference.pooling import ONCE_PER_TURN
from gyrodrift.diagnose.posterior.observation import Observation
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key

NOTICEABLE = 2.0
"""Least length of the change over all features, in standard deviations, from which on a size counts as an effect.
Smaller sizes belong to the hypothesis without the effect."""

COARSE_STEP = 4
"""Every fourth size is tried before all are."""


@dataclass(frozen=True, slots=True, eq=False)
class Template:
    """One effect at P points.

    mean
        (P, S, F) change of the features, in units of the observation.
    scatter
        (P, F) variance of a random effect, likewise; 0 for a deterministic one.
    log_prior
        (P,) of the points, given that the effect acts.
    response, size
        (P,) index of the response (variant and phase) and of its size.
    coarse
        (C,) points that are tried first.
    """

    name: str
    responses: tuple[Response, ...]
    mean: Floats
    scatter: Floats
    log_prior: Floats
    response: Integers
    size: Integers
    coarse: Integers

    @property
    def is_out_of_catalogue(self) -> bool:
        """Whether no effect of the simulator does this."""
        return self.responses[0].candidate.is_out_of_catalogue

    def values(self) -> Floats:
        """(P,) sizes."""
        pairs = zip(self.response, self.size, strict=True)
        return np.array([self.responses[response].candidate.sizes[size] for response, size in pairs])


@dataclass(frozen=True, slots=True, eq=False)
class _Points:
    """Noticeable points of one response."""

    mean: Floats
    scatter: Floats
    log_prior: Floats
    size: Integers


def templates_of(
    observation: Observation, tables: Sequence[ResponseTable], responses: Sequence[Response]
) -> list[Template]:
    """One template for each effect that some size of would be noticed."""
    in_order = sorted(responses, key=lambda response: response.candidate.name)
    grouped = groupby(in_order, key=lambda response: response.candidate.name)
    templates = (_template(name, observation, tables, tuple(variants)) for name, variants in grouped)
    return [template for template in templates if template is not None]


def _template(
    name: str, observation: Observation, tables: Sequence[ResponseTable], responses: tuple[Response, ...]
) -> Template | None:
    parts = [_points(observation, tables, response) for response in responses]
    total = sum(len(part.size) for part in parts)
    if not total:
        return None
    return Template(
        name=name,
        responses=responses,
        mean=np.concatenate([part.mean for part in parts]),
        scatter=np.concatenate([part.scatter for part in parts]),
        log_prior=np.concatenate([part.log_prior for part in parts]) - np.log(len(responses)),
        response=np.repeat(np.arange(len(parts)), [len(part.size) for part in parts]),
        size=np.concatenate([part.size for part in parts]),
        coarse=np.array([*_coarse(parts)]),
    )


def _points(observation: Observation, tables: Sequence[ResponseTable], response: Response) -> _Points:
    """Sizes are equally probable on a logarithmic scale; a phase fitted to each session costs its Occam factor."""
    mean = np.where(observation.is_compared, _means(tables, response) / observation.unit, 0.0)
    scatter = np.square(response.spread[:, None] / observation.unit).mean(axis=1)
    scatter *= observation.is_compared.any(axis=0)
    length = np.sqrt(np.square(mean).sum(axis=(1, 2)) + observation.sessions * scatter.sum(axis=1))
    kept = np.flatnonzero(length > NOTICEABLE)
    log_prior = np.full(len(kept), -np.log(max(len(kept), 1)))
    if response.phases_deg is not None:
        curvature = np.square(mean[kept][:, :, ONCE_PER_TURN]).sum(axis=2)
        log_prior = log_prior - 0.5 * np.log1p(2.0 * np.pi * curvature).sum(axis=1)
    return _Points(mean[kept], scatter[kept], log_prior, kept)


def _means(tables: Sequence[ResponseTable], response: Response) -> Floats:
    """(sizes, S, F) on straight lines between simulated sizes, where the effect is not random."""
    candidate = response.candidate
    points = candidate.grid_points
    if candidate.realisations > 1 or len(points) < 2 or points[0] < 0.0:
        return response.mean
    nodes = np.array([table.responses[key(candidate)][:, 0] for table in tables]).transpose(1, 0, 2)
    slot = np.interp(candidate.sizes, points, np.arange(len(points)))
    lower = np.minimum(slot.astype(np.int64), len(points) - 2)
    part = (slot - lower)[:, None, None]
    means: Floats = (1.0 - part) * nodes[lower] + part * nodes[lower + 1]
    return means


def _coarse(parts: Sequence[_Points]) -> Iterator[int]:
    start = 0
    for part in parts:
        count = len(part.size)
        step = COARSE_STEP if count > COARSE_STEP else 1
        yield from range(start + (count // 2) % step, start + count, step)
        start += count
