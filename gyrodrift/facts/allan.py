"""Allan deviation of a rest, and the noise parameters that it shows."""

from dataclasses import dataclass
from math import inf, sqrt

import numpy as np

from gyrodrift.facts.rests import Stretch
from gyrodrift.values.arrays import Floats
from gyrodrift.values.noise import FLICKER_FLOOR

ALLAN_LEAST_S = 30.0
CLUSTERS_LEAST = 9
"""Relative error of an Allan deviation over K independent clusters: 1/√(2(K − 1)), 0.25 for nine (IEEE 952, C.1)."""

WHITE_CLUSTERS = 51
WHITE_SLOPE_SLACK = 0.2
"""White noise is read where the relative error is at most 0.1 and the slope is −1/2 within the slack."""

LOW_PASSED = 0.8
"""A deviation at short times below this share of the white noise is the effect of a low-pass."""

FLAT_ERROR = 0.2
"""A flat minimum counts only where the relative error is at most this, over two octaves."""


@dataclass(frozen=True, slots=True)
class Allan:
    """Noise over one rest.

    taus_s, deviations_dps
        Overlapping Allan deviation, shape (k,), averaging times in octaves.
    angle_random_walk_deg_rts
        N, deg/√s: the line of slope −1/2 at 1 s; None without this slope.
    bias_instability_dps, bias_instability_tau_s
        B, deg/s: the minimum over 0.664, and its averaging time, s; None if the rest is too short.
    """

    stretch: Stretch
    taus_s: Floats
    deviations_dps: Floats
    angle_random_walk_deg_rts: float | None
    bias_instability_dps: float | None
    bias_instability_tau_s: float | None


def allan_deviation(rate_dps: Floats, period_s: float) -> tuple[Floats, Floats]:
    """Averaging times in octaves, s, and overlapping Allan deviations, deg/s; both of shape (k,).

    The longest time leaves 9 clusters. Equation C.12 of IEEE Std 952-1997, on the integrated rate.
    """
    angles_deg = np.zeros(len(rate_dps) + 1)
    np.cumsum((rate_dps - rate_dps.mean()) * period_s, out=angles_deg[1:])
    octaves = (len(rate_dps) // CLUSTERS_LEAST).bit_length()
    taus_s: Floats = period_s * np.exp2(np.arange(octaves, dtype=np.float64))
    deviations_dps = np.zeros(octaves)
    buffer_deg = np.empty((2, len(rate_dps)))
    for octave, tau_s in enumerate(taus_s):
        lag = 1 << octave
        turns_deg = np.subtract(angles_deg[lag:], angles_deg[:-lag], out=buffer_deg[0, : 1 - lag or None])
        changes_deg = np.subtract(turns_deg[lag:], turns_deg[:-lag], out=buffer_deg[1, : 1 - 2 * lag])
        deviations_dps[octave] = sqrt(changes_deg @ changes_deg / (2.0 * len(changes_deg))) / tau_s
    return taus_s, deviations_dps


def allan_errors(taus_s: Floats, span_s: float) -> Floats:
    """Relative standard deviation of Allan deviations over a stretch of `span_s` (IEEE 952, C.1), shape (k,)."""
    errors: Floats = 1.0 / np.sqrt(2.0 * (span_s / taus_s - 1.0))
    return errors


def allan_of(stretch: Stretch, rate_dps: Floats) -> Allan | None:
    """Allan deviation of a rest; None if it is shorter than 30 s. Samples are taken as evenly spaced."""
    period_s = (stretch.end_s - stretch.start_s) / max(len(rate_dps) - 1, 1)
    span_s = period_s * len(rate_dps)
    if not ALLAN_LEAST_S * 0.999 <= span_s < inf or len(rate_dps) < CLUSTERS_LEAST:
        return None
    taus_s, deviations_dps = allan_deviation(rate_dps, period_s)
    walk = _angle_random_walk(taus_s, deviations_dps, span_s)
    lowest = _minimum_index(taus_s, deviations_dps, span_s, walk or 0.0)
    return Allan(
        stretch=stretch,
        taus_s=taus_s,
        deviations_dps=deviations_dps,
        angle_random_walk_deg_rts=walk,
        bias_instability_dps=None if lowest is None else float(deviations_dps[lowest]) / FLICKER_FLOOR,
        bias_instability_tau_s=None if lowest is None else float(taus_s[lowest]),
    )


def _angle_random_walk(taus_s: Floats, deviations_dps: Floats, span_s: float) -> float | None:
    """Angle random walk, deg/√s: the first run of averaging times with a slope of −1/2, at 1 s."""
    if not (deviations_dps > 0.0).all():
        return None
    is_white = np.abs(np.diff(np.log2(deviations_dps)) + 0.5) <= WHITE_SLOPE_SLACK
    is_white &= taus_s[1:] <= span_s / WHITE_CLUSTERS
    if not is_white.any():
        return None
    first = int(is_white.argmax())
    length = int(np.argmin(np.append(is_white[first:], [False])))
    white = slice(first + (first > 0), first + length + 1)  # the curve before the slope bends its first point
    return float(np.exp(np.log(deviations_dps[white] * np.sqrt(taus_s[white])).mean()))


def _minimum_index(taus_s: Floats, deviations_dps: Floats, span_s: float, walk_deg_rts: float) -> int | None:
    """Index of the minimum if the curve then rises by more than its error, or is flat above white noise; else None.

    A deviation below the line of white noise at short times is the effect of a low-pass, not a minimum.
    """
    errors = allan_errors(taus_s, span_s)
    white_dps = walk_deg_rts / np.sqrt(taus_s)
    first = int(np.argmax(deviations_dps >= LOW_PASSED * white_dps))
    lowest = first + int(deviations_dps[first:].argmin())
    has_risen = deviations_dps[lowest:] > deviations_dps[lowest] * (1.0 + errors[lowest:])
    is_flat = deviations_dps[2:] > deviations_dps[:-2] * (1.0 - errors[2:])
    is_flat &= (
        (deviations_dps > white_dps * (1.0 + 2.0 * errors))[2:] & (errors[2:] <= FLAT_ERROR) & (white_dps[2:] > 0)
    )
    return lowest if deviations_dps[lowest] > 0.0 and (has_risen.any() or is_flat.any()) else None
