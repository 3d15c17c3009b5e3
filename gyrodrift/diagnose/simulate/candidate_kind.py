"""Records of effects as candidate causes, and the candidates that they give on recordings.

A `CandidateKind` holds all that diagnose knows of an effect. It gives one or more `Candidate`s, whose second parameter
is fixed. `Hints` are the second parameters that the recordings show.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.simulate.candidate import Candidate, Need, Touches

SAME = 0.05
"""Of its own size: an effect that the rig has so nearly is the one that it has."""


@dataclass(frozen=True, slots=True)
class Hints:
    """What the recordings themselves show of a candidate's second parameter, the median over all of them.

    line_hz, spike_dps, slip_deg
        The strongest tone at rest, heights of outliers and of jumps of the angle.
    rate_step_dps, angle_step_deg
        The steps that rates and angles come in.
    least_dps, largest_dps
        Rates below which the device puts out zero, and that it does not exceed.
    sample_period_s, bunch_s
        Distance of two samples, and of two bunches of them at the host; 0 where there are none.
    bunch_spread, handover_s
        Standard deviation of the distances of bunches as a share of their mean, 0 on even ticks; and the distance of
        samples within a bunch.
    dps_per_lsb
        Steps of the rate as the rig has them.
    curve_per_c
        Curve of the bias over the temperature relative to its slope at the reference; 0 without a sweep.
    lean_deg
        Direction in which the turn leans from the yaw axis, from x to y; 0 without three axes.
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
    """Sizes that are simulated, rising, and those that a fit decides between; 0 stands for none. Shape (some,) each."""

    points: Floats
    sizes: Floats


@dataclass(frozen=True, slots=True)
class Variant:
    """A grid of sizes with everything else fixed.

    fixed
        Other parameters of the effect.
    phase_deg
        Of an effect once per turn; only those of 0 and 90 degrees are simulated.
    """

    grid: SizeGrid
    fixed: Mapping[str, float] = field(default_factory=dict)
    phase_deg: float | None = None

    @property
    def label(self) -> str:
        """Tells it from the others of its kind."""
        return ", ".join(f"{name} {value:.4g}" for name, value in self.fixed.items())


