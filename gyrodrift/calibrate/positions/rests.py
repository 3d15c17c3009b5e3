"""Rests of a board that is laid down, in a stream of samples: no key is pressed.

A block is quiet if rates and accelerations scatter little, and a row of quiet blocks with equal means is a rest. The
bias of the gyro may be unknown: a rest is told from an even turn by the bias of the first rest.
"""

from collections.abc import Iterator
from dataclasses import dataclass, field
from math import inf
from typing import NamedTuple

import numpy as np

from gyrodrift.calibrate.positions.block import AxesBlock, AxesRest, block_of, rest_of_blocks
from gyrodrift.calibrate.rest import BIAS_MAX_DPS, BLOCK_SAMPLES_MIN
from gyrodrift.facts.arrays import smallest_step, white_noise
from gyrodrift.facts.still import StillRule, has_hole
from gyrodrift.values.arrays import Floats
from gyrodrift.values.sample import Sample

BLOCK_S = 0.25

SHAKING_BLOCKS = 1
"""Blocks after the hand has left that do not count: the table still shakes."""

STILL_GYRO = StillRule(level=0.5, level_errors=6.0, scatter=0.3, scatter_sigmas=3.0)
STILL_ACCEL = StillRule(level=0.1, level_errors=6.0, scatter=0.25, scatter_sigmas=3.0)
"""A hand that holds the board shakes by 1 deg/s and 0.3 m/s² (physiological tremor, 8 to 12 Hz); the floor of the
acceleration is above steps of 10 bits."""

BIAS_CHANGE_DPS = 2.0
"""Largest change of the bias from the first rest: 0.1 deg/s/g by gravity (MPU-6050, 6.1), and warming."""

KEPT_S = 5.0
"""Longest part of a rest that is kept, next to the following move, s."""

LONGEST_MOVE_S = 120.0
"""Longer moves are forgotten: their angle would be that of the bias."""


class Laid(NamedTuple):
    """A rest, and the move that led to it.

    rest, before
        The rest, and the rest before it; None for the first.
    move
        Blocks from the rest before to this one, including both; empty if they were forgotten.
    is_whole
        No sample of the move was lost or out of the range of the device.
    """

    rest: AxesRest
    before: AxesRest | None
    move: tuple[AxesBlock, ...]
    is_whole: bool


