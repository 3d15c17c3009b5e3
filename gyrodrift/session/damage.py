"""What is damaged in a recording: which samples are lost, how many seconds, and the error that says so."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.errors import DataError

NAMED = 5
"""Stretches of lost samples that a message names."""


@dataclass(frozen=True, slots=True)
class LostSamples:
    """Consecutive samples that cannot be recovered.

    first
        Number of the first one in the recording as it was written, from 0.
    count
        How many; None where nothing says it.
    t_s, seconds
        Where they begin, s after the first sample that is whole, and how long they are by the device's clock; NaN where
        nothing says it.
    """

    first: int
    count: int | None
    t_s: float = nan
    seconds: float = nan

    def __str__(self) -> str:
        last = "" if self.count is None or self.count == 1 else f" to {self.first + self.count - 1}"
        what = f"sample {self.first}" if not last else f"samples {self.first}{last}"
        what = f"samples from {self.first} on" if self.count is None else what
        where = "" if np.isnan(self.t_s) else f", at {self.t_s:.2f} s"
        return what + (where if np.isnan(self.seconds) else f" ({self.seconds:.3g} s{where})")


@dataclass(frozen=True, slots=True)
class RecordingDamage:
    """What is damaged in a recording.

    lost
        Samples that are gone, in their order.
    kept
        Samples that are whole.
    remarks
        What else is damaged, a phrase each.
    is_sure
        Whether each sample that is kept is known to be as it was written; older files have one checksum alone.
    """

    lost: tuple[LostSamples, ...]
    kept: int
    remarks: tuple[str, ...] = ()
    is_sure: bool = True

    def __str__(self) -> str:
        said = [*self.remarks]
        if self.lost:
            more = f" and {len(self.lost) - NAMED} stretches more" if len(self.lost) > NAMED else ""
            total = f", {self.lost_seconds:.3g} s in all" if len(self.lost) > 1 else ""
            said.insert(0, f"lost are {', '.join(map(str, self.lost[:NAMED]))}{more}{total}")
        elif self.is_sure:
            said.append("no sample is lost")
        else:
            said.append("which samples are damaged cannot be said: the file has one checksum for all of it")
        return f"{'; '.join(said)}; {self.kept} samples are {'whole' if self.is_sure else 'there'}"

    @property
    def lost_count(self) -> int:
        """Samples that are known to be lost."""
        return sum(each.count or 0 for each in self.lost)

    @property
    def lost_seconds(self) -> float:
        """Their time, as far as it is known."""
        return float(np.nansum([each.seconds for each in self.lost]))


class DamagedError(DataError):
    """A recording of which bytes were changed or are missing since it was written; `damages` has the facts by path."""

    def __init__(self, damages: Sequence[tuple[Path, RecordingDamage]]) -> None:
        how = "--allow-damage (allow_damage=True) goes on with what is whole, gyrodrift repair writes a file of it"
        super().__init__("\n".join(f"{path}: is damaged: {damage}; {how}" for path, damage in damages))
        self.damages = tuple(damages)


def timed(lost: Sequence[LostSamples], t_device_s: Floats) -> tuple[LostSamples, ...]:
    """Losses with their times, by the device times of the samples that are left, shape (n,)."""
    steps = np.diff(t_device_s)
    steps = steps[np.isfinite(steps)]
    step_s = float(np.median(steps)) if len(steps) else nan
    found, before = [], 0
    for each in lost:
        index = min(max(each.first - before, 0), len(t_device_s))
        found.append(_timed(each, t_device_s, index, step_s))
        before += each.count or 0
    return tuple(found)


def _timed(lost: LostSamples, t_device_s: Floats, index: int, step_s: float) -> LostSamples:
    """`index` is that of the first sample behind the loss, among those that are left."""
    with np.errstate(all="ignore"):
        start_s = float(t_device_s[index - 1] - t_device_s[0] + step_s) if index else 0.0
        seconds = nan if lost.count is None else lost.count * step_s
        if 0 < index < len(t_device_s):
            seconds = float(t_device_s[index] - t_device_s[index - 1] - step_s)
    return replace(lost, t_s=start_s, seconds=max(seconds, 0.0) if np.isfinite(seconds) else nan)
