"""Prediction over a block against a plain second version: scipy rotations, and differences for the derivatives."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from gyrodrift.filters.attitude.block import Integrals, add_sample, integrals, next_block
from gyrodrift.filters.attitude.hypotheses import (
    ATTITUDE,
    BIAS,
    FORCE_BIAS,
    HEADING,
    SCALE,
    STATES,
    VELOCITY,
    Hypotheses,
    first_hypothesis,
)
from gyrodrift.filters.attitude.predict import GRAVITY, predict, process_noise, transitions
from gyrodrift.values.arrays import Floats

MOVING = np.zeros(1, dtype=np.bool_)
DT, SAMPLES = 0.005, 20
TIMES = np.arange(SAMPLES) * DT
RATES_DPS = np.column_stack((60.0 + 300.0 * TIMES, 40.0 * np.sin(9.0 * TIMES), -80.0 + 0.0 * TIMES))
FORCES = np.column_stack((1.0 + 5.0 * TIMES, -2.0 + 0.0 * TIMES, 9.0 + 3.0 * np.cos(7.0 * TIMES)))
BIAS_DPS = np.array((0.5, -0.8, 0.3))
MATRIX = np.array(((0.01, 0.002, -0.003), (0.001, -0.008, 0.002), (0.004, -0.001, 0.006)))


def block_of(bias: Floats, scale: Floats) -> Integrals:
    """The block of the filter, corrected by this bias (rad/s) and scale."""
    block = next_block(bias, scale)
    for rate, force in zip(RATES_DPS.tolist(), FORCES.tolist(), strict=True):
        add_sample(block, DT, *rate, *force)
    return integrals(block)


def integrated(error: Floats) -> tuple[Rotation, Floats]:
    """Attitude and velocity at the end of the block, sample by sample, from states that are off by `error` (21)."""
    attitude = Rotation.from_rotvec(error[ATTITUDE]) * START
    velocity = error[VELOCITY].copy()
    matrix = np.eye(3) + MATRIX + error[SCALE].reshape(3, 3)
    for rate, force in zip(np.radians(RATES_DPS), FORCES, strict=True):
        turn = Rotation.from_rotvec(matrix @ (rate - np.radians(BIAS_DPS) - error[BIAS]) * DT)
        middle = attitude * Rotation.from_rotvec(0.5 * turn.as_rotvec())
        velocity += (middle.apply(force - error[FORCE_BIAS]) - (0.0, 0.0, GRAVITY)) * DT
        attitude = attitude * turn
    return attitude, velocity


START = Rotation.from_euler("ZYX", (40.0, 25.0, -50.0), degrees=True)


def hypothesis(bias: Floats, scale: Floats) -> Hypotheses:
    h = first_hypothesis()
    h.q = START.as_quat(scalar_first=True)[None, :]
    h.bias, h.scale = bias[None, :], scale[None, :, :]
    return h


def test_a_block_turns_attitude_and_velocity_as_sample_by_sample() -> None:
    bias = np.radians(BIAS_DPS)
    h, block = hypothesis(bias, MATRIX), block_of(bias, MATRIX)
    predict(h, block, 0.0, 0.0, MOVING)
    attitude, velocity = integrated(np.zeros(STATES))
    turn = (Rotation.from_quat(h.q[0], scalar_first=True) * attitude.inv()).as_rotvec()
    assert turn == pytest.approx(np.zeros(3), abs=1e-7)
    assert h.velocity[0] == pytest.approx(velocity, abs=2e-4)


@pytest.mark.parametrize(("bias_dps", "scale"), [(2.0, 0.0), (0.0, 0.01), (0.2, 0.001)])
def test_a_hypothesis_with_another_bias_corrects_the_block_by_its_derivatives(bias_dps: float, scale: float) -> None:
    """Bias and scale of a hypothesis differ from those of the block: the error is of second order."""
    off_bias, off_scale = np.radians(BIAS_DPS + bias_dps), MATRIX + scale
    first, second = hypothesis(np.radians(BIAS_DPS), MATRIX), hypothesis(off_bias, off_scale)
    h, block = first.joined(second), block_of(np.radians(BIAS_DPS), MATRIX)
    predict(h, block, 0.0, 0.0, np.zeros(2, dtype=np.bool_))
    error = np.zeros(STATES)
    error[BIAS], error[SCALE] = np.radians(bias_dps), scale
    attitude, _ = integrated(error)
    turn = (Rotation.from_quat(h.q[1], scalar_first=True) * attitude.inv()).as_rotvec()
    assert turn == pytest.approx(np.zeros(3), abs=2e-5)


def difference_quotients(ends: Callable[[Floats], tuple[Rotation, Floats]]) -> Floats:
    """Derivatives (6, 21) of attitude and velocity by all states."""
    columns, step = [], 1e-5
    for state in range(STATES):
        off = np.zeros(STATES)
        off[state] = step
        (above, faster), (below, slower) = ends(off), ends(-off)
        columns.append(np.concatenate(((above * below.inv()).as_rotvec(), faster - slower)) / (2.0 * step))
    return np.array(columns).T


def test_the_transition_has_the_derivatives_of_the_motion() -> None:
    """Velocity depends on the attitude through its vertical part alone; that part is checked against all of it."""
    block = block_of(np.radians(BIAS_DPS), MATRIX)
    start = START.as_matrix()[None, :, :]
    velocity = (start @ block.velocity[:, None])[:, :, 0]
    transition = transitions(start, velocity, block)[0]
    true = difference_quotients(integrated)
    assert transition[ATTITUDE] == pytest.approx(true[:3], abs=2e-3)
    assert transition[VELOCITY, FORCE_BIAS] == pytest.approx(true[3:, FORCE_BIAS], abs=1e-4)
    vertical = velocity[0, 2]
    assert transition[VELOCITY, ATTITUDE] == pytest.approx(
        np.array(((0.0, vertical, 0.0), (-vertical, 0.0, 0.0), (0.0, 0.0, 0.0))), abs=1e-12
    )
    assert np.abs(transition[VELOCITY, ATTITUDE] - true[3:, ATTITUDE])[:2, :2].max() < 1e-3


def test_a_prediction_propagates_the_covariance() -> None:
    rng = np.random.default_rng(5)
    root = rng.normal(size=(STATES, STATES))
    bias = np.radians(BIAS_DPS)
    h, block = hypothesis(bias, MATRIX), block_of(bias, MATRIX)
    h.cov = (root @ root.T)[None, :, :]
    before = h.cov[0].copy()
    start = START.as_matrix()[None, :, :]
    transition = transitions(start, (start @ block.velocity[:, None])[:, :, 0], block)[0]
    predict(h, block, 1e-6, 1e-7, MOVING)
    expected = transition @ before @ transition.T + np.diag(process_noise(block, 1e-6, 1e-7))
    assert h.cov[0] == pytest.approx(expected)


def test_a_hypothesis_that_stands_still_keeps_its_heading() -> None:
    """Tilt follows the block; heading and its covariance with the bias stay."""
    bias = np.radians(BIAS_DPS)
    h, block = hypothesis(bias, MATRIX), block_of(bias, MATRIX)
    h.cov[0] = np.diag(np.linspace(1.0, 2.0, STATES))
    predict(h, block, 1e-6, 1e-7, np.ones(1, dtype=np.bool_))
    turn = (Rotation.from_quat(h.q[0], scalar_first=True) * START.inv()).as_rotvec()
    assert abs(turn[2]) < 0.02 < np.abs(turn[:2]).max()
    assert h.cov[0, HEADING, HEADING] == pytest.approx(np.linspace(1.0, 2.0, STATES)[HEADING])
    assert h.cov[0, HEADING, BIAS] == pytest.approx(np.zeros(3))
