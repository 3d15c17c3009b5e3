"""Memory and temperature on three axes: a start in motion, a memory that is wrong, a bias that warms up."""

import json
from dataclasses import asdict

import numpy as np
import pytest
from hand_motion import hand_motion

from gyrodrift.filters.attitude.model import AttitudeState
from gyrodrift.filters.restlevel.memory import RestlevelMemory, begun, knowledge
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.filters.saved import restore, saved
from gyrodrift.values.arrays import Floats
from gyrodrift.values.mount import LEVEL, Mount
from gyrodrift.values.sample import Inertial

RATE_HZ = 50.0
BIAS_DPS = np.array((0.3, -0.2, 0.5))
PARAMS = RestlevelParams()


def fed(run: FilterRun, rates_dps: Floats, temp_c: Floats | None = None, seed: int = 1) -> FilterRun:
    """Samples of a level device with noise; rates have the shape (n, 3) and contain the bias."""
    rng = np.random.default_rng(seed)
    gyro_dps = rates_dps + rng.normal(0.0, 0.05, rates_dps.shape)
    accel_mps2 = rng.normal(0.0, 0.02, rates_dps.shape) + np.array((0.0, 0.0, 9.81))
    temps = np.full(len(gyro_dps), np.nan) if temp_c is None else temp_c
    first_s = run.state.t_s + 1.0 / RATE_HZ
    for n, (g, a, warm_c) in enumerate(zip(gyro_dps.tolist(), accel_mps2.tolist(), temps.tolist(), strict=True)):
        assert run.step(first_s + n / RATE_HZ, g[2], Inertial(*g, *a), np.nan, warm_c)
    return run


def rest(seconds: float, bias_dps: Floats = BIAS_DPS) -> Floats:
    return np.tile(bias_dps, (round(seconds * RATE_HZ), 1))


def swing(seconds: float, bias_dps: Floats = BIAS_DPS) -> Floats:
    """A level device that turns to and fro, from the first sample on."""
    rates_dps = rest(seconds, bias_dps)
    rates_dps[:, 2] += 40.0 * np.sin(0.3 + np.arange(len(rates_dps)) / RATE_HZ)
    return rates_dps


def new_run(mount: Mount = LEVEL) -> FilterRun:
    return FilterRun(RESTLEVEL, PARAMS, mount=mount)


def run_with(memory: RestlevelMemory, age_s: float = 3600.0, mount: Mount = LEVEL) -> FilterRun:
    run = new_run(mount)
    run.state = begun(PARAMS, memory, age_s, None)
    return run


def memory_of(run: FilterRun) -> RestlevelMemory:
    assert run.learner is not None
    memory = run.learner(None, 0.0)
    assert isinstance(memory, RestlevelMemory)
    return memory


@pytest.fixture(scope="module")
def memory() -> RestlevelMemory:
    return memory_of(fed(new_run(), rest(15.0)))


def biases_of(memory: RestlevelMemory) -> list[float]:
    z, x, y = (axis.bias_dps for axis in memory.axes)
    return [x, y, z]


def test_a_sure_rest_is_remembered_on_three_axes(memory: RestlevelMemory) -> None:
    """With standard deviations, and the same after its file."""
    assert biases_of(memory) == pytest.approx(BIAS_DPS, abs=0.02)
    assert all(0.0005 < axis.bias_sigma_dps < 0.02 for axis in memory.axes)
    assert knowledge(json.loads(json.dumps(asdict(memory)))) == memory


def test_a_start_in_motion_has_the_remembered_bias(memory: RestlevelMemory) -> None:
    run = fed(run_with(memory), swing(1.0))
    assert run.state.bias_xyz_dps == pytest.approx(BIAS_DPS, abs=0.03)
    assert run.state.bias_sigma_dps < 0.15
    assert abs(fed(new_run(), swing(1.0)).state.bias_dps) < 0.3


@pytest.mark.parametrize("change_dps", [(1.0, 1.0, 1.0), (0.0, 0.0, 1.0), (-0.6, 0.4, -1.0)])
def test_a_wrong_memory_is_given_up_at_the_first_rest(memory: RestlevelMemory, change_dps: tuple[float, ...]) -> None:
    """Another device: all axes differ, or the one about the vertical alone."""
    bias_dps = BIAS_DPS + change_dps
    run = fed(run_with(memory), rest(6.0, bias_dps))
    assert run.state.bias_xyz_dps == pytest.approx(bias_dps, abs=0.05)
    assert abs(run.state.yaw_deg) < 0.5


