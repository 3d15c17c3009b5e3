"""Benches in Drake: a servo table, a torso with a swinging leg, and a gimbal whose mass is off its axis.

A bench takes commanded rates at STEP_S, deg/s, the sample rate, Hz, and a generator. It returns rates of the gyro,
deg/s, and angles of the reference, deg. Masses, kg, inertias, kg m², and gains were chosen here, as of desktop devices.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from simulators.flaws import Floats, Rng
from simulators.unseen.drive import STEP_S, LimitedPid, steps_per_sample, to_rate_and_angle

Torques = Callable[[int, Floats, Floats], Floats]
"""Torques of the motors, N m, from the number of the step, the angles of the joints, rad, and their rates, rad/s."""

Reading = Callable[[Any], tuple[float, float]]
"""Rate, rad/s, and angle, rad, from the context of a plant."""


def table(u_dps: Floats, rate_hz: float, rng: Rng) -> tuple[Floats, Floats]:
    """Plate on a vertical shaft with Coulomb friction. Rate and angle agree to half a step, 1.25 ms."""
    u_rad_s = np.radians(u_dps)
    targets_rad = np.cumsum(u_rad_s) * STEP_S
    plant = _shaft("plate", _inertia(2.0, [0, 0, 0], (0.011, 0.011, 0.02)), damping=0.01, lean_deg=0.0)
    servo = LimitedPid(40.0, 1.2, 60.0, limit_nm=0.6)

    def torques(step: int, angles: Floats, rates: Floats) -> Floats:
        driven_nm = servo.torque_nm(targets_rad[step] - angles[0], u_rad_s[step] - rates[0])
        return np.array([driven_nm - 0.02 * np.tanh(rates[0] / 0.02)])

    def read(context: Any) -> tuple[float, float]:
        angle_rad, rate_rad_s = plant.GetPositionsAndVelocities(context)
        return rate_rad_s, angle_rad

    return _driven(plant, torques, read, len(u_dps), rate_hz)


def gimbal(u_dps: Floats, rate_hz: float, rng: Rng) -> tuple[Floats, Floats]:
    """Ring on an axis that leans by 8 degrees, pulled by gravity. The rate is older by a step: 3.75 ms late."""
    u_rad_s = np.radians(u_dps)
    targets_rad = np.cumsum(u_rad_s) * STEP_S
    plant = _shaft("ring", _inertia(1.2, [0.04, 0, 0], (0.006, 0.006, 0.009)), damping=0.02, lean_deg=8.0)
    servo, before = LimitedPid(6.0, 0.3, 15.0, limit_nm=0.5), [0.0]

    def torques(step: int, angles: Floats, rates: Floats) -> Floats:
        before[0] = rates[0]
        return np.array([servo.torque_nm(targets_rad[step] - angles[0], u_rad_s[step] - rates[0])])

    def read(context: Any) -> tuple[float, float]:
        return before[0], plant.GetPositions(context)[0]

    return _driven(plant, torques, read, len(u_dps), rate_hz)


def torso(u_dps: Floats, rate_hz: float, rng: Rng) -> tuple[Floats, Floats]:
    """Torso on feet that turn; a leg swings, and the torso pitches by up to 2 degrees in time with the gait.

    The gyro reads the rate about the torso's own z axis, and the reference is the yaw of motion capture. Both agree to
    half a step, 1.25 ms, and to the cosine of the pitch, 0.06 %.
    """
    u_rad_s = np.radians(u_dps)
    still = np.zeros_like(u_rad_s)
    targets_rad = np.stack([np.cumsum(u_rad_s) * STEP_S, *_gait(u_rad_s, rng)], axis=1)
    targets_rad_s = np.stack([u_rad_s, still, still], axis=1)
    stiffness, damping = np.array([90.0, 80.0, 14.0]), np.array([9.0, 4.0, 0.5])
    limits_nm = np.array([8.0, 12.0, 4.0])
    plant, body = _torso()

    def torques(step: int, angles: Floats, rates: Floats) -> Floats:
        unlimited_nm = stiffness * (targets_rad[step] - angles) + damping * (targets_rad_s[step] - rates)
        limited: Floats = np.clip(unlimited_nm, -limits_nm, limits_nm)
        return limited

    return _driven(plant, torques, _MotionCapture(plant, body).read, len(u_dps), rate_hz)


def _gait(u_rad_s: Floats, rng: Rng) -> tuple[Floats, Floats]:
    """Pitch and angle of the hip, rad: they fade in and out with the turn."""
    t_s = np.arange(len(u_rad_s)) * STEP_S
    moves = np.convolve(np.abs(u_rad_s), np.ones(161) / 161, "same")
    share = np.convolve(np.abs(moves) > np.radians(0.5), np.hanning(161) / np.hanning(161).sum(), "same")
    gait_hz, phase = rng.uniform(1.5, 2.4), rng.uniform(0, 6.28)
    hip = np.radians(14.0) * share * np.sin(2 * np.pi * gait_hz * t_s + phase)
    pitch = np.radians(2.0) * share * np.sin(2 * np.pi * 2 * gait_hz * t_s + 2 * phase)
    return pitch, hip


@dataclass(slots=True)
class _MotionCapture:
    """Rate about the z axis of a body, and its yaw without jumps."""

    plant: Any
    body: Any
    last_rad: float = 0.0
    turns: int = 0

    def read(self, context: Any) -> tuple[float, float]:
        axes = self.plant.EvalBodyPoseInWorld(context, self.body).rotation().matrix()
        spin = self.plant.EvalBodySpatialVelocityInWorld(context, self.body).rotational()
        yaw_rad = np.arctan2(axes[1, 0], axes[0, 0])
        self.turns -= round((yaw_rad - self.last_rad) / (2 * np.pi))
        self.last_rad = yaw_rad
        return axes[:, 2] @ spin, yaw_rad + 2 * np.pi * self.turns


def _shaft(name: str, inertia: Any, damping: float, lean_deg: float) -> Any:
    """Plant of a body on a driven axis that leans."""
    from pydrake.math import RigidTransform, RollPitchYaw  # noqa: PLC0415 - no requirement
    from pydrake.multibody.plant import MultibodyPlant  # noqa: PLC0415
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint  # noqa: PLC0415

    plant = MultibodyPlant(time_step=STEP_S)
    body, base = plant.AddRigidBody(name, inertia), plant.world_frame()
    if lean_deg:
        lean = RigidTransform(RollPitchYaw(0.0, np.radians(lean_deg), 0.0), [0, 0, 0])
        base = plant.AddFrame(FixedOffsetFrame("lean", base, lean))
    joint = plant.AddJoint(RevoluteJoint("axis", base, body.body_frame(), [0, 0, 1], damping))
    plant.AddJointActuator("motor", joint)
    plant.Finalize()
    return plant


def _torso() -> tuple[Any, Any]:
    """Plant of feet, torso and leg, with driven yaw, pitch and hip, and the body of the torso."""
    from pydrake.math import RigidTransform  # noqa: PLC0415 - no requirement
    from pydrake.multibody.plant import MultibodyPlant  # noqa: PLC0415
    from pydrake.multibody.tree import FixedOffsetFrame, RevoluteJoint  # noqa: PLC0415

    plant = MultibodyPlant(time_step=STEP_S)
    feet = plant.AddRigidBody("feet", _inertia(0.5, [0, 0, 0], (0.01, 0.01, 0.01)))
    body = plant.AddRigidBody("torso", _inertia(6.0, [0, 0, 0], (0.05, 0.12, 0.15)))
    leg = plant.AddRigidBody("leg", _inertia(0.7, [0.12, 0, 0], (0.001, 0.004, 0.004)))
    mount = plant.AddFrame(FixedOffsetFrame("mount", body.body_frame(), RigidTransform([0.2, 0.1, -0.02])))
    joints = (
        ("yaw", plant.world_frame(), feet, [0, 0, 1], 0.05),
        ("pitch", feet.body_frame(), body, [0, 1, 0], 0.1),
        ("hip", mount, leg, [0, 0, 1], 0.02),
    )
    for name, parent, child, axis, damping in joints:
        joint = plant.AddJoint(RevoluteJoint(name, parent, child.body_frame(), axis, damping))
        plant.AddJointActuator(name, joint)
    plant.Finalize()
    return plant, body


def _inertia(mass_kg: float, center_m: list[float], moments: tuple[float, float, float]) -> Any:
    from pydrake.multibody.tree import RotationalInertia, SpatialInertia  # noqa: PLC0415 - no requirement

    return SpatialInertia.MakeFromCentralInertia(mass_kg, center_m, RotationalInertia(*moments))


def _driven(plant: Any, torques: Torques, read: Reading, steps: int, rate_hz: float) -> tuple[Floats, Floats]:
    """Samples of a plant whose motors get new torques at each step."""
    from pydrake.systems.analysis import Simulator  # noqa: PLC0415 - no requirement

    simulator = Simulator(plant)
    context, motors = simulator.get_mutable_context(), plant.get_actuation_input_port()
    motors.FixValue(context, np.zeros(plant.num_actuators()))
    simulator.Initialize()
    samples, joints = [], plant.num_positions()
    for step in range(steps):
        if step % steps_per_sample(rate_hz) == 0:
            samples.append(read(context))
        state = plant.GetPositionsAndVelocities(context)
        motors.FixValue(context, torques(step, state[:joints], state[joints:]))
        simulator.AdvanceTo((step + 1) * STEP_S)
    return to_rate_and_angle(samples)
