"""Linear response from a reference to the gyro, fitted to a baseline: wheels that slip, a shaft that twists, a delay.

    angle of the gyro(t) = sum_k w_k · reference(t + k·period)                                   (1)

The weights are fitted to the increments of both angles by least squares, with a prior at w_0 = 1 and 0 for the others
(ridge regression, A. E. Hoerl and R. W. Kennard, 1970). A linear response that the baseline and the recordings share is
no gap between them. Without the correction it would depend on the motion and look like scatter of the device.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from gyrodrift.diagnose.recording.levels import has_steps
from gyrodrift.diagnose.recording.outliers import clean
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.values.arrays import Floats

REACH_S = 0.1
"""Largest delay of a weight, either way. Chosen: a wheeled robot in MuJoCo and two turntables need 0.06 s."""

MOST_REACH, PIECE = 100, 10_000
"""Largest number of samples in REACH_S, and samples whose products are summed at once, which limits the memory. Chosen:
REACH_S at 1 kHz, and 16 MB."""

PRIOR = 1.0
"""Prior standard deviation of a weight. Chosen: a delay moves the whole weight to another sample."""

MOST_MISSING = 0.3
"""Largest share of missing angles. Chosen: links lose fewer, and a reference at half of the rate lacks half of them."""

BETTER = 0.5
"""Largest remaining share of the variance at which the weights are used, in recordings that they were not fitted to.
Chosen: the response must explain more than it leaves."""


@dataclass(frozen=True, slots=True)
class ReferenceResponse:
    """Weights of equation (1), `period_s` apart. Their number is odd; the middle weight has no delay."""

    weights: tuple[float, ...]
    period_s: float

    @property
    def gain(self) -> float:
        """Turn of the gyro divided by that of the reference."""
        return float(sum(self.weights))

    @property
    def delay_s(self) -> float:
        """Mean delay of the gyro against the reference."""
        reach = len(self.weights) // 2
        return float(-self.period_s * np.dot(np.arange(-reach, reach + 1), self.weights) / self.gain)

    def applied(self, recording: Recording) -> Recording:
        """Recording with the response applied to its reference. Jumps of the angle are no motion, and stay the same."""
        angle_deg = clean(recording).encoder_deg
        jumps_deg = recording.encoder_deg - angle_deg
        padded_deg = np.pad(angle_deg - angle_deg[0], len(self.weights) // 2, mode="edge")
        filtered_deg = np.correlate(padded_deg, np.array(self.weights), "valid")
        return replace(recording, encoder_deg=angle_deg[0] + filtered_deg + jumps_deg)


class _Moments(NamedTuple):
    """Sums of products of increments over a recording, for a window of w weights.

    reference
        (w, w) products within a window of the reference.
    with_gyro
        (w,) products of the window and the gyro.
    gyro
        Sum of squares of the gyro.
    """

    reference: Floats
    with_gyro: Floats
    gyro: float
    samples: int

    def residual(self, weights: Floats) -> float:
        """Sum of squared residuals with some weights."""
        return float(self.gyro - 2.0 * weights @ self.with_gyro + weights @ self.reference @ weights)


def reference_response_of(recordings: Sequence[Recording]) -> ReferenceResponse | None:
    """Response that recordings of a bench share; None if it does not predict recordings that it was not fitted to.

    It is also None for a single recording, which leaves nothing to test the prediction. It is None for references with
    steps, whose edges are finer in time than the samples of a gyro, and for slow references: the weights would be those
    of a filter against the error of interpolated angles, not those of the mechanics.
    """
    if len(recordings) < 2 or not all(_has_response(recording) for recording in recordings):
        return None
    period_s = float(np.median([recording.period_s for recording in recordings]))
    reach = min(max(1, round(REACH_S / period_s)), MOST_REACH)
    moments = [_moments_of(recording, reach) for recording in recordings]
    unchanged = np.zeros(2 * reach + 1)
    unchanged[reach] = 1.0
    held_out = [
        own.residual(_fitted(moments[:index] + moments[index + 1 :], unchanged)) for index, own in enumerate(moments)
    ]
    if sum(held_out) > BETTER * sum(own.residual(unchanged) for own in moments):
        return None
    return ReferenceResponse(tuple(_fitted(moments, unchanged).tolist()), period_s)


def _has_response(recording: Recording) -> bool:
    """Whether the response to the reference of a recording can be determined."""
    is_slow = np.mean(np.isnan(recording.encoder_deg)) > MOST_MISSING
    return recording.has_motion and not is_slow and not has_steps(recording.encoder_deg)


def _moments_of(recording: Recording, reach: int) -> _Moments:
    """Moments of the increments minus their means, so that the bias has no influence."""
    samples = clean(recording)
    gyro_dps = 0.5 * (samples.rate_dps[1:] + samples.rate_dps[:-1])
    reference_dps = np.diff(samples.encoder_deg) / recording.period_s
    gyro_dps, reference_dps = gyro_dps - gyro_dps.mean(), reference_dps - reference_dps.mean()
    windows = sliding_window_view(np.pad(reference_dps, reach), 2 * reach + 1)
    pieces = [slice(first, first + PIECE) for first in range(0, len(gyro_dps), PIECE)]
    return _Moments(
        np.sum([windows[piece].T @ windows[piece] for piece in pieces], axis=0),
        np.sum([windows[piece].T @ gyro_dps[piece] for piece in pieces], axis=0),
        float(gyro_dps @ gyro_dps),
        len(gyro_dps),
    )


def _fitted(moments: Sequence[_Moments], unchanged: Floats) -> Floats:
    """Weights by ridge regression. The noise variance is that of the residual with the unchanged reference."""
    products = np.sum([own.reference for own in moments], axis=0)
    with_gyro = np.sum([own.with_gyro for own in moments], axis=0)
    variance = sum(own.residual(unchanged) for own in moments) / sum(own.samples for own in moments)
    ridge = variance / PRIOR**2 * np.eye(len(unchanged))
    weights: Floats = unchanged + np.linalg.solve(products + ridge, with_gyro - products @ unchanged)
    return weights