def test_a_wrong_memory_is_dropped_in_motion(memory: RestlevelMemory) -> None:
    """A hand tilts another device, which never rests: gravity shows that its biases are others."""
    motion, run = hand_motion(35.0, tilt_deg=25.0, bias_dps=(-0.7, 0.8, -0.5), rate_hz=RATE_HZ), run_with(memory)
    columns = (motion.t_s, motion.gyro_dps, motion.accel_mps2)
    for t_s, g, a in zip(*(column[350:].tolist() for column in columns), strict=True):
        run.step(t_s, g[2], Inertial(*g, *a))
        if t_s < 7.5:
            assert run.state.bias_dps > 0.3
    assert not run.state.remembers
    assert run.state.bias_xyz_dps == pytest.approx((-0.7, 0.8, -0.5), abs=0.3)


def test_a_run_without_a_sure_rest_is_not_remembered() -> None:
    run = fed(new_run(), swing(3.0))
    assert run.learner is not None
    assert run.learner(None, 0.0) is None


def test_a_memory_is_of_the_sensor_whatever_the_mount(memory: RestlevelMemory) -> None:
    """The device lies on its side: the mount says that y of the sensor points up."""
    mount = Mount(up="+y", forward="-z")
    run = fed(run_with(memory, mount=mount), rest(12.0))
    assert run.mount.to_sensor(run.state.bias_xyz_dps) == pytest.approx(BIAS_DPS, abs=0.02)
    start = run_with(memory, mount=mount)
    fed(start, rest(0.1))
    assert start.state.bias_xyz_dps == pytest.approx(mount.to_device((0.3, -0.2, 0.5)), abs=0.02)
    assert biases_of(memory_of(run)) == pytest.approx(BIAS_DPS, abs=0.02)


def test_a_recording_keeps_what_three_axes_begin_with(memory: RestlevelMemory) -> None:
    state, again = begun(PARAMS, memory, 60.0, None), RestlevelState()
    restore(again, json.loads(json.dumps(saved(state, RestlevelState()))))
    assert again == state
    assert again.level[1].remembered[0].bias_dps == memory.axes[2].bias_dps


def test_one_axis_begins_with_z_of_three(memory: RestlevelMemory) -> None:
    run = FilterRun(RESTLEVEL, PARAMS, "1")
    run.state = begun(PARAMS, memory, 60.0, None)
    fed(run, swing(1.0))
    assert run.three_axes is None
    assert run.state.bias_dps == pytest.approx(0.5, abs=0.03)
    assert len(memory_of(fed(run, rest(15.0))).axes) == 1


def test_biases_follow_the_temperature_in_motion() -> None:
    """Rests at two temperatures show the slopes; then the device warms up by 10 °C while it moves."""
    slopes_dps_c = np.array((0.01, -0.02, 0.02))
    moves = np.concatenate([*[np.concatenate([np.zeros(600), np.ones(100)])] * 2, np.ones(500)])
    temp_c = np.concatenate([20.0 + 8.0 * np.arange(1400) / 1400.0, 28.0 + np.minimum(10.0, np.arange(500) / 40.0)])
    rates_dps = BIAS_DPS + slopes_dps_c * (temp_c - 20.0)[:, None]
    rates_dps[:, 2] += moves * 40.0 * np.sin(np.arange(len(moves)) / 20.0)
    state = fed(new_run(), rates_dps, temp_c).state
    assert isinstance(state, AttitudeState)
    assert [axis.line.slope_dps_c for axis in state.axes] == pytest.approx(slopes_dps_c, abs=0.01)
    z = state.axes[2]
    assert state.bias_dps - z.sure.bias_dps == pytest.approx(z.line.slope_dps_c * (38.0 - z.sure.temp_c), abs=0.03)
    assert state.bias_dps - z.sure.bias_dps > 0.08
    curve = state.temp_curve
    assert curve is not None
    assert curve["slope_dps_c"] == pytest.approx(z.line.slope_dps_c, abs=1e-3)
    assert AttitudeState().temp_curve is None
