"""Six rows of cases: no gap, a single effect, a small one, a pair, effects outside of the vocabulary, a wrong size."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

from gyrogap.case import DRAWN_AS, BenchmarkCase
from gyrogap.catalogue import EFFECTS, GROUP, JUDGED
from gyrogap.physics.dice import Rng, plan_dice, sign
from gyrogap.physics.driven import MOVERS
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.outside_sizes import OUTSIDE, OUTSIDE_SIZES, draw_outside
from gyrogap.physics.pairs import PAIRS, EffectPair
from gyrogap.physics.sizes import STRENGTHS, draw_strength
from gyrogap.physics.spread import DeviceFacts, draw_fault_for
from gyrogap.physics.stand import Stand
from gyrogap.physics.three_axis_effects import THREE_AXIS_KINDS, draw_three_axis_effect

THREE_AXES_EVERY = 4
"""One case in so many has three axes."""

MOVED_EVERY = 5
"""One case of each row in so many is moved by a robot, a hand or a drone, unless its effect needs a table."""

ON_A_TABLE = ("saturation", "nonlinearity", "temp_bias", "temp_scale", "encoder_slip")
"""Effects that show at the speeds or in the heated sessions of a table only."""

STATED = (0, 1, 2)
"""Numbers of effects of a case that the simulator has, equally probable; at least one where one has a wrong size."""

LEAST_RATIO = 1.5
"""Least ratio of the two sizes of an effect that the simulator has at a wrong size."""

CLEAR = ("typical", "large")

MINUTES = (1.5, 1.75)
"""Length of a session: the shortest that holds the whole motion, and a little more."""

RATES_HZ = (50, 100, 200)
"""Sample rates of the devices."""

ON_THREE_AXES = (
    *THREE_AXIS_KINDS,
    "scale_factor",
    "latency",
    "bandwidth",
    "temp_bias",
    "warmup",
    "clock_drift",
    "encoder_eccentricity",
    "saturation",
    "backlash",
    "deadband",
    "usb_batching",
)
"""Effects of the cases with three axes."""

PAIRS_ON_THREE_AXES = (
    EffectPair("misalignment", "scale_factor"),
    EffectPair("misalignment", "latency"),
    EffectPair("misalignment", "accel_bias"),
    EffectPair("gyro_cross_axis", "temp_bias", ("typical", "large")),
    EffectPair("gyro_cross_axis", "accel_bias"),
    EffectPair("accel_scale", "warmup", ("typical", "large")),
    EffectPair("accel_bias", "clock_drift"),
    EffectPair("bandwidth", "misalignment"),
    EffectPair("accel_scale", "scale_factor"),
    EffectPair("saturation", "gyro_cross_axis"),
)


@dataclass(frozen=True, slots=True)
class CaseSlot:
    """Position of a case: its row, its number, and its index among the cases of the row with as many axes."""

    seed: int
    row: str
    number: int

    @property
    def has_three_axes(self) -> bool:
        """Whether the device has three axes."""
        return self.number % THREE_AXES_EVERY == THREE_AXES_EVERY - 1

    @property
    def index(self) -> int:
        """Index among the cases of the row with as many axes."""
        threes = self.number // THREE_AXES_EVERY
        return threes if self.has_three_axes else self.number - threes

    def stand(self, rng: Rng) -> Stand:
        """A device with its sessions."""
        return Stand(rng, MINUTES, has_three_axes=self.has_three_axes, rates_hz=RATES_HZ)

    def shuffled(self, count: int) -> tuple[int, int]:
        """Round, and an index below `count` in an order of its own for each seed and row: each comes once per round."""
        lap, place_in_lap = divmod(self.index, count)
        order = plan_dice((DRAWN_AS, self.seed, self.row, self.has_three_axes, "order")).permutation(count)
        return lap, int(order[place_in_lap])


def _none(rng: Rng, slot: CaseSlot) -> BenchmarkCase:
    """Nothing but another bias, noise, sample rate and host delay than the simulator states."""
    return _case(rng, slot, slot.stand(rng), ())


def _single(rng: Rng, slot: CaseSlot) -> BenchmarkCase:
    """A typical or large effect."""
    names = _names(slot)
    lap, index = slot.shuffled(len(names))
    return _of_effect(rng, slot, names[index], CLEAR[(lap + index) % len(CLEAR)])


def _small(rng: Rng, slot: CaseSlot) -> BenchmarkCase:
    """A small effect."""
    names = _names(slot)
    return _of_effect(rng, slot, names[slot.shuffled(len(names))[1]], "small")


def _names(slot: CaseSlot) -> Sequence[str]:
    return ON_THREE_AXES if slot.has_three_axes else EFFECTS


def _of_effect(rng: Rng, slot: CaseSlot, name: str, size: str) -> BenchmarkCase:
    stand = slot.stand(rng)
    return _case(rng, slot, stand, (_draw(rng, stand.facts, name, size),), size)


def _pair(rng: Rng, slot: CaseSlot) -> BenchmarkCase:
    """Two effects."""
    stand, pairs = slot.stand(rng), PAIRS_ON_THREE_AXES if slot.has_three_axes else PAIRS
    pair = pairs[slot.shuffled(len(pairs))[1]]
    drawn = zip((pair.first, pair.second), pair.sizes, pair.ways, strict=True)
    return _case(rng, slot, stand, tuple(_draw(rng, stand.facts, name, size, way) for name, size, way in drawn))


def _outside(rng: Rng, slot: CaseSlot) -> BenchmarkCase:
    """An effect that the vocabulary does not have."""
    stand, names = slot.stand(rng), tuple(OUTSIDE)
    lap, index = slot.shuffled(len(names))
    size = OUTSIDE_SIZES[(lap + index) % len(OUTSIDE_SIZES)]
    case = _case(rng, slot, stand, (draw_outside(rng, names[index], size),), size)
    return replace(case, about=f"{OUTSIDE[names[index]].about}; {stand.about}")


def _wrong_size(rng: Rng, slot: CaseSlot) -> BenchmarkCase:
    """The simulator has the effect at another size."""
    names = tuple(JUDGED)
    name = names[slot.shuffled(len(names))[1]]
    stand = slot.stand(rng)
    while (drawn := _two_sizes(rng, stand.facts, name)) is None:
        stand = slot.stand(rng)
    effect, stated, size = drawn
    case = _case(rng, slot, stand, (effect,), size, stated)
    parameter = STRENGTHS[name].parameter
    return replace(case, about=f"the simulator states {stated.parameters[parameter]:g}; {stand.about}")


def _two_sizes(rng: Rng, facts: DeviceFacts, name: str) -> tuple[InjectedEffect, InjectedEffect, str] | None:
    """In the sessions and in the simulator, of one sign; None where they are too similar."""
    sizes = [str(size) for size in rng.choice(CLEAR, 2)]
    way, parameter = sign(rng), STRENGTHS[name].parameter
    effect, stated = (_draw(rng, facts, name, size, way) for size in sizes)
    ratio = abs(effect.parameters[parameter] / stated.parameters[parameter])
    if max(ratio, 1.0 / ratio) < LEAST_RATIO:
        return None
    return effect, InjectedEffect(name, effect.parameters | {parameter: stated.parameters[parameter]}), sizes[0]


def _draw(rng: Rng, facts: DeviceFacts, name: str, size: str, way: float | None = None) -> InjectedEffect:
    if name in THREE_AXIS_KINDS:
        return draw_three_axis_effect(rng, name, size)
    return draw_fault_for(rng, facts, name, size, way, draw_strength(rng, name, size))


def _case(
    rng: Rng,
    slot: CaseSlot,
    stand: Stand,
    effects: tuple[InjectedEffect, ...],
    size: str = "",
    stated: InjectedEffect | None = None,
) -> BenchmarkCase:
    """A case with effects that the simulator has: those of the device at the right size, and one at a wrong size."""
    turn = slot.number // MOVED_EVERY
    is_movable = not slot.has_three_axes and not any(effect.name in ON_A_TABLE for effect in effects)
    is_moved = slot.number % MOVED_EVERY == MOVED_EVERY - 1 and is_movable
    mover = MOVERS[turn % len(MOVERS)] if is_moved else None
    wrong = () if stated is None else (stated,)
    count = int(rng.choice([number for number in STATED if number >= len(wrong)])) - len(wrong)
    modeled = _modeled(rng, stand.facts, effects, count)
    listed = [*wrong, *modeled]
    stand.rig = replace(
        stand.rig, effects=(*stand.rig.effects, *(listed[index] for index in rng.permutation(len(listed))))
    )
    about = f"{mover or 'table'}, {stand.about}"
    return BenchmarkCase(slot.seed, slot.row, slot.number, stand, effects, size, about, mover, wrong, modeled)


def _modeled(rng: Rng, facts: DeviceFacts, effects: Sequence[InjectedEffect], count: int) -> tuple[InjectedEffect, ...]:
    """Effects of a device that its simulator has, of other groups than the effects of the case and each other."""
    taken = {GROUP.get(effect.name, effect.name) for effect in effects}
    modeled: list[InjectedEffect] = []
    for index in rng.permutation(len(JUDGED)):
        name = tuple(JUDGED)[index]
        if len(modeled) < count and GROUP[name] not in taken:
            taken.add(GROUP[name])
            modeled.append(_draw(rng, facts, name, str(rng.choice(CLEAR))))
    return tuple(modeled)


@dataclass(frozen=True, slots=True)
class BenchmarkRow:
    """A row: its usual number of cases, and the function that draws a case."""

    count: int
    draw: Callable[[Rng, CaseSlot], BenchmarkCase]


ROWS: Mapping[str, BenchmarkRow] = {
    "none": BenchmarkRow(60, _none),
    "single": BenchmarkRow(60, _single),
    "small": BenchmarkRow(50, _small),
    "pair": BenchmarkRow(40, _pair),
    "outside": BenchmarkRow(50, _outside),
    "wrong_size": BenchmarkRow(40, _wrong_size),
}
"""Rows by name; 300 cases."""


def draw_case(seed: int, row: str, number: int) -> BenchmarkCase:
    """A case by seed, row and number; the numbers drawn for a case change no other case."""
    return ROWS[row].draw(plan_dice((DRAWN_AS, seed, row, number, "plan")), CaseSlot(seed, row, number))
