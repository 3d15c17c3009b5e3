"""Comparison of the rates of a recording with its encoder: correlation, factor and lag."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.session.session import Session, unwrapped
from gyrodrift.values.arrays import Floats, Mask

BLOCK_S = 0.5
BLOCK_PERIODS = 4.0
"""Angles are compared over blocks of 0.5 s or of four samples, whichever is longer."""

LEAST_BLOCKS = 6
LEAST_DEG = 45.0
"""Least path of the encoder that shows a factor."""

GAP_BLOCKS = 1.5
"""Longer blocks have a gap and do not count."""

VARIES_DPS = 3.0
"""Least standard deviation of the encoder rate over the blocks; below it a drifting bias hides the relation."""

STEADY = 0.03
"""A spin is steady if its rate varies by less than this share of the mean, as in `diagnose.recording.delay`."""

STEADY_DPS = 30.0
"""A steady spin shows a factor only if it is this much faster than an unknown bias of 3 deg/s."""

SIMILAR = 0.95
"""A lag is searched for if the correlation is below this."""

MOST_READ = 5e7
"""Larger numbers are no rates in any unit: the fastest gyro on sale reads 5·10⁷ mdps."""

LAG_MOST_S, LAG_STEP_S = 5.0, 0.05

AVERAGE_S = 1.0
"""Time over which accelerations are averaged: steps and vibration cancel, and a tilt by hand takes longer."""


@dataclass(frozen=True, slots=True)
class EncoderComparison:
    """Comparison of rates and encoder.

    factor
        Encoder angle per degree of the integrated rate, with its sign.
    correlation
        Correlation over blocks; 1 in a steady spin.
    lag_s
        Delay of the encoder, s; 0 if it was not searched for.
    encoder_deg, rate_deg
        Total path of the encoder and of the integrated rate without its bias, deg.
    """

    factor: float
    correlation: float
    lag_s: float
    encoder_deg: float
    rate_deg: float


@dataclass(frozen=True, slots=True)
class _Blocks:
    """Rates of an encoder over n blocks, and the integrated rate.

    begin_s, end_s, encoder_dps
        Start, end and mean rate of the blocks, shape (n,).
    t_s, rate_angle_deg
        Times of the m samples, and the integrated rate there, shape (m,).
    """

    begin_s: Floats
    end_s: Floats
    encoder_dps: Floats
    t_s: Floats
    rate_angle_deg: Floats

    def rates_dps(self, lag_s: float) -> Floats:
        """Mean rate over each block, shifted back by a lag, shape (n,)."""
        at_end, at_begin = (
            np.interp(at_s - lag_s, self.t_s, self.rate_angle_deg) for at_s in (self.end_s, self.begin_s)
        )
        rates: Floats = (at_end - at_begin) / (self.end_s - self.begin_s)
        return rates


def compared_to_encoder(session: Session) -> EncoderComparison | None:
    """Compare rates and encoder; None without an encoder, or if it turns too little."""
    blocks = _blocks(session)
    if blocks is None:
        return None
    seconds_s = blocks.end_s - blocks.begin_s
    path_deg = float(np.abs(blocks.encoder_dps) @ seconds_s)
    if path_deg < LEAST_DEG:
        return None
    mean_dps, encoder_spread_dps = float(blocks.encoder_dps.mean()), float(np.std(blocks.encoder_dps))
    if encoder_spread_dps < STEADY * abs(mean_dps):
        if abs(mean_dps) < STEADY_DPS:
            return None
        rate_dps = float(blocks.rates_dps(0.0).mean())
        factor = mean_dps / rate_dps if rate_dps else float("inf")
        return EncoderComparison(factor, 1.0, 0.0, path_deg, path_deg / factor)
    if encoder_spread_dps < VARIES_DPS:
        return None
    correlation, lag_s = _best_lag(blocks)
    rates_dps = blocks.rates_dps(lag_s)
    spread_dps = float(np.std(rates_dps))
    factor = encoder_spread_dps / spread_dps if spread_dps else float("inf")
    rate_angle_deg = float(np.abs(rates_dps - np.median(rates_dps)) @ seconds_s)
    return EncoderComparison(np.copysign(factor, correlation), correlation, lag_s, path_deg, rate_angle_deg)


def _blocks(session: Session) -> _Blocks | None:
    if session.encoder_deg is None:
        return None
    t_s, rate_dps, angle_deg = _rising(session, session.encoder_deg)
    is_finite = np.isfinite(angle_deg)
    if np.count_nonzero(is_finite) < LEAST_BLOCKS:
        return None
    rate_angle_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) * np.diff(t_s))])
    finite_s, finite_deg = t_s[is_finite], unwrapped(angle_deg[is_finite])
    block_s = max(BLOCK_S, BLOCK_PERIODS * float(np.median(np.diff(finite_s))))
    ends = np.flatnonzero(np.diff(np.floor((finite_s - finite_s[0]) / block_s), prepend=-1.0) > 0.0)
    begin_s, end_s = finite_s[ends[:-1]], finite_s[ends[1:]]
    is_whole = end_s - begin_s < GAP_BLOCKS * block_s
    if np.count_nonzero(is_whole) < LEAST_BLOCKS:
        return None
    encoder_dps = np.diff(finite_deg[ends]) / (end_s - begin_s)
    return _Blocks(begin_s[is_whole], end_s[is_whole], encoder_dps[is_whole], t_s, rate_angle_deg)


def _rising(session: Session, encoder_deg: Floats) -> tuple[Floats, Floats, Floats]:
    """Times, rates and angles of the samples with a rate and a time later than all previous ones."""
    rates_dps = vertical_rates_dps(session)
    is_finite = np.isfinite(session.t_device_s) & (np.abs(rates_dps) <= MOST_READ)
    t_s, rate_dps, angle_deg = session.t_device_s[is_finite], rates_dps[is_finite], encoder_deg[is_finite]
    latest_s = np.maximum.accumulate(np.concatenate([[-np.inf], t_s[:-1]]))
    is_later = t_s > latest_s
    return t_s[is_later], rate_dps[is_later], angle_deg[is_later]


def _best_lag(blocks: _Blocks) -> tuple[float, float]:
    """Largest correlation of encoder and rates, and its lag, s."""
    correlation = _correlation(blocks, 0.0)
    if abs(correlation) > SIMILAR:
        return correlation, 0.0
    lags_s = np.arange(-LAG_MOST_S, LAG_MOST_S + LAG_STEP_S, LAG_STEP_S).tolist()
    correlations = [(_correlation(blocks, lag_s), lag_s) for lag_s in (0.0, *lags_s)]
    return max(correlations, key=lambda pair: abs(pair[0]))


def _correlation(blocks: _Blocks, lag_s: float) -> float:
    encoder_dps, rates_dps = (values - values.mean() for values in (blocks.encoder_dps, blocks.rates_dps(lag_s)))
    norm = float(np.linalg.norm(encoder_dps) * np.linalg.norm(rates_dps))
    return float(encoder_dps @ rates_dps) / norm if norm else 0.0


def vertical_rates_dps(session: Session) -> Floats:
    """Rates about the vertical by the averaged direction of the accelerations, deg/s, shape (n,), good to some percent.

    For a device with one axis, and where the direction is unknown, the rate about z.
    """
    if session.gyro_dps is None or session.accel_mps2 is None:
        return session.rate_dps
    is_known = np.isfinite(session.accel_mps2).all(axis=1) & np.isfinite(session.t_device_s)
    if np.count_nonzero(is_known) < 2:
        return session.rate_dps
    steps_s = np.diff(session.t_device_s[is_known])
    period_s = float(np.median(steps_s[steps_s > 0.0])) if (steps_s > 0.0).any() else AVERAGE_S
    means = _averaged(np.where(is_known[:, None], session.accel_mps2, 0.0), is_known, round(AVERAGE_S / period_s))
    lengths = np.linalg.norm(means, axis=1)
    rates: Floats = (session.gyro_dps * means).sum(axis=1) / np.where(lengths > 0.0, lengths, 1.0)
    return np.where((lengths > 0.0) & np.isfinite(rates), rates, session.rate_dps)


def _averaged(forces: Floats, is_known: Mask, size: int) -> Floats:
    """Moving average over `size` samples around each sample; zeros where none of them is known."""
    half = max(1, size // 2)
    sums = np.concatenate([np.zeros((1, 3)), np.cumsum(forces, axis=0)])
    counts = np.concatenate([[0], np.cumsum(is_known)])
    index = np.arange(len(forces))
    start, end = np.maximum(index - half, 0), np.minimum(index + half + 1, len(forces))
    means: Floats = (sums[end] - sums[start]) / np.maximum(counts[end] - counts[start], 1)[:, None]
    return means
