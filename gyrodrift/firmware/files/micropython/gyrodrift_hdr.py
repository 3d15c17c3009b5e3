"""HDR, heuristic drift reduction, for MicroPython: yaw and bias of one gyro axis.

    hdr = Hdr()
    hdr.update_us(time.ticks_us(), rate_dps)    # for each measurement
    print(hdr.yaw_deg, hdr.bias_dps)

The recursion is that of `gyrodrift/filters/hdr.py`, with the same parameters. A sample makes no list, tuple or string.
Ports whose floats are objects still take memory for each result. The yaw sum is compensated (Kahan 1965), so that ports
with floats of 32 bits do not lose the small angles of a slow turn.
"""

from time import ticks_diff

MOST_S = 1e15
MOST_DPS = 1e12
LEAST_STEP_S = 1e-12
"""Limits of times and rates."""

MICRO = 1e6


class Hdr:
    """State of the filter.

    yaw_deg, bias_dps
        Yaw, and the estimate of the bias.
    samples, rejected
        Samples accepted; samples rejected because time did not advance, or a value is not finite or out of its limits.
    """

    def __init__(
        self,
        i_c_dps: float = 0.0006,
        tau_s: float = 0.9447,
        theta_w_dps: float = 0.5608,
        c1: float = 0.7839,
        c2: float = 1.2161,
    ) -> None:
        self.i_c_dps, self.tau_s, self.theta_w_dps, self.c1, self.c2 = i_c_dps, tau_s, theta_w_dps, c1, c2
        self.yaw_deg = self.bias_dps = 0.0
        self.samples = self.rejected = 0
        self.t_s = self._lpf_dps = self._i_dps = self._omega_dps = self._lost_deg = 0.0
        self._ticks_us = self._sign_before = 0
        self._run = 1

    def update(self, t_s: float, rate_dps: float) -> bool:
        """Take a sample at a time in s, for ports with floats of 64 bits; False if it is rejected."""
        if not (-MOST_S <= t_s <= MOST_S and self._takes(t_s - self.t_s, rate_dps)):
            self.rejected += 1
            return False
        self._advance(t_s - self.t_s, rate_dps)
        self.t_s = t_s
        return True

    def update_us(self, ticks_us: int, rate_dps: float) -> bool:
        """Take a sample at a time of `time.ticks_us`, which wraps; False if it is rejected."""
        dt_s = ticks_diff(ticks_us, self._ticks_us) / MICRO
        if not self._takes(dt_s, rate_dps):
            self.rejected += 1
            return False
        self._advance(dt_s, rate_dps)
        self._ticks_us = ticks_us
        return True

    def _takes(self, dt_s: float, rate_dps: float) -> bool:
        return -MOST_DPS <= rate_dps <= MOST_DPS and (self.samples == 0 or dt_s >= LEAST_STEP_S)

    def _advance(self, dt_s: float, rate_dps: float) -> None:
        if self.samples == 0:
            self._lpf_dps = self._omega_dps = rate_dps
            self.samples = 1
            return
        before_dps, tau_s = self._omega_dps, self.tau_s
        sign = (before_dps > 0.0) - (before_dps < 0.0)
        self._run = self._run + 1 if self.samples >= 2 and sign == self._sign_before else 1
        if abs(before_dps) < self.theta_w_dps:
            self._i_dps -= sign * self._step_dps()
            self.bias_dps = 0.0 - self._i_dps
        self._lpf_dps = (rate_dps * dt_s + tau_s * self._lpf_dps) / (dt_s + tau_s)
        self._omega_dps = self._lpf_dps + self._i_dps
        self._turn((self._omega_dps + tau_s / dt_s * (self._omega_dps - before_dps)) * dt_s)
        self._sign_before = sign
        self.samples += 1

    def _step_dps(self) -> float:
        """Step of the integrator for the present run of equal signs, deg/s."""
        if self.c1 == 0.0:
            return self.i_c_dps
        try:
            steepness = float(self._run) ** self.c2
        except OverflowError:
            return 0.0
        return (1.0 + self.c1) / (1.0 + self.c1 * steepness) * self.i_c_dps

    def _turn(self, angle_deg: float) -> None:
        """Add an angle to yaw, and keep the part of it that the sum does not resolve."""
        angle_deg -= self._lost_deg
        yaw_deg = self.yaw_deg + angle_deg
        self._lost_deg = (yaw_deg - self.yaw_deg) - angle_deg
        self.yaw_deg = yaw_deg
