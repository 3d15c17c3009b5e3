"""Checks of accelerations in recordings and streams: unit, gravity, direction and axes."""

from dataclasses import replace
from itertools import permutations, product
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from support import quick

from gyrodrift.columns.gravity_check import LENGTHS, AccelerationCheck
from gyrodrift.facts.reference import vertical_rates_dps
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.checks.examine import acceleration_findings, axis_findings
from gyrodrift.session.checks.rate_unit import rate_findings
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.sample import Inertial, Sample

ALL_AXES = [(order, signs) for order in permutations(range(3)) for signs in product((1.0, -1.0), repeat=3)]
SIGNS = {"+": 1.0, "-": -1.0}
RATE_HZ, SECONDS, G_MPS2 = 100.0, 40.0, 9.80665


def waved(*, tilt_deg: float = 40.0, shake_mps2: float = 0.0, seed: int = 3) -> Session:
    """A sensor that is waved by hand: a smooth attitude with its rates and forces, and noise."""
    rng = np.random.default_rng(seed)
    t_s = np.arange(0.0, SECONDS, 1.0 / RATE_HZ)
    phases = rng.uniform(0.0, 2.0 * np.pi, (3, 3))
    reach = np.array([1.0, tilt_deg / 60.0, tilt_deg / 60.0])
    angles = sum(np.sin(2.0 * np.pi * (0.13 + 0.11 * k) * t_s[:, None] + phases[k]) * reach for k in range(3))
    attitude = Rotation.from_euler("ZYX", angles)
    body_rates = (attitude[:-1].inv() * attitude[1:]).as_rotvec() * RATE_HZ
    gyro_dps = np.degrees(np.vstack([body_rates, body_rates[-1:]])) + 0.5 + 0.1 * rng.standard_normal((len(t_s), 3))
    shaken = np.array([0.0, 0.0, G_MPS2]) + shake_mps2 * rng.standard_normal((len(t_s), 3))
    forces: Floats = attitude.inv().apply(shaken) + 0.05 * rng.standard_normal((len(t_s), 3))
    return Session("waved", t_s, gyro_dps[:, 2], gyro_dps=gyro_dps, accel_mps2=forces)


def with_forces(session: Session, forces: Floats) -> Session:
    return Session(session.name, session.t_device_s, session.rate_dps, gyro_dps=session.gyro_dps, accel_mps2=forces)


@pytest.mark.parametrize("seed", range(5))
def test_right_axes_are_no_finding(seed: int) -> None:
    assert not list(axis_findings(SessionFacts(waved(seed=seed))))
    assert not list(axis_findings(SessionFacts(waved(seed=seed, shake_mps2=3.0))))


@pytest.mark.parametrize("seed", quick(range(3), 0))
@pytest.mark.parametrize("index", range(48))
def test_swapped_and_inverted_axes_are_named_with_the_order_that_mends_them(seed: int, index: int) -> None:
    session, (order, signs) = waved(seed=seed), ALL_AXES[index]
    assert session.accel_mps2 is not None
    wrong_forces = session.accel_mps2[:, order] * np.array(signs)
    findings = list(axis_findings(SessionFacts(with_forces(session, wrong_forces))))
    is_right = order == (0, 1, 2) and len(set(signs)) == 1
    assert len(findings) == (not is_right)
    if findings:
        axes = SessionFacts(with_forces(session, wrong_forces)).axes_agreement
        assert axes is not None
        assert axes.spec in findings[0].do
        columns = [SIGNS[name[0]] * wrong_forces[:, "xyz".index(name[1])] for name in axes.best]
        mended = np.column_stack(columns)
        assert np.array_equal(mended, session.accel_mps2) or np.array_equal(mended, -session.accel_mps2)
        assert np.array_equal(read_as(axes.spec, wrong_forces), mended)


def read_as(spec: str, columns: Floats) -> Floats:
    """Accelerations as read with these names of the columns, such as `ay:-, ax, az`."""
    forces = np.empty_like(columns)
    for index, name in enumerate(spec.split(", ")):
        forces[:, "xyz".index(name[1])] = columns[:, index] * (-1.0 if name.endswith(":-") else 1.0)
    return forces


def test_a_level_turn_says_nothing_of_the_axes() -> None:
    session = waved(tilt_deg=0.0)
    assert session.accel_mps2 is not None
    assert not list(axis_findings(SessionFacts(with_forces(session, session.accel_mps2[:, [1, 0, 2]]))))


