"""Grids of sizes and the variants made of them: the parts that the records of candidates are put together from."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate_kind import Hints, SizeGrid, Variant

PER_DECADE = 24
"""Sizes between which a fit decides, to a decade: steps of a tenth."""

PHASE_STEP_DEG = 30.0
"""Between phases that are tried."""

PHASES_DEG = tuple(np.arange(0.0, 360.0, PHASE_STEP_DEG).tolist())

INNER = 10.0
"""What is linear in its size is simulated at this part of its largest one, far from the ends of any range."""

LONGER = 1.3
"""A size that is worth another simulation."""

Variants = Callable[[Hints], Sequence[Variant]]


def between(least: float, most: float) -> Floats:
    """Sizes in even ratios, PER_DECADE of them to a decade."""
    return np.geomspace(least, most, round(PER_DECADE * np.log10(most / least)) + 1)


def linear_grid(least: float, most: float) -> SizeGrid:
    """Of either sign, for what is exactly linear in its size: two simulations say all."""
    up = between(least, most)
    return SizeGrid(np.array([-most, most]) / INNER, np.concatenate([-up[::-1], up]))


def simulated_grid(*points: float) -> SizeGrid:
    """Simulated at these sizes, interpolated between them."""
    return SizeGrid(np.array(points), between(points[0], points[-1]))


def linear(least: float, most: float) -> Variants:
    """One variant on a linear grid."""
    return lambda _: [Variant(linear_grid(least, most))]


def simulated(*points: float) -> Variants:
    """One variant, simulated at these sizes."""
    return lambda _: [Variant(simulated_grid(*points))]


def simulated_and_shown(shown: Callable[[Hints], float], *points: float) -> Variants:
    """Simulated at these sizes and at the one that the recordings show, where it is one between them."""

    def variants(hints: Hints) -> Sequence[Variant]:
        grid, own = simulated_grid(*points), shown(hints)
        if not points[0] < own < points[-1]:
            return [Variant(grid)]
        return [Variant(SizeGrid(np.union1d(grid.points, own), np.union1d(grid.sizes, own)))]

    return variants


def simulated_within(periods: float, *points_ms: float) -> Variants:
    """Simulated at these times, and at so many sample periods where that is longer."""

    def variants(hints: Hints) -> Sequence[Variant]:
        most_ms = periods * hints.sample_period_s * 1e3
        return [Variant(simulated_grid(*points_ms, *([most_ms] if most_ms > LONGER * points_ms[-1] else [])))]

    return variants


def turned(least: float, most: float) -> Variants:
    """Linear, once per turn: the simulations at 0 and 90 degrees are turned to every other phase."""
    grid = SizeGrid(np.array([most / INNER]), between(least, most))
    return lambda _: [Variant(grid, {"phase_deg": phase_deg}, phase_deg) for phase_deg in PHASES_DEG]


def one_of(
    grid: SizeGrid,
    others: Sequence[Mapping[str, float]],
    shown: Callable[[Hints], Sequence[Mapping[str, float]]] = lambda _: (),
) -> Variants:
    """A variant for each of several sets of the other parameters, and of those that the recordings show."""
    return lambda hints: [Variant(grid, fixed) for fixed in (*others, *shown(hints))]


def also_with(variants: Variants, hint: Callable[[Hints], Mapping[str, float]]) -> Variants:
    """These variants, and each with further parameters that the recordings show, if they show any."""

    def both(hints: Hints) -> Sequence[Variant]:
        own, shown = variants(hints), hint(hints)
        with_shown = [replace(variant, fixed={**variant.fixed, **shown}) for variant in own if shown]
        return [*own, *with_shown]

    return both


def hinted(parameter: str, hint: Callable[[Hints], float], *points: float) -> Variants:
    """A second parameter that the recordings show."""
    return lambda hints: [Variant(simulated_grid(*points), {parameter: hint(hints)})]


def read_off(hint: Callable[[Hints], float]) -> Variants:
    """The size itself is what the recordings show."""
    return lambda hints: [Variant(SizeGrid(*[np.array([hint(hints)])] * 2))]
