"""A move from one stop at the mark to the next: its end, and its angle by the gyro.

The bias is interpolated between the rests before and after the move.
"""

from dataclasses import dataclass, field

import numpy as np

from gyrodrift.calibrate.rest import BLOCK_SAMPLES_MIN, RestMeasurement
from gyrodrift.facts.still import StillRule, has_hole
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

BLOCK_S = 0.25
STOP_S = 1.5
"""Shortest rest that counts as a stop, s; hands that change their grip are faster."""

WINDOW_S = 5.0
"""Longest part of a rest, next to the move, that gives the bias, s."""

STILL = StillRule(level=0.15, level_errors=6.0, scatter=0.3, scatter_sigmas=3.0)
"""Floors, deg/s: the largest bias walk between two stops, and a hand that holds the table."""


@dataclass(slots=True)
class Move:
    """Move that begins at a stop; `bias_dps` is the rate at that stop, deg/s.

    angle_deg
        Integrated rate so far, without the bias, degrees.
    still_s
        Length of the present rest, s.
    seconds
        Length of the move so far, s.
    """

    rest: RestMeasurement
    bias_dps: float
    angle_deg: float = 0.0
    still_s: float = 0.0
    seconds: float = 0.0
    _samples: list[Sample] = field(default_factory=list)
    _block: int = 0
    _has_moved: bool = False
    _clipped: int = 0

    def take(self, samples: list[Sample], clipped: int = 0) -> None:
        """Add samples; `clipped` of them were marked as out of range by the device."""
        self._clipped += clipped
        self._samples += samples
        size = self._size
        while self._block + size <= len(self._samples):
            rates_dps = np.array([sample.rate_dps for sample in self._samples[self._block : self._block + size]])
            self._block += size
            block_s = size * self.rest.period_s
            self.seconds += block_s
            self.angle_deg += (float(rates_dps.mean()) - self.bias_dps) * block_s
            if self._is_still(rates_dps):
                self.still_s += block_s
                self._forget()
            else:
                self.still_s, self._has_moved = 0.0, True

    @property
    def is_stopped(self) -> bool:
        """Whether the present rest counts as a stop."""
        return self.still_s >= STOP_S

    def finished(self) -> "FinishedMove":
        """Move up to the present stop; samples after the last whole block belong to the next move.

        Raises
        ------
        CalibrationError
            Samples are missing, the rate left the range of the device, there was no rest before the move, or no move.
        """
        t_s = np.array([sample.t_device_s for sample in self._samples[: self._block]])
        rate_dps = self._rates_dps()
        before, after = self._before(rate_dps), self._after(rate_dps)
        if before == len(rate_dps):
            raise CalibrationError("the device was not turned since the last stop")
        self._check(t_s)
        first, last = before // 2, len(t_s) - 1 - after // 2
        start_dps, end_dps = float(rate_dps[:before].mean()), float(rate_dps[len(rate_dps) - after :].mean())
        bias_dps = np.interp(t_s, [t_s[first], t_s[last]], [start_dps, end_dps])
        moved_dps = (rate_dps - bias_dps)[first : last + 1]
        angle_deg = float(np.sum(0.5 * (moved_dps[1:] + moved_dps[:-1]) * np.diff(t_s[first : last + 1])))
        return FinishedMove(angle_deg, float(np.abs(moved_dps).max()), end_dps, self._samples[len(t_s) - after :])

    def last_rest(self) -> tuple[float, list[Sample]]:
        """Bias at the present stop, deg/s, and all samples since its beginning."""
        rate_dps = self._rates_dps()
        after = self._after(rate_dps)
        return float(rate_dps[len(rate_dps) - after :].mean()), self._samples[self._block - after :]

    def _rates_dps(self) -> Floats:
        """Rates of all whole blocks, deg/s."""
        return np.array([sample.rate_dps for sample in self._samples[: self._block]])

    @property
    def _size(self) -> int:
        return max(BLOCK_SAMPLES_MIN, round(BLOCK_S / self.rest.period_s))

    def _is_still(self, rate_dps: Floats) -> bool:
        noise_dps, change_dps = self.rest.noise_dps, abs(float(rate_dps.mean()) - self.bias_dps)
        return STILL.is_level(change_dps, noise_dps, len(rate_dps)) and STILL.is_calm(float(rate_dps.std()), noise_dps)

    def _forget(self) -> None:
        """Before the move begins, keep the last WINDOW_S of the rest only, and update the bias from them."""
        surplus = self._block - round(WINDOW_S / self.rest.period_s)
        if not self._has_moved and surplus > 0:
            del self._samples[:surplus]
            self._block -= surplus
            self.angle_deg, self._clipped = 0.0, 0
            self.bias_dps = sum(sample.rate_dps for sample in self._samples[: self._block]) / self._block

    def _before(self, rate_dps: Floats) -> int:
        """Number of still samples at the beginning."""
        size, still = self._size, 0
        while still + size <= len(rate_dps) and self._is_still(rate_dps[still : still + size]):
            still += size
        if not still:
            raise CalibrationError("the device was moving already when the turn began")
        return still

    def _after(self, rate_dps: Floats) -> int:
        """Number of still samples at the end, at most WINDOW_S."""
        size, still, limit = self._size, 0, round(WINDOW_S / self.rest.period_s)
        end = len(rate_dps)
        while still < limit and still + size <= end and self._is_still(rate_dps[end - still - size : end - still]):
            still += size
        return max(size, still)

    def _check(self, t_s: Floats) -> None:
        steps_s = np.diff(t_s)
        if has_hole(t_s, self.rest.period_s) or steps_s.min() <= 0.0:
            raise CalibrationError(f"samples were lost during the turn, {steps_s.max():.3g} s of them")
        if self._clipped:
            raise CalibrationError(f"{self._clipped} samples were out of the range of the device: turn more slowly")


@dataclass(frozen=True, slots=True)
class FinishedMove:
    """Angle by the gyro, degrees, largest rate and bias after the move, deg/s, and all samples since the stop."""

    angle_deg: float
    fastest_dps: float
    bias_dps: float
    rest: list[Sample]
