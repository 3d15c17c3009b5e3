"""Motion and temperature on the grid of a recording, as input of a simulated rig."""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import uniform_filter1d

from gyrodrift.diagnose.recording.recording import Recording, filled
from gyrodrift.io.compile import compiled_once
from gyrodrift.values.arrays import Floats

SMOOTH_S = 0.11
SMOOTH_DEGREE = 4
"""Window, s, and degree of the polynomial that is fitted to angles. Chosen: it keeps motion up to about 15 Hz and
smooths encoder counts."""

TEMP_SMOOTH_S = 2.0
"""Length of the moving average of the temperature, s. Chosen: the temperature of a sensor changes more slowly."""

REFERENCE_C = 25.0
"""Temperature of a recording without one, °C. Derived: the simulator's linear effects of temperature are zero there."""

SLACK = 1e-6
"""Tolerance, in samples, of times that count as the grid. The cubic also ends so far before the last sample. Chosen:
above rounding errors, and below any scatter of stamps."""


@dataclass(frozen=True, slots=True)
class ReplayedMotion:
    """Angle and rate on a grid, with interpolation; `firmware_sim` takes it as a profile.

    period_s
        Sample period of the grid.
    angle_deg, rate_dps, sensor_c
        Angle, degrees, rate, deg/s, and temperature, °C, shape (n,).
    powered_s
        Time from power-on to the first sample, s.
    vibration_dps
        Rate that the gyro senses beyond the motion, deg/s, shape (n,). Its angle is too small for the encoder.
    """

    period_s: float
    angle_deg: Floats = field(repr=False)
    rate_dps: Floats = field(repr=False)
    sensor_c: Floats = field(repr=False)
    powered_s: float
    vibration_dps: Floats | None = field(default=None, repr=False)

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle, degrees, and sensed rate, deg/s, at times since the first sample.

        The motion is interpolated by cubics, the vibration by lines.
        """
        if self._is_grid(t_s):
            angle_deg, rate_dps = self.angle_deg, self.rate_dps
        else:
            angle_deg, rate_dps = _cubic(np.ascontiguousarray(t_s), self.period_s, self.angle_deg, self.rate_dps)
        if self.vibration_dps is not None:
            grid_s = np.arange(len(self.vibration_dps)) * self.period_s
            rate_dps = rate_dps + np.interp(t_s, grid_s, self.vibration_dps)
        return angle_deg, rate_dps

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature at times since the first sample, °C, by linear interpolation."""
        if self._is_grid(t_s):
            return self.sensor_c
        temps_c: Floats = np.interp(t_s, np.arange(len(self.sensor_c)) * self.period_s, self.sensor_c)
        return temps_c

    def _is_grid(self, t_s: Floats) -> bool:
        last_s = (len(self.angle_deg) - 1) * self.period_s
        return len(t_s) == len(self.angle_deg) and t_s[0] == 0.0 and abs(t_s[-1] - last_s) < SLACK * self.period_s


@compiled_once()
def _cubic(t_s: Floats, period_s: float, node_deg: Floats, node_dps: Floats) -> tuple[Floats, Floats]:
    """Angle in degrees and rate in deg/s at times, by cubic Hermite interpolation of angles and rates on a grid.

    Before the first sample the rate is 0.
    """
    angle_deg, rate_dps = np.empty(len(t_s)), np.empty(len(t_s))
    last = len(node_deg) - 1.0 - SLACK
    for i in range(len(t_s)):
        slot = min(max(t_s[i] / period_s, 0.0), last)
        before = int(slot)
        u = slot - before
        y0, y1 = node_deg[before], node_deg[before + 1]
        d0, d1 = node_dps[before] * period_s, node_dps[before + 1] * period_s
        bend, twist = 3.0 * (y1 - y0) - 2.0 * d0 - d1, 2.0 * (y0 - y1) + d0 + d1
        angle_deg[i] = y0 + u * (d0 + u * (bend + u * twist))
        rate_dps[i] = (d0 + u * (2.0 * bend + 3.0 * u * twist)) / period_s if t_s[i] >= 0.0 else 0.0
    return angle_deg, rate_dps


def rough_rate_dps(recording: Recording, encoder_deg: Floats) -> Floats:
    """(n,) rate of an encoder, deg/s, by polynomials through the angles about a sample.

    A. Savitzky, M. J. E. Golay, Smoothing and differentiation of data by simplified least squares procedures (1964). At
    either end it is the slope of the first and of the last polynomial.
    """
    length, degree = _window(SMOOTH_S, recording, len(encoder_deg))
    half = length // 2
    powers = np.vander(np.arange(-half, half + 1, dtype=np.float64), degree + 1, increasing=True)
    fit = np.linalg.pinv(powers)
    slopes = powers[:, :-1] @ (np.arange(1, degree + 1)[:, None] * fit[1:])
    rate_dps = np.empty(len(encoder_deg))
    rate_dps[half : len(encoder_deg) - half] = np.correlate(encoder_deg, slopes[half], mode="valid")
    rate_dps[:half] = slopes[:half] @ encoder_deg[:length]
    rate_dps[len(encoder_deg) - half :] = slopes[half + 1 :] @ encoder_deg[-length:]
    return rate_dps / recording.period_s


def sensor_c_of(recording: Recording) -> Floats:
    """(n,) smoothed temperature, °C; REFERENCE_C if the recording has none."""
    if recording.temp_c is None:
        return np.full(len(recording.rate_dps), REFERENCE_C)
    length = _odd(TEMP_SMOOTH_S / recording.period_s, 3, len(recording.rate_dps))
    temps_c: Floats = uniform_filter1d(filled(recording.temp_c), length, mode="nearest")
    return temps_c


def _window(seconds: float, recording: Recording, samples: int) -> tuple[int, int]:
    """Length in samples and degree of a smoothing polynomial."""
    length = _odd(seconds / recording.period_s, SMOOTH_DEGREE + 1, samples)
    return length, min(SMOOTH_DEGREE, length - 1)


def _odd(samples: float, least: int, most: int) -> int:
    """Odd number near a number of samples, between `least` and `most`."""
    nearest = 2 * int(samples / 2.0) + 1
    return min(max(nearest, least | 1), most - 1 + most % 2)
