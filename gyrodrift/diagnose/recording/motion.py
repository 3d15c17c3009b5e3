"""How a recording's device moved and how warm it was, rebuilt so that a simulated rig can be driven through it."""

from dataclasses import dataclass, field

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.ndimage import gaussian_filter1d
from scipy.signal import savgol_filter

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.recording.recording import Recording, filled

SMOOTH_S = 0.11
SMOOTH_DEGREE = 4
"""A fitted quartic over a tenth of a second keeps motion up to some 15 Hz and takes the edge off encoder counts."""

STEADY_S = 0.6
"""Length of the long window: motion that is steady over it has no steps of the angle left."""

BLEND_S = 0.08
"""Standard deviation of the Gaussian over which one window goes over into the other."""

APART_LEAST = 1.0
"""The windows are blended by how far they differ, in standard deviations of the rounding to a step."""

COARSE_DPS = 4.0
"""An encoder is coarse when one of its steps, taken in one sample, is a rate of this."""

CROSSOVER_S = 0.5
"""Standard deviation of the Gaussian below which a coarse encoder, and above which the gyro, says how it moves."""

MOVES_DPS = 1.0
"""Below it a coarse encoder is at rest, and the gyro's noise is no motion."""

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

    def at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle in degrees and rate in deg/s at times from the first sample on; cubic between the points."""
        if self._is_grid(t_s):
            return self.angle_deg, self.rate_dps
        place = np.clip(t_s / self.period_s, 0.0, len(self.angle_deg) - 1.0 - SLACK)
        left = place.astype(np.int64)
        u = place - left
        y0, y1 = self.angle_deg[left], self.angle_deg[left + 1]
        d0, d1 = self.rate_dps[left] * self.period_s, self.rate_dps[left + 1] * self.period_s
        bend, twist = 3.0 * (y1 - y0) - 2.0 * d0 - d1, 2.0 * (y0 - y1) + d0 + d1
        angle_deg = y0 + u * (d0 + u * (bend + u * twist))
        rate_dps = (d0 + u * (2.0 * bend + 3.0 * u * twist)) / self.period_s
        rate_dps[t_s < 0.0] = 0.0
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


def rough_rate_dps(recording: Recording, encoder_deg: Floats) -> Floats:
    """Rate of an encoder without the care that a replay takes, deg/s, shape (n,)."""
    points, degree = _window(SMOOTH_S, recording, len(encoder_deg))
    rate_dps: Floats = savgol_filter(encoder_deg, points, degree, deriv=1, delta=recording.period_s)
    return rate_dps


def motion_of(recording: Recording, encoder_deg: Floats, rate_dps: Floats, step_deg: float) -> ReplayedMotion:
    """The motion behind an encoder's angles and a gyro's rates, both without holes and jumps.

    `step_deg` is the step that the angles come in. Fine ones say it all. Where they are coarse, what is faster than
    CROSSOVER_S is the gyro's, as long as it moves: else the steps would be taken for motion.
    """
    angle_deg = _smoothed(recording, encoder_deg, step_deg)
    if step_deg / recording.period_s > COARSE_DPS:
        sigma = CROSSOVER_S / recording.period_s
        slow_deg = gaussian_filter1d(encoder_deg, sigma)
        window = _window(SMOOTH_S, recording, len(rate_dps))
        turned_deg = savgol_filter(np.cumsum(rate_dps) * recording.period_s, *window)
        moves = np.abs(np.gradient(slow_deg, recording.period_s)) > MOVES_DPS
        quick_deg = turned_deg - gaussian_filter1d(turned_deg, sigma)
        angle_deg = slow_deg + gaussian_filter1d(moves.astype(np.float64), sigma / 2.0) * quick_deg
    # The rate is that of the very curve that runs through the angles, or gyro and encoder would see two motions.
    t_s = np.arange(len(angle_deg)) * recording.period_s
    rate_dps = CubicSpline(t_s, angle_deg).derivative()(t_s)
    return ReplayedMotion(recording.period_s, angle_deg, rate_dps, _sensor_c(recording), recording.powered_s)


def _sensor_c(recording: Recording) -> Floats:
    if recording.temp_c is None:
        return np.full(len(recording.rate_dps), ROOM_C)
    points = _odd(TEMP_SMOOTH_S / recording.period_s, 3, len(recording.rate_dps))
    temps_c: Floats = savgol_filter(filled(recording.temp_c), points, 1)
    return temps_c


def _smoothed(recording: Recording, encoder_deg: Floats, step_deg: float) -> Floats:
    """Quick motion through a short window, steady motion through a long one, in which steps of the angle vanish."""
    quick, steady = (
        savgol_filter(encoder_deg, *_window(seconds, recording, len(encoder_deg))) for seconds in (SMOOTH_S, STEADY_S)
    )
    sigma = BLEND_S / recording.period_s
    apart = np.sqrt(gaussian_filter1d(np.square(quick - steady), sigma)) / (step_deg / np.sqrt(12.0) + 1e-12)
    weight = gaussian_filter1d(np.clip((apart - APART_LEAST) / APART_LEAST, 0.0, 1.0), sigma)
    blended: Floats = steady + weight * (quick - steady)
    return blended


def _window(seconds: float, recording: Recording, samples: int) -> tuple[int, int]:
    """Points and degree of a smoothing."""
    points = _odd(seconds / recording.period_s, SMOOTH_DEGREE + 1, samples)
    return points, min(SMOOTH_DEGREE, points - 1)


def _odd(points: float, least: int, most: int) -> int:
    """The odd number next to a number of points, within what there is."""
    wanted = 2 * int(points / 2.0) + 1
    return min(max(wanted, least | 1), most - 1 + most % 2)
