"""Benches in pymunk, a simulator of flat bodies: a rover seen from above, and a load on a springy shaft.

A bench takes and returns what those in drake_benches.py do. Masses, kg, inertias, kg m², and gains were chosen here.
"""

from dataclasses import dataclass, field
from typing import Any

import numpy as np

from simulators.flaws import Floats, Rng
from simulators.unseen.drive import STEP_S, steps_per_sample, to_rate_and_angle

WHEEL_M, HALF_TRACK_M = 0.035, 0.09
"""Radius of the wheels of the rover, and their distance from its middle."""

GRIP_N, SLIP_M_S = 4.0, 0.03
"""Largest force of a tire, and the slip at which it has three quarters of that: tanh(1)."""

SPIN_KG_M2 = 1e-3
"""Inertia of a wheel with its motor."""


def rover(u_dps: Floats, rate_hz: float, rng: Rng) -> tuple[Floats, Floats]:
    """Two wheels with slip curves and a caster that scrubs.

    The rate is that before the last step, and the body follows its wheels: 15 ms late at most. The angle is that of the
    wheels, which slip by less than 1 % of the way.
    """
    import pymunk  # noqa: PLC0415 - an extra

    space, body = pymunk.Space(), pymunk.Body(2.0, 0.022)
    space.add(body, pymunk.Poly.create_box(body, (0.25, 0.18)))
    wheels, samples, rate_before = _Wheels(body), [], 0.0
    for step, commanded in enumerate(_wheel_rates(np.radians(u_dps), rng)):
        if step % steps_per_sample(rate_hz) == 0:
            samples.append((rate_before, wheels.yaw_rad()))
        rate_before = body.angular_velocity
        wheels.push(commanded)
        _scrub(body)
        space.step(STEP_S)
        wheels.count()
    return to_rate_and_angle(samples)


def _wheel_rates(u_rad_s: Floats, rng: Rng) -> Floats:
    """Commanded rates of the left and the right wheel, rad/s, shape (n, 2); the rover drives to and fro as it turns."""
    t_s = np.arange(len(u_rad_s)) * STEP_S
    to_and_fro_hz, phase = rng.uniform(0.03, 0.08), rng.uniform(0, 6.28)
    moves = np.convolve(np.abs(u_rad_s) > np.radians(0.3), np.hanning(401) / np.hanning(401).sum(), "same")
    forward = 0.18 * moves * np.sin(2 * np.pi * to_and_fro_hz * t_s + phase)
    rates: Floats = np.stack([forward - u_rad_s * HALF_TRACK_M, forward + u_rad_s * HALF_TRACK_M], axis=1) / WHEEL_M
    return rates


@dataclass(slots=True)
class _Wheels:
    """The left and the right wheel of a body: rates, rad/s, angles, rad, and integrals of their PI, rad."""

    body: Any
    rates: list[float] = field(default_factory=lambda: [0.0, 0.0])
    angles: list[float] = field(default_factory=lambda: [0.0, 0.0])
    integrals: list[float] = field(default_factory=lambda: [0.0, 0.0])

    def push(self, commanded: Floats) -> None:
        """Forces of the tires over the next step, and the rates of the wheels after it."""
        turn_rad_s, velocity = self.body.angular_velocity, self.body.velocity.rotated(-self.body.angle)
        for side, left_m in ((0, HALF_TRACK_M), (1, -HALF_TRACK_M)):
            along = velocity.x - turn_rad_s * left_m
            along_n = GRIP_N * np.tanh((self.rates[side] * WHEEL_M - along) / SLIP_M_S)
            across_n = -GRIP_N * np.tanh(velocity.y / SLIP_M_S)
            self.body.apply_force_at_local_point((along_n, across_n), (0.0, left_m))
            self.rates[side] += STEP_S * self._torque_nm(side, commanded[side], along_n) / SPIN_KG_M2

    def _torque_nm(self, side: int, commanded: float, along_n: float) -> float:
        """PI with a limit of 0.2 N m, less the tire's force and friction."""
        error = commanded - self.rates[side]
        self.integrals[side] += error * STEP_S
        motor_nm = min(max(0.03 * error + 0.25 * self.integrals[side], -0.2), 0.2)
        return motor_nm - along_n * WHEEL_M - 2e-4 * self.rates[side]

    def count(self) -> None:
        """Turn the wheels over a step."""
        for side in (0, 1):
            self.angles[side] += self.rates[side] * STEP_S

    def yaw_rad(self) -> float:
        """Yaw by odometry."""
        return (self.angles[1] - self.angles[0]) * WHEEL_M / (2 * HALF_TRACK_M)


def _scrub(body: Any) -> None:
    """Force of 0.25 N of a caster 0.1 m behind, against its motion. The velocity is that before the tires push."""
    velocity = body.velocity.rotated(-body.angle)
    along, across = velocity.x, velocity.y - body.angular_velocity * 0.1
    speed = np.hypot(along, across)
    if speed > 1e-9:
        drag = -0.25 * np.tanh(speed / 0.03) / speed
        body.apply_force_at_local_point((drag * along, drag * across), (-0.1, 0.0))


def shaft(u_dps: Floats, rate_hz: float, rng: Rng) -> tuple[Floats, Floats]:
    """Motor and load on a spring with a resonance at 12 Hz. The gyro is on the load and the encoder on the motor.

    Both agree to half a step, 1.25 ms, and to the twist of the spring, below 0.25 deg.
    """
    import pymunk  # noqa: PLC0415 - an extra

    space = pymunk.Space()
    space.iterations = 20
    motor, load = pymunk.Body(0.5, 0.004), pymunk.Body(1.0, 0.01)
    for body, x_m in ((motor, 0.0), (load, 5.0)):
        body.position = (x_m, 0.0)
        space.add(body, pymunk.PivotJoint(space.static_body, body, (x_m, 0.0)))
    stiffness = 0.01 * (2 * np.pi * 12.0) ** 2
    space.add(pymunk.DampedRotarySpring(motor, load, 0.0, stiffness, 2 * 0.06 * np.sqrt(stiffness * 0.01)))
    drive = pymunk.SimpleMotor(motor, space.static_body, 0.0)
    drive.max_force = 0.5
    space.add(drive)
    samples = []
    for step, rate_rad_s in enumerate(np.radians(u_dps).tolist()):
        if step % steps_per_sample(rate_hz) == 0:
            samples.append((load.angular_velocity, motor.angle))
        drive.rate = rate_rad_s
        space.step(STEP_S)
    return to_rate_and_angle(samples)
