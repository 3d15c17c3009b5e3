"""The rates of a recording beside its encoder: how alike they are, and by which factor they differ."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.session.angles import unwrapped
from gyrodrift.session.session import Session

BLOCK_S = 0.5
BLOCK_PERIODS = 4.0
"""Turns are compared over blocks of half a second, or of four samples where these are longer."""

LEAST_BLOCKS = 6
LEAST_DEG = 45.0
"""An encoder that goes less far in all tells no factor."""

HOLE_BLOCKS = 1.5
"""Blocks that take longer have a hole in them, and do not count."""

VARIES_DPS = 3.0
"""Standard deviation of the encoder's rate over the blocks: below it a bias that drifts hides what the rates follow."""

EVEN = 0.03
"""Of its mean: an encoder whose rate varies by less spins evenly, as in `diagnose.recording.delay`."""

EVEN_DPS = 30.0
"""An even spin, whose bias is unknown, tells a factor where it is so much faster than a bias of 3 deg/s."""

ALIKE = 0.95
"""Correlation below which the encoder is looked for at other times."""

MOST_READ = 5e7
"""Numbers beyond are no rates in any unit: the fastest gyro on sale reads 5·10⁷ mdps."""

LAG_MOST_S, LAG_STEP_S = 5.0, 0.05


@dataclass(frozen=True, slots=True)
class BesideEncoder:
    """What the encoder says of the rates.

    factor
        Turn of the encoder for one degree of the rates, with its sign.
    likeness
        Correlation of both over blocks; 1 in an even spin.
    lag_s
        By how much the encoder is late, s; 0 where it was not looked for.
    encoder_deg, rate_deg
        How far the encoder went, and how far the rates say that it went, less their bias, in all.
    """

    factor: float
    likeness: float
    lag_s: float
    encoder_deg: float
    rate_deg: float


@dataclass(frozen=True, slots=True)
class _Blocks:
    """Turns of an encoder over blocks of time, and the rates over all of it.

    begin_s, end_s, encoder_dps
        Of each block, shape (n,).
    t_s, turned_deg
        Times of the samples, and the integral of the rates there.
    """

    begin_s: Floats
    end_s: Floats
    encoder_dps: Floats
    t_s: Floats
    turned_deg: Floats

    def rates_dps(self, lag_s: float) -> Floats:
        """Mean rate over each block, taken earlier by a lag."""
        at_end, at_begin = (np.interp(at_s - lag_s, self.t_s, self.turned_deg) for at_s in (self.end_s, self.begin_s))
        rates: Floats = (at_end - at_begin) / (self.end_s - self.begin_s)
        return rates


def beside_encoder(session: Session) -> BesideEncoder | None:
    """The encoder beside the rates; None where there is none, or it does not tell."""
    blocks = _blocks(session)
    if blocks is None:
        return None
    seconds_s = blocks.end_s - blocks.begin_s
    path_deg = float(np.abs(blocks.encoder_dps) @ seconds_s)
    if path_deg < LEAST_DEG:
        return None
    mean_dps, varies_dps = float(blocks.encoder_dps.mean()), float(np.std(blocks.encoder_dps))
    if varies_dps < EVEN * abs(mean_dps):
        if abs(mean_dps) < EVEN_DPS:
            return None
        rate_dps = float(blocks.rates_dps(0.0).mean())
        factor = mean_dps / rate_dps if rate_dps else float("inf")
        return BesideEncoder(factor, 1.0, 0.0, path_deg, path_deg / factor)
    if varies_dps < VARIES_DPS:
        return None
    likeness, lag_s = _best_lag(blocks)
    rates_dps = blocks.rates_dps(lag_s)
    spread_dps = float(np.std(rates_dps))
    factor = varies_dps / spread_dps if spread_dps else float("inf")
    turned_deg = float(np.abs(rates_dps - np.median(rates_dps)) @ seconds_s)
    return BesideEncoder(np.copysign(factor, likeness), likeness, lag_s, path_deg, turned_deg)


def _blocks(session: Session) -> _Blocks | None:
    if session.encoder_deg is None:
        return None
    t_s, rate_dps, angle_deg = _rising(session, session.encoder_deg)
    known = np.isfinite(angle_deg)
    if np.count_nonzero(known) < LEAST_BLOCKS:
        return None
    turned_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) * np.diff(t_s))])
    known_s, known_deg = t_s[known], unwrapped(angle_deg[known])
    block_s = max(BLOCK_S, BLOCK_PERIODS * float(np.median(np.diff(known_s))))
    ends = np.flatnonzero(np.diff(np.floor((known_s - known_s[0]) / block_s), prepend=-1.0) > 0.0)
    begin_s, end_s = known_s[ends[:-1]], known_s[ends[1:]]
    whole = end_s - begin_s < HOLE_BLOCKS * block_s
    if np.count_nonzero(whole) < LEAST_BLOCKS:
        return None
    encoder_dps = np.diff(known_deg[ends]) / (end_s - begin_s)
    return _Blocks(begin_s[whole], end_s[whole], encoder_dps[whole], t_s, turned_deg)


def _rising(session: Session, encoder_deg: Floats) -> tuple[Floats, Floats, Floats]:
    """Times, rates and angles of the samples that have a rate and are later than all before them."""
    finite = np.isfinite(session.t_device_s) & (np.abs(session.rate_dps) <= MOST_READ)
    t_s, rate_dps, angle_deg = session.t_device_s[finite], session.rate_dps[finite], encoder_deg[finite]
    latest_s = np.maximum.accumulate(np.concatenate([[-np.inf], t_s[:-1]]))
    later = t_s > latest_s
    return t_s[later], rate_dps[later], angle_deg[later]


def _best_lag(blocks: _Blocks) -> tuple[float, float]:
    """Correlation of encoder and rates, and the lag of the encoder at which it is largest, s."""
    likeness = _likeness(blocks, 0.0)
    if abs(likeness) > ALIKE:
        return likeness, 0.0
    lags_s = np.arange(-LAG_MOST_S, LAG_MOST_S + LAG_STEP_S, LAG_STEP_S).tolist()
    found = [(_likeness(blocks, lag_s), lag_s) for lag_s in (0.0, *lags_s)]
    return max(found, key=lambda each: abs(each[0]))


def _likeness(blocks: _Blocks, lag_s: float) -> float:
    encoder_dps, rates_dps = (values - values.mean() for values in (blocks.encoder_dps, blocks.rates_dps(lag_s)))
    norm = float(np.linalg.norm(encoder_dps) * np.linalg.norm(rates_dps))
    return float(encoder_dps @ rates_dps) / norm if norm else 0.0
