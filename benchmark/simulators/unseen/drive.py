"""Parts that all benches share: the step of physics and control, and a PID with a limit."""

from dataclasses import dataclass

import numpy as np

from simulators.flaws import Floats

STEP_S = 0.0025
"""It divides the periods of all sample rates of the cases: 40, 50, 80 and 100 Hz, 400/6 and 400/7 Hz."""


def steps_per_sample(rate_hz: float) -> int:
    """Physics steps between two samples."""
    return round(1.0 / rate_hz / STEP_S)


@dataclass(slots=True)
class LimitedPid:
    """Torque, N m, that follows an angle; its integral rests at the limit.

    Gains in N m/rad, N m s/rad and N m/(rad s). They were chosen here: the error stays below some degrees.
    """

    proportional: float
    derivative: float
    integral: float
    limit_nm: float
    sum_rad_s: float = 0.0

    def torque_nm(self, error_rad: float, error_rad_s: float) -> float:
        """Torque over the next step."""
        raw = self.proportional * error_rad + self.derivative * error_rad_s + self.integral * self.sum_rad_s
        limited = min(max(raw, -self.limit_nm), self.limit_nm)
        if raw == limited:
            self.sum_rad_s += error_rad * STEP_S
        return limited


def to_rate_and_angle(samples: list[tuple[float, float]]) -> tuple[Floats, Floats]:
    """Samples in rad/s and rad as rates, deg/s, and angles, deg."""
    rates_dps, angles_deg = np.degrees(np.array(samples)).T
    return rates_dps, angles_deg