def test_accelerations_of_a_car_say_nothing_of_the_axes() -> None:
    session, rng = waved(), np.random.default_rng(5)
    jolts = np.repeat(rng.normal(0.0, 8.0, (200, 3)), 20, axis=0)
    assert session.accel_mps2 is not None
    assert not list(axis_findings(SessionFacts(with_forces(session, session.accel_mps2[:, [1, 0, 2]] + jolts))))


def test_a_sensor_that_measures_gravity_downward_is_told() -> None:
    session = waved(tilt_deg=10.0)
    assert session.accel_mps2 is not None
    (finding,) = acceleration_findings(SessionFacts(with_forces(session, -session.accel_mps2)), is_stated=False)
    assert finding.id == "accel_sign"
    assert not finding.is_error
    assert not list(acceleration_findings(SessionFacts(session), is_stated=False))


@pytest.mark.parametrize("forces", [np.full((40, 3), np.nan), np.zeros((40, 3))])
def test_missing_and_zero_accelerations_do_not_stop_the_checks(forces: Floats) -> None:
    session = Session("s", np.arange(40.0), np.ones(40), gyro_dps=np.ones((40, 3)), accel_mps2=forces)
    assert not list(axis_findings(SessionFacts(session)))
    assert {finding.id for finding in acceleration_findings(SessionFacts(session), is_stated=False)} <= {
        "accel_gravity"
    }


def events_of(force: tuple[float, float, float], protocol: str = "csv") -> list[dict[str, Any]]:
    check = AccelerationCheck(protocol)
    inertial = Inertial(0.0, 0.0, 1.0, *force)
    samples = [Sample(i, 0.01 * i, 0.0, 1.0, inertial=inertial) for i in range(10)]
    fields = [check.take(samples) for _ in range(2 * LENGTHS // 10)]
    return [event for event in fields if event is not None]


def test_a_stream_in_g_is_told_once_with_the_columns_that_read_it() -> None:
    (fields,) = events_of((0.0, 0.1, 0.99))
    assert fields["unit"] == "g"
    assert "--columns 't_us, gx, gy, gz, ax:g, ay:g, az:g'" in fields["hint"]


def test_a_stream_without_gravity_is_told() -> None:
    (fields,) = events_of((0.1, 0.0, 0.1))
    assert (fields["unit"], "linear acceleration" in fields["hint"]) == ("unknown", True)


@pytest.mark.parametrize("force", [(0.3, 0.2, 9.7), (float("nan"),) * 3])
def test_a_stream_in_its_unit_and_a_missing_acceleration_are_no_event(force: tuple[float, float, float]) -> None:
    assert not events_of(force)


def test_the_rate_about_the_vertical_is_compared_with_the_encoder_of_a_tilted_device() -> None:
    """A turntable that leans by 45°: the rate about z alone is too small by a third."""
    t_s: Floats = np.linspace(0.0, 60.0, 6000, endpoint=False)
    heading_dps = 60.0 * np.sin(0.5 * t_s)
    tilt = np.radians(45.0)
    up = np.array([np.sin(tilt), 0.0, np.cos(tilt)])
    session = Session(
        "leaning",
        t_s,
        heading_dps * up[2],
        encoder_deg=np.cumsum(heading_dps) * 0.01,
        gyro_dps=heading_dps[:, None] * up,
        accel_mps2=np.tile(G_MPS2 * up, (len(t_s), 1)),
    )
    assert rate_findings(SessionFacts(session), is_stated=False) == []
    assert vertical_rates_dps(session) == pytest.approx(heading_dps)
    (finding,) = rate_findings(SessionFacts(replace(session, gyro_dps=None, accel_mps2=None)), is_stated=False)
    assert finding.id == "rate_unit"


def test_without_accelerations_for_a_while_the_rate_about_z_is_used() -> None:
    forces = np.tile([0.0, G_MPS2, 0.0], (1000, 1))
    forces[500:] = np.nan
    gyro_dps = np.tile([1.0, 2.0, 3.0], (1000, 1))
    session = Session("s", np.linspace(0.0, 10.0, 1000), gyro_dps[:, 2], gyro_dps=gyro_dps, accel_mps2=forces)
    assert vertical_rates_dps(session)[[100, 900]].tolist() == [2.0, 3.0]
