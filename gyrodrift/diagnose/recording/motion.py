"""A motion and a temperature that a simulated rig can be driven through, on the grid of a recording."""

from dataclasses import dataclass, field

import numpy as np
from scipy.ndimage import uniform_filter1d
from scipy.signal import savgol_filter

from gyrodrift.arrays import Floats
from gyrodrift.compile import compiled_once
from gyrodrift.diagnose.recording.recording import Recording, filled

SMOOTH_S = 0.11
SMOOTH_DEGREE = 4
"""A fitted quartic over a tenth of a second keeps motion up to some 15 Hz and takes the edge off encoder counts."""

TEMP_SMOOTH_S = 2.0
"""Length of the window through which the temperature is smoothed."""

ROOM_C = 25.0
"""Where a recording has no temperature: the one at which the simulator's linear effects of temperature are zero."""

SLACK = 1e-6
"""Of a sample: times that agree so well are those of the grid; and how far before the last sample the motion ends."""


@dataclass(frozen=True, slots=True)
class ReplayedMotion:
    """Angle and rate on a grid, and in between; `firmware_sim` takes it for a profile.

    period_s, angle_deg, rate_dps, sensor_c
        The grid: shape (n,) each, degrees, deg/s, °C.
    powered_s
        How long the device had been on, s.
    """

    period_s: float
    angle_deg: Floats = field(repr=False)
    rate_dps: Floats = field(repr=False)
    sensor_c: Floats = field(repr=False)
    powered_s: float

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle in degrees and rate in deg/s at times from the first sample on; cubic between the points."""
        if self._is_grid(t_s):
            return self.angle_deg, self.rate_dps
        angle_deg, rate_dps = _cubic(np.ascontiguousarray(t_s), self.period_s, self.angle_deg, self.rate_dps)
        return angle_deg, rate_dps

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature at times from the first sample on, °C; straight lines between the points."""
        if self._is_grid(t_s):
            return self.sensor_c
        temps_c: Floats = np.interp(t_s, np.arange(len(self.sensor_c)) * self.period_s, self.sensor_c)
        return temps_c

    def _is_grid(self, t_s: Floats) -> bool:
        last_s = (len(self.angle_deg) - 1) * self.period_s
        return len(t_s) == len(self.angle_deg) and t_s[0] == 0.0 and abs(t_s[-1] - last_s) < SLACK * self.period_s


@compiled_once()
def _cubic(t_s: Floats, period_s: float, node_deg: Floats, node_dps: Floats) -> tuple[Floats, Floats]:
    """Angle in degrees and rate in deg/s at times, by Hermite's cubic through angles and rates of a grid."""
    angle_deg, rate_dps = np.empty(len(t_s)), np.empty(len(t_s))
    last = len(node_deg) - 1.0 - SLACK
    for i in range(len(t_s)):
        slot = min(max(t_s[i] / period_s, 0.0), last)
        left = int(slot)
        u = slot - left
        y0, y1 = node_deg[left], node_deg[left + 1]
        d0, d1 = node_dps[left] * period_s, node_dps[left + 1] * period_s
        bend, twist = 3.0 * (y1 - y0) - 2.0 * d0 - d1, 2.0 * (y0 - y1) + d0 + d1
        angle_deg[i] = y0 + u * (d0 + u * (bend + u * twist))
        rate_dps[i] = (d0 + u * (2.0 * bend + 3.0 * u * twist)) / period_s if t_s[i] >= 0.0 else 0.0
    return angle_deg, rate_dps


def rough_rate_dps(recording: Recording, encoder_deg: Floats) -> Floats:
    """Rate of an encoder without the care that a replay takes, deg/s, shape (n,)."""
    points, degree = _window(SMOOTH_S, recording, len(encoder_deg))
    rate_dps: Floats = savgol_filter(encoder_deg, points, degree, deriv=1, delta=recording.period_s)
    return rate_dps


def sensor_c_of(recording: Recording) -> Floats:
    """Temperature at each sample, °C, smoothed; ROOM_C where there is none."""
    if recording.temp_c is None:
        return np.full(len(recording.rate_dps), ROOM_C)
    points = _odd(TEMP_SMOOTH_S / recording.period_s, 3, len(recording.rate_dps))
    temps_c: Floats = uniform_filter1d(filled(recording.temp_c), points, mode="nearest")
    return temps_c


def _window(seconds: float, recording: Recording, samples: int) -> tuple[int, int]:
    """Points and degree of a smoothing."""
    points = _odd(seconds / recording.period_s, SMOOTH_DEGREE + 1, samples)
    return points, min(SMOOTH_DEGREE, points - 1)


def _odd(points: float, least: int, most: int) -> int:
    """The odd number next to a number of points, within what there is."""
    wanted = 2 * int(points / 2.0) + 1
    return min(max(wanted, least | 1), most - 1 + most % 2)
