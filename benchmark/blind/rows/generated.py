"""Cases from the generator, over devices as people own them: three sessions of one and a half to three minutes."""

from dataclasses import replace

from gyrogap.catalogue import EFFECTS, GROUP, STAGE
from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.dice import Rng
from gyrogap.physics.driven import MOVERS
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.outside_sizes import OUTSIDE, OUTSIDE_SIZES, draw_outside
from gyrogap.physics.pairs import PAIRS
from gyrogap.physics.spread import draw_fault_for
from gyrogap.physics.stand import MINUTES, SESSIONS, Stand, draw_plans
from gyrogap.physics.write import SessionBatch

from blind.cost import yaw_cost_deg
from blind.rows.case import Draft

SHORT_MINUTES = (25.0 / 60.0, 50.0 / 60.0)
SHORT = 0.2
"""So many of the cases without a gap have short sessions."""

CLEAR = ("typical", "large")

TOGETHER = 3


def no_gap(rng: Rng, number: int, path: DicePath) -> Draft:
    """The device that the rig states; some with short sessions."""
    stand = Stand(rng, SHORT_MINUTES if rng.random() < SHORT else MINUTES)
    return _draft("none", stand, (), path, about=stand.about)


def driven(rng: Rng, number: int, path: DicePath) -> Draft:
    """The device that the rig states, on a robot that trembles, in a hand and on a drone in turn."""
    stand, mover = Stand(rng), MOVERS[number % len(MOVERS)]
    sessions = replace(stand.batch((), path), mover=mover)
    draft = _draft("none", stand, (), path)
    return replace(draft, about=f"{mover}, {stand.about}", parts={"sessions": sessions})


def clear(rng: Rng, number: int, path: DicePath) -> Draft:
    """One effect after the other, typical and then large."""
    return _single(rng, EFFECTS[number % len(EFFECTS)], CLEAR[number // len(EFFECTS) % len(CLEAR)], path)


def small(rng: Rng, number: int, path: DicePath) -> Draft:
    """One effect after the other."""
    return _single(rng, EFFECTS[number % len(EFFECTS)], "small", path)


def _single(rng: Rng, effect: str, size: str, path: DicePath) -> Draft:
    """And the same device without it, which says whether it could have been seen."""
    stand = Stand(rng)
    faults = (draw_fault_for(rng, stand.facts, effect, size),)
    without = {"without": stand.batch((), (*path, "without"))}
    return _draft("single", stand, faults, path, size=size, then="without", more=without)


def outside(rng: Rng, number: int, path: DicePath) -> Draft:
    """What no catalogue has."""
    stand, names = Stand(rng), list(OUTSIDE)
    name, size = names[number % len(names)], OUTSIDE_SIZES[number // len(names) % len(OUTSIDE_SIZES)]
    what = OUTSIDE[name]
    faults = (draw_outside(rng, name, size),)
    draft = _draft("outside", stand, faults, path, size=size, stages=what.stages, about=what.about)
    return replace(draft, yaw_cost_deg=lambda: yaw_cost_deg(stand.batch(faults, path)))


def pair(rng: Rng, number: int, path: DicePath) -> Draft:
    """Two effects at a time; and the same device without them, which says whether each could have been seen."""
    stand, both = Stand(rng), PAIRS[number % len(PAIRS)]
    names = zip((both.first, both.second), both.sizes, both.ways, strict=True)
    faults = tuple(draw_fault_for(rng, stand.facts, *each) for each in names)
    without = {"without": stand.batch((), (*path, "without"))}
    return _draft("pair", stand, faults, path, then="without", more=without)


def triple(rng: Rng, number: int, path: DicePath) -> Draft:
    """Three effects of typical size, of which no two are easily taken for each other."""
    stand = Stand(rng)
    names: list[str] = []
    for name in rng.permutation(list(EFFECTS)).tolist():
        if len(names) < TOGETHER and GROUP[name] not in {GROUP[other] for other in names}:
            names.append(name)
    faults = tuple(draw_fault_for(rng, stand.facts, name, "typical") for name in names)
    return _draft("triple", stand, faults, path)


def left_out(rng: Rng, number: int, path: DicePath) -> Draft:
    """The true effect is withheld in a second run."""
    stand, name = Stand(rng), EFFECTS[number % len(EFFECTS)]
    faults = (draw_fault_for(rng, stand.facts, name, "typical"),)
    return _draft("left_out", stand, faults, path, size="typical", withhold=name)


def loop(rng: Rng, number: int, path: DicePath) -> Draft:
    """New sessions of the same device with the same fault, for the rig that the diagnosis writes."""
    stand, size = Stand(rng), str(rng.choice(CLEAR))
    faults = (draw_fault_for(rng, stand.facts, str(rng.choice(EFFECTS)), size),)
    new = SessionBatch(stand.device, draw_plans(rng, MINUTES, SESSIONS), faults, (*path, "again"))
    return _draft("loop", stand, faults, path, size=size, then="again", more={"again": new})


def _draft(
    kind: str,
    stand: Stand,
    faults: tuple[InjectedEffect, ...],
    path: DicePath,
    *,
    size: str = "",
    stages: tuple[str, ...] | None = None,
    about: str = "",
    withhold: str = "",
    then: str = "",
    more: dict[str, SessionBatch] | None = None,
) -> Draft:
    return Draft(
        kind=kind,
        rig=stand.rig_text,
        parts={"sessions": stand.batch(faults, path), **(more or {})},
        faults=faults,
        size=size,
        stages=tuple(STAGE[fault.name] for fault in faults) if stages is None else stages,
        about=f"{about}; {stand.about}" if about and faults else stand.about,
        withhold=withhold,
        then=then,
        facts=stand.label,
    )
