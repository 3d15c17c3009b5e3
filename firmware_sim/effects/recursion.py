"""First-order recursions and slow random tracks over blocks, without a Python step per sample."""

from collections.abc import Callable
from typing import Any, Generic, TypeVar

import numpy as np
from numpy.typing import NDArray

from firmware_sim.effects.effect import Floats, Rng

RUN = 64
"""Samples per matrix product; the carry between runs is a Python number."""

SLOW_STEP_S = 0.1
SLOW_CHUNK = 1024
"""Bias processes are drawn on a grid of SLOW_STEP_S, SLOW_CHUNK values at a time, and interpolated."""


Number = TypeVar("Number", np.float64, np.complex128)


class OnePole(Generic[Number]):
    """y[n] = pole·y[n−1] + x[n], over blocks; `last` is y before the first sample. Real or complex."""

    def __init__(self, pole: Number, last: Number) -> None:
        self.last: Number = last
        powers = np.power(pole, np.arange(RUN + 1, dtype=np.float64))
        steps = np.arange(RUN)
        distance = steps[:, None] - steps[None, :]
        self._within: NDArray[Number] = np.where(distance >= 0, powers[np.maximum(distance, 0)], 0.0)
        self._decay: NDArray[Number] = powers[1:]

    def __call__(self, x: NDArray[Number]) -> NDArray[Number]:
        """Next values, in the shape of x (n,)."""
        runs = -(-len(x) // RUN)
        padded = np.zeros(runs * RUN, x.dtype)
        padded[: len(x)] = x
        y = padded.reshape(runs, RUN) @ self._within.T
        carries = np.empty(runs, x.dtype)
        carry: Any = self.last.item()
        whole = self._decay[-1].item()
        for run, end in enumerate(y[:, -1].tolist()):
            carries[run] = carry
            carry = end + whole * carry
        y += carries[:, None] * self._decay
        out: NDArray[Number] = y.reshape(-1)[: len(x)]
        if len(out):
            self.last = out[-1]
        return out


class SlowTrack:
    """Random track on a coarse grid with linear interpolation; times must not go back."""

    def __init__(self, draw: Callable[[int], Floats]) -> None:
        self._draw = draw
        self._values = draw(SLOW_CHUNK)
        self._first = 0

    def values_at(self, t_s: Floats) -> Floats:
        """Track at times from 0 on, in their shape."""
        grid_positions = np.maximum(t_s, 0.0) / SLOW_STEP_S
        while self._first + len(self._values) < grid_positions[-1] + 2.0:
            self._values = np.concatenate([self._values, self._draw(SLOW_CHUNK)])
        done = int(grid_positions[0]) - self._first
        if done > SLOW_CHUNK:
            self._values = self._values[done:]
            self._first += done
        grid = self._first + np.arange(len(self._values))
        track: Floats = np.interp(grid_positions, grid, self._values)
        return track


class Poisson:
    """Random events with a mean interval of `mean_s`; times must not go back."""

    def __init__(self, rng: Rng, mean_s: float) -> None:
        self._rng = rng
        self._mean_s = mean_s
        self._times_s: Floats = np.zeros(0)
        self._reached_s = 0.0
        self._forgotten = 0

    def count_until(self, t_s: Floats) -> Floats:
        """Number of events up to every time, in its shape."""
        while self._reached_s <= t_s[-1]:
            gaps_s = self._rng.exponential(self._mean_s, 64)
            self._times_s = np.concatenate([self._times_s, self._reached_s + np.cumsum(gaps_s)])
            self._reached_s = float(self._times_s[-1])
        done = int(np.searchsorted(self._times_s, t_s[0], side="right"))
        self._forgotten += done
        self._times_s = self._times_s[done:]
        return self._forgotten + np.searchsorted(self._times_s, t_s, side="right").astype(np.float64)
