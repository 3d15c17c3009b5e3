"""The rig has the effect that is in the sessions, at another size: by the simulator and by the generator in turn."""

from dataclasses import replace

from gyrogap.catalogue import EFFECTS, JUDGED
from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.dice import Rng, sign
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.rig_text import rig_form
from gyrogap.physics.sizes import STRENGTHS
from gyrogap.physics.spread import DeviceFacts, draw_facts, draw_fault_for
from gyrogap.physics.stand import MINUTES, Stand, describe

from blind.rows.case import Draft
from blind.rows.generated import CLEAR
from blind.rows.simulated import LIVELY, Simulated, draw_seed, own_rig

LEAST_RATIO = 1.5
"""Between the two sizes; a device too coarse for that is drawn again."""

ROUNDS = 2
OF_ONE_FORM = tuple(JUDGED)
"""What the generator takes: where a size of its form is one of the simulator's too."""


def wrong_size(rng: Rng, number: int, path: DicePath) -> Draft:
    """Typical in the sessions and large in the rig, or the other way round."""
    turn, is_own = divmod(number, ROUNDS)
    if is_own:
        return _simulated(rng, EFFECTS[turn % len(EFFECTS)])
    return _generated(rng, OF_ONE_FORM[turn % len(OF_ONE_FORM)], path)


def _simulated(rng: Rng, effect: str) -> Draft:
    """Everything but the size is as the rig says."""
    facts = draw_facts(rng)
    while (drawn := _two_sizes(rng, facts, effect)) is None:
        facts = draw_facts(rng)
    there, stated, size = drawn
    there = InjectedEffect(effect, rig_form(there))
    profile, minutes = str(rng.choice(["identify", *LIVELY[:1]])), round(rng.uniform(*MINUTES), 3)
    base = rng.bit_generator.state
    rig = own_rig(rng, facts, (stated,))
    rng.bit_generator.state = base  # the same bias, phase and delay in both
    truth = own_rig(rng, facts, (there,))
    return Draft(
        kind="wrong_size",
        rig=rig,
        parts={"sessions": Simulated(truth, profile, 3, minutes, draw_seed(rng))},
        faults=(there,),
        size=size,
        about=f"own simulator; the rig says {_strength(stated):g}; {profile}, {describe(facts)}",
    )


def _generated(rng: Rng, effect: str, path: DicePath) -> Draft:
    stand = Stand(rng)
    while (drawn := _two_sizes(rng, stand.facts, effect)) is None:
        stand = Stand(rng)
    there, stated, size = drawn
    stand.rig = replace(stand.rig, effects=(*stand.rig.effects, stated))
    return Draft(
        kind="wrong_size",
        rig=stand.rig_text,
        parts={"sessions": stand.batch((there,), path)},
        faults=(there,),
        size=size,
        about=f"generator; the rig says {_strength(stated):g}; {stand.about}",
        facts=stand.label,
    )


def _two_sizes(rng: Rng, facts: DeviceFacts, effect: str) -> tuple[InjectedEffect, InjectedEffect, str] | None:
    """In the sessions and in the rig, of one sign and alike in the rest; None where the device makes them too alike."""
    sizes = [str(size) for size in rng.permutation(CLEAR)]
    way, parameter = sign(rng), STRENGTHS[effect].parameter
    there, other = (draw_fault_for(rng, facts, effect, size, way) for size in sizes)
    stated = InjectedEffect(effect, there.parameters | {parameter: other.parameters[parameter]})
    ratio = abs(_strength(there) / _strength(stated))
    return (there, stated, sizes[0]) if max(ratio, 1.0 / ratio) >= LEAST_RATIO else None


def _strength(fault: InjectedEffect) -> float:
    return fault.parameters[STRENGTHS[fault.name].parameter]
