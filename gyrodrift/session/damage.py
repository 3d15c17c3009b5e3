"""Damage of a recording: lost samples and seconds, and the error that reports them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import nan
from pathlib import Path

import numpy as np

from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

NAMED = 5
"""Losses that a message names."""


@dataclass(frozen=True, slots=True)
class LostSamples:
    """Consecutive samples that cannot be recovered.

    first
        Index of the first one in the undamaged recording, from 0.
    count
        Number of samples; None if unknown.
    t_s, seconds
        Start in s after the first whole sample, and length by the device clock; NaN if unknown.
    """

    first: int
    count: int | None
    t_s: float = nan
    seconds: float = nan

    def __str__(self) -> str:
        last = "" if self.count is None or self.count == 1 else f" to {self.first + self.count - 1}"
        text = f"sample {self.first}" if not last else f"samples {self.first}{last}"
        text = f"samples from {self.first} on" if self.count is None else text
        position = "" if np.isnan(self.t_s) else f", at {self.t_s:.2f} s"
        return text + (position if np.isnan(self.seconds) else f" ({self.seconds:.3g} s{position})")


@dataclass(frozen=True, slots=True)
class RecordingDamage:
    """Damage of a recording.

    lost
        Lost samples in order.
    kept
        Number of whole samples.
    remarks
        Other damage, a phrase each.
    is_sure
        Whether checksums prove every kept sample; older files have only one checksum for the whole file.
    """

    lost: tuple[LostSamples, ...]
    kept: int
    remarks: tuple[str, ...] = ()
    is_sure: bool = True

    def __str__(self) -> str:
        phrases = [*self.remarks]
        if self.lost:
            rest = f" and {len(self.lost) - NAMED} more places" if len(self.lost) > NAMED else ""
            total = f", {self.lost_seconds:.3g} s in all" if len(self.lost) > 1 else ""
            verb = "is" if [loss.count for loss in self.lost] == [1] else "are"
            phrases.insert(0, f"lost {verb} {', '.join(map(str, self.lost[:NAMED]))}{rest}{total}")
        elif self.is_sure:
            phrases.append("no sample is lost")
        else:
            phrases.append("no checksum says which samples are damaged")
        return f"{'; '.join(phrases)}; {self.kept} samples are {'whole' if self.is_sure else 'there'}"

    @property
    def lost_count(self) -> int:
        """Number of samples that are known to be lost."""
        return sum(loss.count or 0 for loss in self.lost)

    @property
    def lost_seconds(self) -> float:
        """Known duration of the losses, s."""
        return float(np.nansum([loss.seconds for loss in self.lost]))


class DamagedError(DataError):
    """Bytes of recordings were changed or are missing; `damages` has the details by path."""

    def __init__(self, damages: Sequence[tuple[Path, RecordingDamage]]) -> None:
        advice = "--allow-damage (allow_damage=True) uses the whole samples, gyrodrift repair writes a file of them"
        super().__init__("\n".join(f"{path}: is damaged: {damage}; {advice}" for path, damage in damages))
        self.damages = tuple(damages)


def timed(lost: Sequence[LostSamples], t_device_s: Floats) -> tuple[LostSamples, ...]:
    """Losses with their times, from the device times of the whole samples, shape (n,)."""
    steps = np.diff(t_device_s)
    steps = steps[np.isfinite(steps)]
    step_s = float(np.median(steps)) if len(steps) else nan
    timed_losses, before = [], 0
    for loss in lost:
        index = min(max(loss.first - before, 0), len(t_device_s))
        timed_losses.append(_timed(loss, t_device_s, index, step_s))
        before += loss.count or 0
    return tuple(timed_losses)


def _timed(lost: LostSamples, t_device_s: Floats, index: int, step_s: float) -> LostSamples:
    """Add times to a loss; `index` is the index of the next whole sample."""
    with np.errstate(all="ignore"):
        start_s = float(t_device_s[index - 1] - t_device_s[0] + step_s) if index else 0.0
        seconds = nan if lost.count is None else lost.count * step_s
        if 0 < index < len(t_device_s):
            seconds = float(t_device_s[index] - t_device_s[index - 1] - step_s)
    return replace(lost, t_s=start_s, seconds=max(seconds, 0.0) if np.isfinite(seconds) else nan)