@dataclass(slots=True)
class RestFinder:
    """Finds rests of at least `rest_s`, each once."""

    rest_s: float
    _samples: list[Sample] = field(default_factory=list)
    _still: list[AxesBlock] = field(default_factory=list)
    _previous: list[AxesBlock] = field(default_factory=list)
    _between: list[AxesBlock] = field(default_factory=list)
    _is_told: bool = False
    _clipped: int = 0
    _clipped_now: int = 0
    _first_bias_dps: Floats | None = None
    _gyro_noise_dps: float = inf
    _accel_noise_mps2: float = inf
    _accel_step_mps2: float = inf

    def take(self, samples: list[Sample], clipped: int = 0) -> Iterator[Laid]:
        """Add samples, `clipped` of them out of the range of the device; rests that are complete.

        Raises
        ------
        CalibrationError
            The device does not send three rates and accelerations, or its time stands still.
        """
        self._clipped, self._clipped_now = self._clipped + clipped, clipped
        for sample in samples:
            self._samples.append(sample)
            is_long = sample.t_device_s - self._samples[0].t_device_s >= BLOCK_S
            if is_long and len(self._samples) >= BLOCK_SAMPLES_MIN:
                block, self._samples = block_of(self._samples), []
                laid = self._take(block)
                if laid is not None:
                    yield laid

    @property
    def still_s(self) -> float:
        """Length of the present rest so far, s."""
        return float(self._still[-1].t_s[-1] - self._still[0].t_s[0]) if self._still else 0.0

    def _take(self, block: AxesBlock) -> Laid | None:
        if self._judge_quiet(block):
            if not self._is_level(block):
                self._end_rest()
            self._still.append(block)
        else:
            self._end_rest()
            self._between.append(block)
        self._forget()
        rest_blocks = self._still[SHAKING_BLOCKS:]
        if self._is_told or len(rest_blocks) < 2 or rest_blocks[-1].t_s[-1] - rest_blocks[0].t_s[0] < self.rest_s:
            return None
        return self._laid(rest_blocks)

    def _laid(self, rest_blocks: list[AxesBlock]) -> Laid:
        rest = rest_of_blocks(rest_blocks, self._accel_step_mps2)
        before, move = None, (*self._previous, *self._between, *self._still)
        if len(self._previous) >= 2:
            before = rest_of_blocks(self._previous, self._accel_step_mps2)
        if self._first_bias_dps is None:
            self._first_bias_dps = rest.gyro_dps
        is_whole = not self._clipped and not _has_hole(move)
        # Samples that were read together may be those of the next move.
        self._is_told, self._clipped, self._previous, self._between = True, self._clipped_now, [], []
        return Laid(rest, before, move if before is not None else (), is_whole)

    def _end_rest(self) -> None:
        """Begin a move: the last block of a rest may contain its start."""
        if self._is_told:
            self._previous, self._between = self._still[SHAKING_BLOCKS:-1], self._still[-1:]
        else:
            self._between += self._still
        self._still, self._is_told = [], False

    def _forget(self) -> None:
        """Keep memory bounded: a long rest keeps its end, a long move nothing."""
        if self._is_told:
            while self._still[-1].t_s[-1] - self._still[1].t_s[0] > max(KEPT_S, self.rest_s):
                del self._still[0]
        elif self._between and self._between[-1].t_s[-1] - self._between[0].t_s[0] > LONGEST_MOVE_S:
            self._previous, self._between = [], []

    def _judge_quiet(self, block: AxesBlock) -> bool:
        steps_mps2 = (smallest_step(axis) or inf for axis in block.accel_mps2.T)
        self._gyro_noise_dps = min(self._gyro_noise_dps, white_noise(block.gyro_dps))
        self._accel_noise_mps2 = min(self._accel_noise_mps2, white_noise(block.accel_mps2))
        self._accel_step_mps2 = min(self._accel_step_mps2, *steps_mps2)
        bias_dps = block.gyro_dps.mean(axis=0)
        if self._first_bias_dps is None:
            is_bias = bool((np.abs(bias_dps) < BIAS_MAX_DPS).all())
        else:
            is_bias = bool((np.abs(bias_dps - self._first_bias_dps) < BIAS_CHANGE_DPS).all())
        return (
            is_bias
            and STILL_GYRO.is_calm(float(block.gyro_dps.std(axis=0).max()), self._gyro_noise_dps)
            and STILL_ACCEL.is_calm(float(block.accel_mps2.std(axis=0).max()), self._accel_noise_mps2)
        )

    def _is_level(self, block: AxesBlock) -> bool:
        """Whether the means of a block are those of the present rest."""
        if not self._still:
            return True
        gyros_dps, accels_mps2 = (
            np.mean([values.mean(axis=0) for values in column], axis=0)
            for column in ([still.gyro_dps for still in self._still], [still.accel_mps2 for still in self._still])
        )
        turn_dps = float(np.abs(block.gyro_dps.mean(axis=0) - gyros_dps).max())
        push_mps2 = float(np.abs(block.accel_mps2.mean(axis=0) - accels_mps2).max())
        return STILL_GYRO.is_level(turn_dps, self._gyro_noise_dps, len(block.t_s)) and STILL_ACCEL.is_level(
            push_mps2, self._accel_noise_mps2, len(block.t_s)
        )


def _has_hole(blocks: tuple[AxesBlock, ...]) -> bool:
    t_s = np.concatenate([block.t_s for block in blocks])
    return has_hole(t_s, float(np.median(np.diff(t_s))))
