"""Each fault at three strengths, all at work from `FROM_S` to `TO_S` at most, and pairs of them."""

from itertools import combinations
from random import Random

from firmware_sim.faults.catalogue import parse_fault
from firmware_sim.faults.fault import Fault

FROM_S, TO_S, RUN_S = 6.0, 12.0, 18.0
"""A run has seconds without trouble at both ends, of device time."""

LASTING = f"from_s={FROM_S:g},to_s={TO_S:g}"

STRENGTHS: dict[str, tuple[str, ...]] = {
    "bit_flips": tuple(f"{LASTING},per_kilobyte={each}" for each in (0.3, 3, 30)),
    "dropped_bytes": tuple(f"{LASTING},per_kilobyte={each}" for each in (0.3, 3, 30)),
    "duplicated_bytes": tuple(f"{LASTING},per_kilobyte={each}" for each in (0.3, 3, 30)),
    "truncated_frames": tuple(f"{LASTING},share_percent={each}" for each in (1, 10, 60)),
    "merged_frames": tuple(f"{LASTING},share_percent={each}" for each in (1, 10, 60)),
    "zeros": tuple(f"{LASTING},length_bytes={n},every_s={s}" for n, s in ((1, 2), (64, 1), (2000, 0.1))),
    "boot_banner": tuple(f"from_s={each}" for each in (6, 9, 12)),
    "stall": tuple(f"{LASTING},seconds={n},every_s={s}" for n, s in ((0.2, 3), (1, 2), (5, 6))),
    "reset": tuple(f"from_s={FROM_S:g},silent_s={each}" for each in (0, 0.5, 5)),
    "clock_step": tuple(f"from_s={FROM_S:g},step_s={each}" for each in (0.5, -30, 3000)),
    "millisecond_clock": tuple(f"from_s={each}" for each in (0, 6, 12)),
    "rate_change": tuple(f"from_s={FROM_S:g},divide={each}" for each in (2, 5, 50)),
    "double_rate": tuple(f"from_s={FROM_S:g},to_s={each}" for each in (6.5, 8, 12)),
    "stuck_value": tuple(f"from_s={FROM_S:g},to_s={each}" for each in (6.1, 7, 12)),
    "full_scale": tuple(f"from_s={FROM_S:g},to_s={each}" for each in (6.1, 7, 12)),
    "wrong_baud": tuple(f"from_s={FROM_S:g},to_s={each},baud=9600" for each in (6.2, 7, 12)),
    "unplug": tuple(f"from_s={FROM_S:g},seconds={each}" for each in (0.1, 1, 5)),
}
"""From light to hard."""

LIES = frozenset({"stuck_value", "full_scale"})
"""Faults whose rates are well-formed and wrong: nobody behind the link can know."""


def single(name: str, strength: int) -> Fault:
    """A fault at strength 1, 2 or 3."""
    return parse_fault(f"{name}:{STRENGTHS[name][strength - 1]}")


Pair = tuple[tuple[str, int], tuple[str, int]]
"""Two different faults, each with its strength."""


def all_pairs() -> list[Pair]:
    """Every two faults at every strength of both."""
    return [
        ((first, a), (second, b)) for first, second in combinations(STRENGTHS, 2) for a in (1, 2, 3) for b in (1, 2, 3)
    ]


def pairs(count: int, seed: int) -> list[Pair]:
    """So many of them at random."""
    return Random(seed).sample(all_pairs(), count)
