"""Joint fit of two effects that compensate each other.

A tilt of the sensor reduces the yaw rate, and a scale error may increase it as much. The recordings determine the sum
of both far better than either size, so the density of the sizes is a narrow ridge. A search along a single size at a
time does not move along the ridge.
"""

from collections.abc import Collection, Sequence
from typing import NamedTuple

import numpy as np

from gyrodrift.diagnose.inference.scorer import EXACT, Placed, Scorer
from gyrodrift.diagnose.inference.template import Template
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.values.arrays import Floats

REACH = 8
"""Points on either side of the best point over which a size is summed. Chosen: a third of a decade, longer than a
ridge."""


class Pair(NamedTuple):
    """Names of an effect and of the effect that it acts like."""

    first: str
    second: str


def pair_in(names: Collection[str]) -> Pair | None:
    """The two effects of a set that compensate each other; None if there are none."""
    pairs = (Pair(name, KINDS[name].acts_like or "") for name in names if name in KINDS)
    return next((pair for pair in pairs if pair.second in names), None)


def placed_together(scorer: Scorer, placed: Sequence[Placed]) -> list[Placed]:
    """The effects of a set; two that compensate each other are placed at their best pair of points."""
    pair = pair_in([item.template.name for item in placed])
    if pair is None:
        return list(placed)
    fixed = [item for item in placed if item.template.name not in pair]
    first, second = (scorer.templates[name] for name in pair)
    i, j = _best_pair(scorer, first, second, fixed)
    first, second = first.finer(first.near(i, 1)), second.finer(second.near(j, 2))
    i, j = _best_pair(scorer, first, second, fixed)
    together = {pair.first: Placed(first, i, EXACT), pair.second: Placed(second, j, EXACT)}
    return [together.get(item.template.name, item) for item in placed]


def summed_along(scorer: Scorer, placed: Sequence[Placed], name: str, power: float) -> tuple[Floats, Floats]:
    """Sizes of an effect, (P,), and their log posterior, summed over the sizes of its partner."""
    own = next(item for item in placed if item.template.name == name)
    pair = pair_in([item.template.name for item in placed])
    partner = next(item for item in placed if pair is not None and item.template.name in {*pair} - {name})
    fixed = [item for item in placed if item is not own and item is not partner]
    first, second = (_around(scorer, item) for item in (own, partner))
    log_weights = log_posterior(scorer, first, second, fixed, power)
    return first.size, np.logaddexp.reduce(log_weights, axis=1)


def log_posterior(
    scorer: Scorer, first: Template, second: Template, fixed: Sequence[Placed], power: float = 1.0
) -> Floats:
    """(P, Q) log posterior at all pairs of points of two templates, except for a constant."""
    rows = [
        np.logaddexp(*scorer.with_priors(*scorer.along(second, [*fixed, Placed(first, i, EXACT)], EXACT), power))
        for i in range(len(first.size))
    ]
    total: Floats = np.array(rows) + first.log_prior[:, None] + second.log_prior
    return total


def _best_pair(scorer: Scorer, first: Template, second: Template, fixed: Sequence[Placed]) -> tuple[int, int]:
    log_weights = log_posterior(scorer, first, second, fixed)
    i, j = np.unravel_index(int(log_weights.argmax()), log_weights.shape)
    return int(i), int(j)


def _around(scorer: Scorer, item: Placed) -> Template:
    """Finer points within REACH of a placed effect."""
    template = scorer.templates[item.template.name]
    response = int(item.template.response[item.point])
    own = np.flatnonzero(template.response == response)
    nearest = int(own[np.abs(template.size[own] - item.size).argmin()])
    return template.finer(template.near(nearest, REACH))
