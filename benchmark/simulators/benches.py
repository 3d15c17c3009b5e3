"""A turntable and a robot in MuJoCo, and a turntable in Bullet: rates of their gyros and angles of their joints."""

from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from simulators.flaws import Floats
from simulators.motions import commanded_dps

HERE = Path(__file__).parent
RATE_HZ = 50.0
SUBSTEPS = 10
"""Steps of 2 ms per sample; both models state them."""

PLATE_RAMP_S, ROVER_RAMP_S = 0.05, 0.4
"""Duration of a change of the rate; wheels that are accelerated more quickly slip by several degrees."""

WHEEL_M, HALF_TRACK_M = 0.05, 0.1
"""Radius of the wheels of rover.xml, and their distance from its middle."""

Callback = Callable[[float, float], float]
"""Rate that a gyro reads, deg/s, from the true one and the time, s."""


def turntable(seconds: float, seed: int, gyro: Callback | None = None) -> tuple[Floats, Floats]:
    """Rate, deg/s, and angle of the joint, deg, at RATE_HZ, shape (n,): a plate with a velocity servo."""
    values = _mujoco("turntable.xml", np.radians(commanded_dps(seconds, RATE_HZ, seed, PLATE_RAMP_S))[:, None], gyro)
    return np.degrees(values[:, 2]), np.degrees(values[:, 3])


def rover(seconds: float, seed: int, gyro: Callback | None = None) -> tuple[Floats, Floats]:
    """Rate and angle of a robot that drives on two wheels; the angle is that of its wheels, which slip a little."""
    turn = np.radians(commanded_dps(seconds, RATE_HZ, seed, ROVER_RAMP_S)) * HALF_TRACK_M
    forward = 0.15 * np.sin(2.0 * np.pi * 0.05 * np.arange(len(turn)) / RATE_HZ) * (turn != 0.0)
    values = _mujoco("rover.xml", np.stack([forward - turn, forward + turn], axis=1) / WHEEL_M, gyro)
    angle = (values[:, 4] - values[:, 3]) * WHEEL_M / (2.0 * HALF_TRACK_M)
    return np.degrees(values[:, 2]), np.degrees(angle)


def _mujoco(name: str, controls: Floats, gyro: Callback | None) -> Floats:
    """Sensor values at each sample, shape (n, sensors); the callback changes the third one, a rate about z."""
    import mujoco  # noqa: PLC0415 - an extra

    model: Any = mujoco.MjModel.from_xml_path(str(HERE / name))
    state: Any = mujoco.MjData(model)
    values = np.empty((len(controls), model.nsensordata))
    for index, control in enumerate(controls):
        state.ctrl[:] = control
        for _ in range(SUBSTEPS):
            mujoco.mj_step(model, state)
        mujoco.mj_forward(model, state)
        values[index] = state.sensordata
        if gyro is not None:
            values[index, 2] = np.radians(gyro(float(np.degrees(values[index, 2])), index / RATE_HZ))
    return values


def bullet(seconds: float, seed: int, gyro: Callback | None = None) -> tuple[Floats, Floats]:
    """Turntable in Bullet, which has no gyro: the rate is the change of the plate's orientation over a step."""
    import pybullet  # noqa: PLC0415 - no requirement

    client = pybullet.connect(pybullet.DIRECT)
    try:
        keep = pybullet.URDF_USE_INERTIA_FROM_FILE
        plate = pybullet.loadURDF(str(HERE / "turntable.urdf"), useFixedBase=True, flags=keep, physicsClientId=client)
        pybullet.setTimeStep(1.0 / RATE_HZ / SUBSTEPS, physicsClientId=client)
        values = []
        for index, target in enumerate(np.radians(commanded_dps(seconds, RATE_HZ, seed, PLATE_RAMP_S)).tolist()):
            pybullet.setJointMotorControl2(
                plate, 0, pybullet.VELOCITY_CONTROL, targetVelocity=target, force=2.0, physicsClientId=client
            )
            for _ in range(SUBSTEPS):
                pybullet.stepSimulation(physicsClientId=client)
            angle, rate, *_ = pybullet.getJointState(plate, 0, physicsClientId=client)
            read = np.degrees(rate)
            values.append((read if gyro is None else gyro(read, index / RATE_HZ), np.degrees(angle)))
    finally:
        pybullet.disconnect(client)
    rates, angles = np.array(values).T
    return rates, angles


PACKAGES = {"turntable": "mujoco", "rover": "mujoco", "bullet": "pybullet"}
"""Package of each bench; pybullet has wheels for few machines."""


def is_installed(bench: str) -> bool:
    """Whether the simulator of a bench is there."""
    return find_spec(PACKAGES[bench]) is not None


BENCHES = {"turntable": turntable, "rover": rover, "bullet": bullet}
