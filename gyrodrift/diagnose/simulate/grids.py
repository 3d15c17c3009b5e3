"""Grids of sizes, and functions that build the variants of a candidate from them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from gyrodrift.diagnose.simulate.candidate_kind import Hints, SizeGrid, Variant
from gyrodrift.values.arrays import Floats

PER_DECADE = 24
"""Sizes of a fit per decade. Chosen: a step of 10 %."""

PHASE_STEP_DEG = 30.0
"""Step of the phases that are tried. Chosen: an error of half a step takes 3 % of an amplitude."""

PHASES_DEG = tuple(np.arange(0.0, 360.0, PHASE_STEP_DEG).tolist())

INNER = 10.0
"""Largest size over the simulated size of a linear effect. Chosen: a smaller simulation stays within the range."""

LONGER = 1.3
"""Ratio of two sizes from which on the larger one gets its own simulation. Chosen: about three steps of the sizes."""

Variants = Callable[[Hints], Sequence[Variant]]
"""Function from hints to the variants of a candidate."""


def between(least: float, most: float) -> Floats:
    """Sizes with equal ratios, PER_DECADE per decade."""
    return np.geomspace(least, most, round(PER_DECADE * np.log10(most / least)) + 1)


def linear_grid(least: float, most: float) -> SizeGrid:
    """Grid of both signs for an effect that is linear in its size: two simulations give all sizes."""
    up = between(least, most)
    return SizeGrid(np.array([-most, most]) / INNER, np.concatenate([-up[::-1], up]))


def simulated_grid(*points: float) -> SizeGrid:
    """Grid that is simulated at these sizes and interpolated between them."""
    return SizeGrid(np.array(points), between(points[0], points[-1]))


def linear(least: float, most: float) -> Variants:
    """One variant, on a linear grid."""
    return lambda _: [Variant(linear_grid(least, most))]


def simulated(*points: float) -> Variants:
    """One variant, simulated at these sizes."""
    return lambda _: [Variant(simulated_grid(*points))]


def simulated_and_shown(shown: Callable[[Hints], float], *points: float) -> Variants:
    """One variant, simulated at these sizes, and at the size that the recordings show if it lies between them."""

    def variants(hints: Hints) -> Sequence[Variant]:
        grid, shown_size = simulated_grid(*points), shown(hints)
        if not points[0] < shown_size < points[-1]:
            return [Variant(grid)]
        return [Variant(SizeGrid(np.union1d(grid.points, shown_size), np.union1d(grid.sizes, shown_size)))]

    return variants


def simulated_within(periods: float, *points_ms: float) -> Variants:
    """One variant, simulated at these times, and at a number of sample periods if that is longer."""

    def variants(hints: Hints) -> Sequence[Variant]:
        most_ms = periods * hints.sample_period_s * 1e3
        return [Variant(simulated_grid(*points_ms, *([most_ms] if most_ms > LONGER * points_ms[-1] else [])))]

    return variants


def once_per_turn(least: float, most: float) -> Variants:
    """One variant per phase, for a linear effect with one period per turn.

    Only 0 and 90 degrees are simulated. The response at any other phase is a sum of these two.
    """
    grid = SizeGrid(np.array([most / INNER]), between(least, most))
    return lambda _: [Variant(grid, {"phase_deg": phase_deg}, phase_deg) for phase_deg in PHASES_DEG]


def one_of(
    grid: SizeGrid,
    parameter_sets: Sequence[Mapping[str, float]],
    shown: Callable[[Hints], Sequence[Mapping[str, float]]] = lambda _: (),
) -> Variants:
    """One variant per set of the other parameters; the recordings may show further sets."""
    return lambda hints: [Variant(grid, fixed) for fixed in (*parameter_sets, *shown(hints))]


def also_with(variants: Variants, hint: Callable[[Hints], Mapping[str, float]]) -> Variants:
    """All variants, and copies of them with further parameters, if the recordings show any."""

    def extended(hints: Hints) -> Sequence[Variant]:
        own, shown = variants(hints), hint(hints)
        with_shown = [replace(variant, fixed={**variant.fixed, **shown}) for variant in own if shown]
        return [*own, *with_shown]

    return extended


def hinted(parameter: str, hint: Callable[[Hints], float], *points: float) -> Variants:
    """One variant, with the value of a second parameter that the recordings show."""
    return lambda hints: [Variant(simulated_grid(*points), {parameter: hint(hints)})]


def read_off(hint: Callable[[Hints], float]) -> Variants:
    """One variant with a single size, which the recordings show."""
    return lambda hints: [Variant(SizeGrid(*[np.array([hint(hints)])] * 2))]
