"""A simulated device that runs a filter itself: HELLO version 3, and YAW after each sample."""

from itertools import islice
from math import isnan
from pathlib import Path

import pytest
from golden_frames import AXES_FILTER_HELLO, FILTER_HELLO

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import OWN_YAWS, Base, Rig, load_rig, with_axes, with_own_yaw
from firmware_sim.wire import native
from firmware_sim.yaml_file import FileError
from gyrodrift.filters.on_device import FILTERS, device_filter
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.simulation.sessions import Simulation, rig_yaml
from gyrodrift.values.sample import Reading


def rig_of(own_yaw: str) -> Rig:
    return with_own_yaw(with_axes(Rig(base=Base(bias_dps=0.3)), 3 if own_yaw == "attitude" else 1), own_yaw)


def readings_of(rig: Rig, count: int) -> tuple[NativeDecoder, list[Reading]]:
    decoder = NativeDecoder()
    frames = native.frames(measure(rig, load_motion("turntable"), 3), rig.base)
    return decoder, [reading for frame in islice(frames, count) for reading in decoder.push(frame.content)]


@pytest.mark.parametrize("own_yaw", OWN_YAWS)
def test_each_sample_has_the_result_of_the_filter_on_its_own_counts(own_yaw: str) -> None:
    decoder, readings = readings_of(rig_of(own_yaw), 3000)
    assert decoder.device.device_filter == own_yaw
    assert (decoder.counters.damaged, decoder.counters.lone_yaws) == (0, 0)
    twin = device_filter(own_yaw)
    for reading in readings:
        assert reading.t_us is not None
        assert reading.device_yaw is not None
        gyro_dps = reading.inertial[:3] if reading.inertial else (0.0, 0.0, reading.rate_dps)
        accel_mps2 = reading.inertial[3:] if reading.inertial else (float("nan"),) * 3
        expected = twin.step(reading.t_us / 1e6, gyro_dps, accel_mps2, reading.temp_c)
        assert reading.device_yaw == pytest.approx(expected, rel=1e-6, abs=1e-6, nan_ok=True)
    assert isnan(readings[-1].device_yaw.yaw_sigma_deg) == (own_yaw == "hdr")  # type: ignore[union-attr]


def test_the_numbers_of_the_filters_are_those_of_the_host() -> None:
    assert set(OWN_YAWS) == set(FILTERS) == set(native.FILTERS)


def test_hello_is_the_golden_one() -> None:
    """The device's own yaw has no other scale."""
    assert native.filter_hello_frame(Base(), 0.0, 1, 2) == FILTER_HELLO
    assert native.filter_hello_frame(Base(), 0.0047884, 3, 3) == AXES_FILTER_HELLO


@pytest.mark.parametrize("axes", [1, 3])
def test_a_device_without_a_filter_sends_what_it_always_sent(axes: int) -> None:
    plain = with_axes(Rig(), axes)
    own = with_own_yaw(plain, "restlevel")
    rows = [
        [frame.content for frame in islice(native.frames(measure(rig, load_motion("turntable"), 3), rig.base), 99)]
        for rig in (plain, own)
    ]
    assert "own_yaw" not in rig_yaml(plain)
    assert [frame for frame in rows[1] if frame[1:2] != b"\x04" and len(frame) in (20, 30)] == [
        frame for frame in rows[0] if len(frame) in (20, 30)
    ][:49]


def test_a_rig_file_may_have_the_option(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(rig_yaml(rig_of("attitude")))
    assert load_rig(path) == rig_of("attitude")


def test_attitude_on_one_axis_is_told(tmp_path: Path) -> None:
    with pytest.raises(FileError, match="--own-yaw attitude: needs a rig with three axes; add --axes 3"):
        with_own_yaw(Rig(), "attitude")
    path = tmp_path / "rig.yaml"
    path.write_text("base: {own_yaw: attitude}\n")
    with pytest.raises(FileError, match="attitude needs three axes; add three_axes"):
        load_rig(path)


def test_a_simulated_session_has_the_same_results_as_the_device() -> None:
    """Rig, profile and seed are the same."""
    rig = rig_of("restlevel")
    session = Simulation(rig, load_motion("turntable"), 3, minutes=0.3).whole()
    _, readings = readings_of(rig, 3000)
    yaws_deg = [reading.device_yaw.yaw_deg for reading in readings if reading.device_yaw]
    assert session.device_yaw_deg is not None
    count = min(len(yaws_deg), len(session.rate_dps))
    assert count > 1400
    assert session.device_yaw_deg[:count].tolist() == yaws_deg[:count]
