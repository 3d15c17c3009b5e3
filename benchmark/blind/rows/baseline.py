"""Two sets of recordings of one real device; into the second an effect is put, or nothing."""

import numpy as np
from gyrogap.catalogue import STAGE
from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.dice import Rng, effect_dice
from gyrogap.physics.kinds import InjectedEffect

from blind.rows.case import Draft
from blind.rows.recordings import LEAST_SET_S, OWNED, Recorded, Rows, devices, recordings_of, rig_of
from blind.rows.tampering import ANYWHERE, COUNTED, MOVING, draw_tampering, tamper

TRIES = 50
STRIDE = 5
"""Through the effects; it has no divisor in common with the number of them."""


def with_effect(rng: Rng, number: int, path: DicePath) -> Draft:
    """Devices in turn, and each of them all effects that its recordings could show, one after the other."""
    known = devices()
    turn, place = divmod(number, len(known))
    device = known[place]
    names = _could_show(device)
    last, today = _two_sets(rng, device)
    rate_hz = float(np.median([rows.rate_hz for rows in today]))
    top_dps = float(np.median([np.abs(rows.columns["rate_dps"]).max() for rows in today]))
    fault = draw_tampering(rng, names[(STRIDE * turn + 2 * place) % len(names)], rate_hz, top_dps)
    dice = effect_dice((*path, fault.name))
    return _draft(device, last, tuple(tamper(rows, fault, dice) for rows in today), (fault,))


def _could_show(device: str) -> list[str]:
    """Effects; without a counter nobody can tell a row that is missing from one that is late."""
    has_counter = all("seq" in rows.columns for rows in recordings_of(device))
    names = [*ANYWHERE, *(MOVING if OWNED[device].least_turned_deg > 0.0 else ())]
    return [name for name in names if has_counter or name not in COUNTED]


def without_effect(rng: Rng, number: int, path: DicePath) -> Draft:
    """Last month and today, and nothing happened."""
    known = devices()
    device = known[number % len(known)]
    return _draft(device, *_two_sets(rng, device), ())


def _draft(device: str, last: tuple[Rows, ...], today: tuple[Rows, ...], faults: tuple[InjectedEffect, ...]) -> Draft:
    return Draft(
        kind="baseline" if faults else "none",
        rig=rig_of(device),
        parts={"sessions": Recorded(today), "baseline": Recorded(last)},
        faults=faults,
        stages=tuple(STAGE[fault.name] for fault in faults),
        about=f"{device}, {len(today)} recordings against {len(last)}",
        facts={"device": device},
    )


def _two_sets(rng: Rng, device: str) -> tuple[tuple[Rows, ...], tuple[Rows, ...]]:
    """Drawn without putting any back; each has a minute in all."""
    recordings, each = recordings_of(device), OWNED[device].each
    for _ in range(TRIES):
        shuffled = [recordings[at] for at in rng.permutation(len(recordings))]
        last, rest = _take(shuffled, each)
        today, _ = _take(rest, each)
        if last and today:
            return last, today
    raise ValueError(f"{device}: there is no way to make two sets of a minute of its recordings")


def _take(recordings: list[Rows], least: int) -> tuple[tuple[Rows, ...], list[Rows]]:
    """The first few that are a minute in all, none where they are never; and what is left."""
    for count in range(least, len(recordings) + 1):
        if sum(rows.seconds for rows in recordings[:count]) > LEAST_SET_S:
            return tuple(recordings[:count]), recordings[count:]
    return (), []
