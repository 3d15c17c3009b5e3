"""What has to be right before anything is compared: sign, unit, axis, alignment, motion; put right where it can be."""

from dataclasses import dataclass, replace

import numpy as np
from scipy.ndimage import gaussian_filter1d

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.recording import Recording, filled

LEAST_S = 60.0
GYRO_MOVES_DPS = 10.0
LIKE = 0.8
"""Rates of gyro and encoder of one axis correlate at least so well."""

SMOOTH_S = 0.1
LAG_MOST_S = 5.0
LAG_S = 0.25
"""More than this between encoder and gyro is a recorder that joined them wrongly, not a sensor's delay."""

RADIAN = 180.0 / np.pi
UNITS = (
    (RADIAN, "is in radians per second, not degrees"),
    (1.0 / RADIAN, "is multiplied by 57.3 as if it had been radians"),
)
NEAR = 1.35
CLOCKS_APART = 0.2


@dataclass(frozen=True, slots=True)
class Passed:
    """A recording after the gates.

    recording
        Put right where it could be; None where nothing can be said of it.
    remarks
        What was found, each a sentence.
    """

    recording: Recording | None
    remarks: tuple[str, ...]


def pass_gates(recording: Recording) -> Passed:
    """Look at a recording as a whole."""
    angle_deg = filled(recording.encoder_deg)
    gyro_dps = _smooth(filled(recording.rate_dps), recording)
    encoder_dps = _smooth(np.gradient(angle_deg, recording.period_s), recording)
    name, remarks = recording.name, []
    if recording.seconds < LEAST_S:
        return Passed(
            None, (f"{name}: is {recording.seconds:.0f} s long; nothing is told in less than {LEAST_S:.0f} s",)
        )
    if not recording.moves:
        if np.ptp(gyro_dps) > GYRO_MOVES_DPS:
            return Passed(None, (f"{name}: the encoder does not move while the gyro does: is it connected?",))
        remarks.append(f"{name}: nothing moves in it; it tells of rest, clock and link alone")
        return Passed(recording, tuple(remarks))
    clocks = _clocks(recording)
    remarks += [clocks] if clocks else []
    lag, likeness = _best_lag(gyro_dps, encoder_dps, recording)
    if abs(likeness) < LIKE:
        why = "the gyro does not feel what the encoder sees: another axis, or encoder and gyro of different times?"
        return Passed(None, (*remarks, f"{name}: {why} (correlation {likeness:.2f})"))
    if abs(lag) * recording.period_s > LAG_S:
        seconds = lag * recording.period_s
        remarks.append(f"{name}: gyro and encoder are {abs(seconds):.2f} s apart; the encoder was shifted to fit")
        recording = replace(recording, encoder_deg=_shifted(recording.encoder_deg, lag))
        encoder_dps = _shifted(encoder_dps, lag)
    gain = float(gyro_dps @ encoder_dps / (encoder_dps @ encoder_dps))
    if gain < 0.0:
        remarks.append(f"{name}: the rate has the sign opposite to the encoder's; it was turned round")
        recording, gain = replace(recording, rate_dps=-recording.rate_dps), -gain
    for unit, what in UNITS:
        if 1.0 / NEAR < gain * unit < NEAR:
            remarks.append(f"{name}: the rate {what}; it was multiplied by {unit:.4g}")
            recording = replace(recording, rate_dps=recording.rate_dps * unit)
    return Passed(recording, tuple(remarks))


def _clocks(recording: Recording) -> str:
    if recording.host_s is None:
        return ""
    present = np.isfinite(recording.device_s)
    device_s = float(np.ptp(recording.device_s[present]))
    host_s = float(np.ptp(recording.host_s[np.isfinite(recording.host_s)]))
    if host_s <= 0.0 or abs(device_s / host_s - 1.0) > CLOCKS_APART:
        counted = f"the device counted {device_s:.1f} s while the host counted {host_s:.1f} s"
        return f"{recording.name}: {counted}: which is right?"
    return ""


def _smooth(rate_dps: Floats, recording: Recording) -> Floats:
    smooth: Floats = gaussian_filter1d(rate_dps, SMOOTH_S / recording.period_s)
    level: Floats = smooth - smooth.mean()
    return level


def _best_lag(gyro_dps: Floats, encoder_dps: Floats, recording: Recording) -> tuple[int, float]:
    """Samples by which the gyro comes later, and the correlation there."""
    most = min(round(LAG_MOST_S / recording.period_s), len(gyro_dps) // 4)
    size = 1 << (2 * len(gyro_dps) - 1).bit_length()
    product = np.fft.irfft(np.fft.rfft(gyro_dps, size) * np.conj(np.fft.rfft(encoder_dps, size)), size)
    lags = np.arange(-most, most + 1)
    by_lag = product[lags] / (np.linalg.norm(gyro_dps) * np.linalg.norm(encoder_dps))
    best = int(np.argmax(np.abs(by_lag)))
    return int(lags[best]), float(by_lag[best])


def _shifted(values: Floats, lag: int) -> Floats:
    """Later by `lag` samples; what is not known at an end stays as at that end."""
    return values[np.clip(np.arange(len(values)) - lag, 0, len(values) - 1)]
