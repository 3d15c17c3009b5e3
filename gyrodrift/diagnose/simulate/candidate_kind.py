"""Records of effects as candidate causes, and the candidates that they give on recordings.

A `CandidateKind` holds all that diagnose knows of an effect. It gives one or more `Candidate`s, whose second parameter
is fixed. `Hints` are the second parameters that the recordings show.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.simulate.candidate import Candidate, Need, Touches
from gyrodrift.values.arrays import Floats

SAME_SIZE = 0.05
"""Relative difference of two sizes below which an effect counts as equal to the effect in the rig. Chosen: half a step
of the sizes."""


@dataclass(frozen=True, slots=True)
class Hints:
    """Second parameters of candidates, estimated from the recordings; usually the median over all recordings.

    line_hz, spike_dps, slip_deg
        Frequency of the strongest tone at rest, height of rate outliers, height of jumps of the angle.
    rate_step_dps, angle_step_deg
        Steps of rates and angles.
    least_dps, largest_dps
        Rate below which the device reports zero, and its largest rate.
    sample_period_s, bunch_s
        Sample period, and distance of two bunches of samples at the host; 0 without bunches.
    bunch_spread, handover_s
        Standard deviation of the distances of bunches divided by their mean, 0 for even ticks; and distance of samples
        within a bunch.
    dps_per_lsb
        Step of the rate in the rig.
    curve_per_c
        Curve of the bias over the temperature, divided by its slope at the reference; 0 without a sweep.
    lean_deg
        Direction in which the turn axis leans from the yaw axis, from x to y; 0 without three axes.
    """

    line_hz: float
    spike_dps: float
    slip_deg: float
    rate_step_dps: float
    angle_step_deg: float
    least_dps: float
    largest_dps: float
    sample_period_s: float
    bunch_s: float
    dps_per_lsb: float
    lean_deg: float = 0.0
    bunch_spread: float = 0.0
    handover_s: float = 0.0
    curve_per_c: float = 0.0


@dataclass(frozen=True, slots=True)
class SizeGrid:
    """Simulated sizes and sizes of the fit, ascending, one dimension; 0 means no effect."""

    points: Floats
    sizes: Floats


@dataclass(frozen=True, slots=True)
class Variant:
    """A grid of sizes at fixed values of all other parameters.

    fixed
        Values of other parameters, by name.
    phase_deg
        Phase of a once-per-turn effect, or None. Only 0 and 90 degrees are simulated.
    """

    grid: SizeGrid
    fixed: Mapping[str, float] = field(default_factory=dict)
    phase_deg: float | None = None

    @property
    def label(self) -> str:
        """Fixed parameters as text; unique among the variants of a kind."""
        return ", ".join(f"{name} {value:.4g}" for name, value in self.fixed.items())


@dataclass(frozen=True, slots=True)
class CandidateKind:
    """Record of an effect as a candidate cause.

    name
        Name in the simulator's catalog.
    parameter
        Name of the parameter that is the size.
    variants
        Function from hints to the variants to try.
    group
        Name of a group of effects with similar responses; None for a group of its own.
    needs, touches
        Data that recordings need for it, and the parts of a recording that it changes.
    realisations
        Random draws for each size; 1 for a deterministic effect.
    is_exact
        Whether every device has the same form of it: a gain is a line and a tilt a sine, but a nonlinearity is any
        curve.
    matters_from
        Value of the parameter below which the effect is practically negligible for yaw; None if unknown. It is twice
        the relevance threshold of its regressor (nonlinearity: eight times).
    of_size
        Function from a size to the parameter.
    less_is_more
        Whether a smaller parameter is a stronger effect.
    is_read_off
        Whether the recordings show its size or height directly; at its typical size it is visible in every recording.
    acts_like
        Name of another effect: with a negative size, it has the same response in recordings that lack a need. Both
        effects then stay possible.
    meaning
        Of a plug-in: one sentence that says how the effect acts, without a full stop. `report/effect_words.py` has
        those of the catalog.
    """

    name: str
    parameter: str
    variants: Callable[[Hints], Sequence[Variant]]
    group: str | None = None
    needs: tuple[Need, ...] = ()
    touches: Touches = Touches.EVERYTHING
    realisations: int = 1
    is_exact: bool = False
    matters_from: float | None = None
    of_size: Callable[[float], float] = float
    less_is_more: bool = False
    is_read_off: bool = False
    acts_like: str | None = None
    meaning: str = ""

    def candidates(self, hints: Hints, in_rig: Effect | None = None, *, is_phase_free: bool = False) -> list[Candidate]:
        """One candidate for each variant; for an effect in the rig, only candidates that change it."""
        variants = list(self.variants(hints))
        if in_rig is None:
            return [self._candidate(variant, is_phase_free=is_phase_free) for variant in variants]
        if variants[0].grid.points[0] < 0.0 or variants[0].phase_deg is not None:
            return [self._added_to_rig(variants[0], in_rig)]
        replacements = [self._replacing_rig(variant, in_rig) for variant in variants]
        return [candidate for candidate in replacements if len(candidate.sizes)]

    def _candidate(self, variant: Variant, *, is_phase_free: bool = False) -> Candidate:
        return Candidate(
            name=self.name,
            variant=variant.label,
            make=lambda size: self._effect(size, variant.fixed),
            parameter=self.parameter,
            grid_points=variant.grid.points,
            sizes=variant.grid.sizes,
            group=self.group or self.name,
            needs=self.needs,
            touches=self.touches,
            realisations=self.realisations,
            is_exact=self.is_exact,
            phase_deg=variant.phase_deg,
            is_phase_free=is_phase_free and variant.phase_deg is not None,
        )

    def _added_to_rig(self, variant: Variant, in_rig: Effect) -> Candidate:
        """Candidate of a linear effect that the rig has: sizes are additions to the rig's size, simulated alone."""
        up = variant.grid.sizes[variant.grid.sizes > 0.0]
        most = float(np.abs(variant.grid.points).max())
        has = float(getattr(in_rig, self.parameter))

        def changed(size: float) -> Effect:
            # All parameters are set explicitly, so that reports state them.
            return in_rig.model_copy(update={**in_rig.model_dump(), self.parameter: has + size})

        down, lowest = -up[::-1], _bound(type(in_rig), self.parameter, "ge", -np.inf) - has
        if lowest > down[0]:
            down = np.concatenate([[lowest], down[down > lowest]])
        grid = SizeGrid(np.array([-most, most]), np.concatenate([down, up]))
        return replace(
            self._candidate(variant), variant="on top", make=changed, grid_points=grid.points, sizes=grid.sizes,
            phase_deg=None, in_rig=in_rig,
        )  # fmt: skip

    def _replacing_rig(self, variant: Variant, in_rig: Effect) -> Candidate:
        """Candidate that replaces the rig's effect: other sizes, with the rig's values of other parameters."""
        fixed = {name: value for name, value in in_rig.model_dump().items() if name not in {"name", self.parameter}}
        candidate = self._candidate(replace(variant, fixed={**fixed, **variant.fixed}))
        touches = Touches.VALUES if candidate.touches is Touches.SLOW_RATE else candidate.touches
        new_sizes = [size for size in candidate.sizes.tolist() if not self._is_same(candidate.make(size), in_rig)]
        has = float(getattr(in_rig, candidate.parameter))
        points = candidate.grid_points if touches is Touches.RATE else _with_rig_size(candidate, has)
        return replace(candidate, touches=touches, in_rig=in_rig, grid_points=points, sizes=np.array(new_sizes))

    def _is_same(self, effect: Effect, in_rig: Effect) -> bool:
        """Whether an effect equals the one in the rig, with a size that differs by less than SAME_SIZE."""
        size, has = float(getattr(effect, self.parameter)), float(getattr(in_rig, self.parameter))
        like = effect.model_copy(update={self.parameter: getattr(in_rig, self.parameter)})
        return abs(size - has) < SAME_SIZE * abs(has) and like.model_dump() == in_rig.model_dump()

    def _effect(self, size: float, fixed: Mapping[str, float]) -> Effect:
        kind = CATALOGUE[self.name]
        values = {"name": self.name, self.parameter: _allowed(kind, self.parameter, self.of_size(size)), **fixed}
        return kind.model_validate(values)