@dataclass(frozen=True, slots=True)
class CandidateKind:
    """All that is known of an effect as a cause.

    name
        Of the effect in the catalogue of the simulator.
    parameter
        Which of its parameters is the size.
    variants
        What is tried, given what the recordings show.
    meaning
        What the effect does, in a sentence for a person, without its period.
    group
        Name of the effects that look like it; where None is given it is a group of its own.
    needs, touches
        What recordings have to hold for it, and what it changes in them.
    realisations
        How many draws a size takes: one where chance plays no part.
    is_exact
        Whether a device can follow no other form: a gain is a line, and a tilt a sine, where a bend may be any curve.
    matters_from
        Size of its parameter below which it is practically negligible for yaw, twice what the relevance threshold of
        its regressor amounts to (nonlinearity: eight times); None where nothing is known.
    of_size
        From a size to the parameter, where that is not the size itself.
    less_is_more
        Whether the effect acts the more, the smaller its parameter is.
    is_read_off
        Whether the recordings show its size or height: at typical size it would show in any of them.
    acts_like
        Name of an effect that changes recordings without `needs` in the same way, with a negative size. Such
        recordings leave both possible.
    """

    name: str
    parameter: str
    variants: Callable[[Hints], Sequence[Variant]]
    meaning: str
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

    def candidates(self, hints: Hints, in_rig: Effect | None = None, *, is_phase_free: bool = False) -> list[Candidate]:
        """One for each variant; of an effect that the rig has already, what changes it."""
        variants = list(self.variants(hints))
        if in_rig is None:
            return [self._candidate(one, is_phase_free=is_phase_free) for one in variants]
        if variants[0].grid.points[0] < 0.0 or variants[0].phase_deg is not None:
            return [self._on_top(variants[0], in_rig)]
        instead = [self._instead(variant, in_rig) for variant in variants]
        return [one for one in instead if len(one.sizes)]

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

    def _on_top(self, variant: Variant, in_rig: Effect) -> Candidate:
        """What is linear in its size: simulated by itself, added to what the rig has."""
        up = variant.grid.sizes[variant.grid.sizes > 0.0]
        most = float(np.abs(variant.grid.points).max())
        has = float(getattr(in_rig, self.parameter))

        def changed(size: float) -> Effect:
            return in_rig.model_copy(update={**in_rig.model_dump(), self.parameter: has + size})  # all of it is stated

        down, lowest = -up[::-1], _bound(type(in_rig), self.parameter, "ge", -np.inf) - has
        if lowest > down[0]:
            down = np.concatenate([[lowest], down[down > lowest]])
        grid = SizeGrid(np.array([-most, most]), np.concatenate([down, up]))
        return replace(
            self._candidate(variant), variant="on top", make=changed, grid_points=grid.points, sizes=grid.sizes,
            phase_deg=None, in_rig=in_rig,
        )  # fmt: skip

    def _instead(self, variant: Variant, in_rig: Effect) -> Candidate:
        """What takes the place of the effect in the rig, at other sizes, with its other parameters."""
        fixed = {name: value for name, value in in_rig.model_dump().items() if name not in {"name", self.parameter}}
        one = self._candidate(replace(variant, fixed={**fixed, **variant.fixed}))
        touches = Touches.VALUES if one.touches is Touches.SLOW_RATE else one.touches
        others = [size for size in one.sizes.tolist() if not self._is_same(one.make(size), in_rig)]
        points = (
            one.grid_points if touches is Touches.RATE else _with_own_size(one, float(getattr(in_rig, one.parameter)))
        )
        return replace(one, touches=touches, in_rig=in_rig, grid_points=points, sizes=np.array(others))

    def _is_same(self, effect: Effect, in_rig: Effect) -> bool:
        """Whether an effect is the one in the rig, but for SAME of its size."""
        size, has = float(getattr(effect, self.parameter)), float(getattr(in_rig, self.parameter))
        like = effect.model_copy(update={self.parameter: getattr(in_rig, self.parameter)})
        return abs(size - has) < SAME * abs(has) and like.model_dump() == in_rig.model_dump()

    def _effect(self, size: float, fixed: Mapping[str, float]) -> Effect:
        kind = CATALOGUE[self.name]
        values = {"name": self.name, self.parameter: _allowed(kind, self.parameter, self.of_size(size)), **fixed}
        return kind.model_validate(values)


def _with_own_size(candidate: Candidate, has: float) -> Floats:
    """Sizes to simulate, and the size in the rig among them, where nothing changes; `has` is its parameter.

    Between sizes that were simulated on either side of it, a small change would look like a large one.
    """
    points = candidate.grid_points
    if len(points) < 2 or has <= 0.0:
        return points
    made = np.array([float(getattr(candidate.make(size), candidate.parameter)) for size in candidate.sizes.tolist()])
    order = np.argsort(made)
    own = float(np.exp(np.interp(np.log(has), np.log(made[order]), np.log(candidate.sizes[order]))))
    if not points[0] < own < points[-1]:
        return points
    return np.union1d(points[np.abs(points - own) > SAME * own], own)


def _allowed(kind: type[Effect], parameter: str, value: float) -> float:
    """The nearest value that a parameter may take: recordings may hint at one that it may not."""
    least, most = _bound(kind, parameter, "ge", -np.inf), _bound(kind, parameter, "le", np.inf)
    return value if least <= value <= most else type(value)(min(max(value, least), most))


def _bound(kind: type[Effect], parameter: str, which: str, otherwise: float) -> float:
    """The bound that an annotation gives."""
    bounds = [getattr(one, which, None) for one in kind.model_fields[parameter].metadata]
    return next((float(one) for one in bounds if one is not None), otherwise)
