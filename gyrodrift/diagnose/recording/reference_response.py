"""Response from a reference to the gyro, learned from a baseline: wheels that slip, a shaft that twists, a delay.

    angle of the gyro(t) = sum_k w_k · reference(t + k·period)                                   (1)

The weights are fitted to the increments of both angles by least squares, and drawn towards w_0 = 1 alone (ridge
regression, A. E. Hoerl and R. W. Kennard, 1970). What is linear, and the same in the baseline and in the recordings, is
no gap between them. Left in, it would depend on the motion and look like a scatter of the device.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.levels import has_steps
from gyrodrift.diagnose.recording.outliers import cleaned
from gyrodrift.diagnose.recording.recording import Recording

REACH_S = 0.1
"""Longest delay, either way, of a weight. Chosen: a wheeled robot in MuJoCo and two turntables need 0.06 s."""

MOST_REACH, PIECE = 100, 10_000
"""Most samples in that time, and samples whose products are summed at once, for memory."""

PRIOR = 1.0
"""Standard deviation of a weight about the reference as it is: a delay moves all of it to another weight."""

BETTER = 0.5
"""Share of the variance that is left, in recordings that the weights were not fitted to, below which they are used."""


@dataclass(frozen=True, slots=True)
class ReferenceResponse:
    """Weights of equation (1), an odd number of them, the middle one of the same moment, `period_s` apart."""

    weights: tuple[float, ...]
    period_s: float

    @property
    def gain(self) -> float:
        """Turn of the gyro over that of the reference."""
        return float(sum(self.weights))

    @property
    def late_s(self) -> float:
        """How much later the gyro turns than the reference."""
        reach = len(self.weights) // 2
        return float(-self.period_s * np.dot(np.arange(-reach, reach + 1), self.weights) / self.gain)

    def applied(self, recording: Recording) -> Recording:
        """The recording with a reference that turns as the gyro does; jumps of the angle are no motion, and stay."""
        angle_deg = cleaned(recording).encoder_deg
        jumped_deg = recording.encoder_deg - angle_deg
        padded_deg = np.pad(angle_deg - angle_deg[0], len(self.weights) // 2, mode="edge")
        turned_deg = np.correlate(padded_deg, np.array(self.weights), "valid")
        return replace(recording, encoder_deg=angle_deg[0] + turned_deg + jumped_deg)


class _Moments(NamedTuple):
    """Sums of products over a recording: weights with weights, weights with the gyro, and the gyro with itself."""

    weights: Floats
    with_gyro: Floats
    gyro: float
    samples: int

    def left(self, weights: Floats) -> float:
        """Sum of squares that weights leave."""
        return float(self.gyro - 2.0 * weights @ self.with_gyro + weights @ self.weights @ weights)


def reference_response_of(recordings: Sequence[Recording]) -> ReferenceResponse | None:
    """The response that recordings of one bench share; None if their references need none.

    Steps of an encoder are finer in time than a gyro tells, so that references with steps are left as they are. Of a
    single recording nothing can be held out.
    """
    if len(recordings) < 2 or any(
        has_steps(recording.encoder_deg) or not recording.has_motion for recording in recordings
    ):
        return None
    period_s = float(np.median([recording.period_s for recording in recordings]))
    reach = min(max(1, round(REACH_S / period_s)), MOST_REACH)
    moments = [_moments_of(recording, reach) for recording in recordings]
    as_it_is = np.zeros(2 * reach + 1)
    as_it_is[reach] = 1.0
    held_out = [
        one.left(_fitted(moments[:number] + moments[number + 1 :], as_it_is)) for number, one in enumerate(moments)
    ]
    if sum(held_out) > BETTER * sum(one.left(as_it_is) for one in moments):
        return None
    return ReferenceResponse(tuple(_fitted(moments, as_it_is).tolist()), period_s)


def _moments_of(recording: Recording, reach: int) -> _Moments:
    """Moments of increments, less their means: a bias is no response."""
    seen = cleaned(recording)
    gyro_dps = 0.5 * (seen.rate_dps[1:] + seen.rate_dps[:-1])
    turned_dps = np.diff(seen.encoder_deg) / recording.period_s
    gyro_dps, turned_dps = gyro_dps - gyro_dps.mean(), turned_dps - turned_dps.mean()
    windows = sliding_window_view(np.pad(turned_dps, reach), 2 * reach + 1)
    pieces = [slice(first, first + PIECE) for first in range(0, len(gyro_dps), PIECE)]
    return _Moments(
        np.sum([windows[piece].T @ windows[piece] for piece in pieces], axis=0),
        np.sum([windows[piece].T @ gyro_dps[piece] for piece in pieces], axis=0),
        float(gyro_dps @ gyro_dps),
        len(gyro_dps),
    )


def _fitted(moments: Sequence[_Moments], as_it_is: Floats) -> Floats:
    """Weights by ridge regression; the noise is held to be what the reference as it is leaves."""
    products = np.sum([one.weights for one in moments], axis=0)
    with_gyro = np.sum([one.with_gyro for one in moments], axis=0)
    variance = sum(one.left(as_it_is) for one in moments) / sum(one.samples for one in moments)
    ridge = variance / PRIOR**2 * np.eye(len(as_it_is))
    weights: Floats = as_it_is + np.linalg.solve(products + ridge, with_gyro - products @ as_it_is)
    return weights
