"""Accelerations of a session: gravity with its size, direction and noise, and whether it turns as the gyro says."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.columns.accel_axes import TURN_MIN_DEG, WINDOW_S, Agreement, Tilting, agreement_of
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

QUIET_SHARE = 0.2
"""Share of the windows, those with the least scatter, that count as quiet: chosen."""

WINDOWS_MIN = 8
"""Windows with a tilt that are needed for a comparison: chosen."""


@dataclass(frozen=True, slots=True)
class SessionAxes:
    """Rates and accelerations of three axes.

    rates_dps
        Least and largest finite rate by axis, deg/s.
    accel_norm_mps2
        Median length of the accelerations, m/s²; None without an accelerometer.
    without_accel
        Number of samples without acceleration.
    """

    rates_dps: dict[str, tuple[float, float]]
    accel_norm_mps2: float | None
    without_accel: int


def axes_of(session: Session) -> SessionAxes | None:
    """Axes of a session; None for a device with one axis."""
    if session.gyro_dps is None:
        return None
    rates_dps = {}
    for name, column in zip("xyz", session.gyro_dps.T, strict=True):
        finite = column[np.isfinite(column)]
        rates_dps[name] = (float(finite.min(initial=0.0)), float(finite.max(initial=0.0)))
    if session.accel_mps2 is None:
        return SessionAxes(rates_dps, None, len(session.rate_dps))
    lengths = np.linalg.norm(session.accel_mps2, axis=1)
    is_known = np.isfinite(lengths)
    length_mps2 = float(np.median(lengths[is_known])) if is_known.any() else None
    return SessionAxes(rates_dps, length_mps2, int(np.count_nonzero(~is_known)))


@dataclass(frozen=True, slots=True)
class GravitySummary:
    """Gravity as the accelerometer measures it.

    size_mps2
        Median size in the quiet windows, m/s².
    up
        Axis of the sensor that points up most, such as `+z`.
    noise_mps2
        Median scatter of single samples in the quiet windows, m/s².
    largest_mps2, at_largest
        Largest absolute value, m/s², and the number of samples at it.
    missing
        Share of the samples without an acceleration.
    """

    size_mps2: float
    up: str
    noise_mps2: float
    largest_mps2: float
    at_largest: int
    missing: float


def gravity_summary(session: Session) -> GravitySummary | None:
    """Size, direction and noise of gravity; None for a session without accelerations."""
    accel = session.accel_mps2
    if accel is None or not np.isfinite(accel).all(axis=1).any():
        return None
    is_finite = np.isfinite(accel).all(axis=1)
    means, scatters = _windows(session.t_device_s[is_finite], accel[is_finite])
    quiet = scatters <= np.quantile(scatters, QUIET_SHARE)
    mean = np.median(means[quiet], axis=0)
    size = float(np.median(np.linalg.norm(means[quiet], axis=1)))
    index = int(np.abs(mean).argmax())
    absolute = np.abs(accel[is_finite])
    largest = float(absolute.max())
    return GravitySummary(
        size_mps2=size,
        up=f"{'+' if mean[index] > 0 else '-'}{'xyz'[index]}",
        noise_mps2=float(np.median(scatters[quiet])),
        largest_mps2=largest,
        at_largest=int((absolute >= largest).any(axis=1).sum()),
        missing=1.0 - float(is_finite.mean()),
    )


def axes_agreement(session: Session) -> Agreement | None:
    """Compare the turn of gravity with the gyro; None without enough tilt."""
    if session.gyro_dps is None or session.accel_mps2 is None:
        return None
    is_finite = np.isfinite(session.accel_mps2).all(axis=1) & np.isfinite(session.gyro_dps).all(axis=1)
    t_s, gyro_dps, accel = session.t_device_s[is_finite], session.gyro_dps[is_finite], session.accel_mps2[is_finite]
    if len(t_s) < WINDOWS_MIN:
        return None
    means, _ = _windows(t_s, accel)
    turns_rad, _ = _windows(t_s, np.deg2rad(_integrals(t_s, gyro_dps)))
    directions = means / np.maximum(np.linalg.norm(means, axis=1, keepdims=True), 1e-12)
    changes, rotations = np.diff(directions, axis=0), np.diff(turns_rad, axis=0)
    middles = 0.5 * (directions[1:] + directions[:-1])
    tilted = np.linalg.norm(changes, axis=1) > np.deg2rad(TURN_MIN_DEG)
    if tilted.sum() < WINDOWS_MIN:
        return None
    rows = (table[tilted].tolist() for table in (changes, rotations, middles))
    return agreement_of([Tilting(*map(tuple, motion)) for motion in zip(*rows, strict=True)])


def _integrals(t_s: Floats, rates: Floats) -> Floats:
    """Running integrals of the columns by the trapezium, from 0."""
    steps = 0.5 * (rates[1:] + rates[:-1]) * np.diff(t_s)[:, None]
    integrals: Floats = np.vstack([np.zeros(rates.shape[1]), np.cumsum(steps, axis=0)])
    return integrals


def _windows(t_s: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Means of the columns over windows, and the scatter of the samples within, root of the mean variance."""
    index = np.floor((t_s - t_s[0]) / WINDOW_S).astype(int)
    _, first, counts = np.unique(index, return_index=True, return_counts=True)
    sums, squares = np.add.reduceat(values, first, axis=0), np.add.reduceat(values**2, first, axis=0)
    means = sums / counts[:, None]
    variances = np.maximum(squares / counts[:, None] - means**2, 0.0)
    return means, np.sqrt(variances.mean(axis=1))
