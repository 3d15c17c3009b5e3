"""Readings of a recording that are no measurement, by the judge of streams."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from gyrodrift.columns.readings import LEAST_JUMP_DPS, ReadingJudge, ReadingVerdict
from gyrodrift.values.arrays import Floats, Mask


@dataclass(frozen=True, slots=True)
class JudgedReadings:
    """Verdicts on the samples of a recording.

    is_missing
        Samples that are no measurement, shape (n,).
    impossible, clipped, hung_s
        As in `ReadingJudge`.
    events
        Names and fields of what a stream would have fields_of.
    """

    is_missing: Mask
    impossible: int = 0
    clipped: int = 0
    hung_s: float = 0.0
    events: tuple[tuple[str, dict[str, Any]], ...] = ()

    def fields_of(self, event: str) -> list[dict[str, Any]]:
        """Fields of the events of a name."""
        return [fields for name, fields in self.events if name == event]


def judged_readings(t_s: Floats, rates_dps: Floats, companions: Floats) -> JudgedReadings:
    """Judge the samples of a recording as a stream; rates of shape (n, 1) or (n, 3), companions (n, m)."""
    is_missing = np.zeros(len(t_s), dtype=bool)
    if not _may_be_odd(rates_dps):
        return JudgedReadings(is_missing)
    events: list[tuple[str, dict[str, Any]]] = []
    judge = ReadingJudge(lambda event, **fields: events.append((event, fields)))
    waiting: int | None = None
    columns = (map(tuple, table.tolist()) for table in (rates_dps, companions))
    for i, (t, rates, numbers) in enumerate(zip(t_s.tolist(), *columns, strict=True)):
        verdict = judge.take(t, rates, numbers)
        if waiting is not None:
            is_missing[waiting], waiting = not judge.was_real, None
        is_missing[i] = verdict is ReadingVerdict.MISSING
        waiting = i if verdict is ReadingVerdict.SUSPECT else None
    judge.end()
    return JudgedReadings(is_missing, judge.impossible, judge.clipped, judge.hung_s, tuple(events))


def _may_be_odd(rates_dps: Floats) -> bool:
    """Whether there is a jump, or two repetitions, that the judge could object to: most recordings have none."""
    if ((rates_dps == rates_dps[:, :1]).all(axis=1) & (rates_dps[:, 0] >= -1.0) & (rates_dps[:, 0] <= 0.0)).any():
        return True  # maybe a failed read
    steps = np.abs(np.diff(rates_dps, axis=0))
    is_same = steps[:, -1] == 0.0
    return bool((steps > LEAST_JUMP_DPS).any() or (is_same[1:] & is_same[:-1]).any())