def _with_rig_size(candidate: Candidate, has: float) -> Floats:
    """Sizes to simulate, including the rig's own size, at which nothing changes; `has` is its parameter.

    Interpolated between the simulated sizes on either side of it, a small change would look like a large one.
    """
    points = candidate.grid_points
    if len(points) < 2 or has <= 0.0:
        return points
    made = np.array([float(getattr(candidate.make(size), candidate.parameter)) for size in candidate.sizes.tolist()])
    order = np.argsort(made)
    own = float(np.exp(np.interp(np.log(has), np.log(made[order]), np.log(candidate.sizes[order]))))
    if not points[0] < own < points[-1]:
        return points
    return np.union1d(points[np.abs(points - own) > SAME_SIZE * own], own)


def _allowed(kind: type[Effect], parameter: str, value: float) -> float:
    """Value limited to the bounds of a parameter, since a hint may lie beyond them."""
    least, most = _bound(kind, parameter, "ge", -np.inf), _bound(kind, parameter, "le", np.inf)
    return value if least <= value <= most else type(value)(min(max(value, least), most))


def _bound(kind: type[Effect], parameter: str, which: str, otherwise: float) -> float:
    """Bound of a parameter in its annotations (`ge` or `le`), or `otherwise`."""
    bounds = [getattr(annotation, which, None) for annotation in kind.model_fields[parameter].metadata]
    return next((float(bound) for bound in bounds if bound is not None), otherwise)
