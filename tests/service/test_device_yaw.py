"""`serve` and `record` at a device that runs a filter itself, through a pty."""

import json
from math import isnan, nan
from pathlib import Path

import numpy as np
import pytest
from outputs_support import OWN_YAW, corrected, events, serving, with_own_yaw
from support import Command, Terminal, never, ours, speaking_on

from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import Base, load_rig
from firmware_sim.rig import with_own_yaw as rig_with_own_yaw
from firmware_sim.wire.native import filter_hello_frame, hello_frame, sample_frame, yaw_frame
from gyrodrift.outputs.json_line import json_line, present_fields
from gyrodrift.outputs.mqtt import state
from gyrodrift.service.reference import DeviceReference
from gyrodrift.session.files import load_session
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.sample import DeviceYaw, Sample

OWN_FIELDS = {"device_yaw_deg", "device_yaw_sigma_deg", "device_bias_dps"}


@pytest.mark.parametrize(("own_yaw", "axes"), [("restlevel", "1"), ("hdr", "1"), ("attitude", "3")])
def test_lines_and_recording_have_the_yaw_of_the_device(tmp_path: Path, own_yaw: str, axes: str) -> None:
    link, folder = tmp_path / "gyro", tmp_path / "sessions"
    words = ("--own-yaw", own_yaw, "--axes", axes, "--duration", "12", "--speed", "max", "--wait")
    options = ("--filter", "hdr" if own_yaw == "hdr" else "restlevel", "--record", folder)
    with Command("simulated-device", "--link", link, *words) as device:
        device.until(lambda _: link.is_symlink(), "port")
        with Command("serve", "--port", link, "--log-format", "json", *options) as serve:
            lines = serve.take_lines(1190)
            serve.stop()
    has_sigma = own_yaw != "hdr"
    expected = OWN_FIELDS if has_sigma else OWN_FIELDS - {"device_yaw_sigma_deg"}
    assert all(line.keys() & OWN_FIELDS == expected for line in lines)
    apart_deg = [line["yaw_deg"] - line["device_yaw_deg"] for line in lines]
    assert np.ptp(apart_deg) < 1e-3
    (event,) = events(serve, "device")
    assert event["device_filter"] == own_yaw
    (recording,) = folder.glob("*.mcap")
    session = load_session(recording)
    assert session.device_yaw_deg is not None
    assert np.round(session.device_yaw_deg, 4).tolist()[: len(lines)] == pytest.approx(
        [line["device_yaw_deg"] for line in lines], abs=1e-4
    )
    assert bool(np.isnan(session.filled("device_yaw_sigma_deg")).all()) != has_sigma
    assert session.metadata["device"]["device_filter"] == own_yaw


def test_record_keeps_both_yaws_in_csv_after_convert(tmp_path: Path) -> None:
    link, folder = tmp_path / "gyro", tmp_path / "sessions"
    words = ("--own-yaw", "restlevel", "--duration", "6", "--speed", "max", "--wait")
    with Command("simulated-device", "--link", link, *words) as device:
        device.until(lambda _: link.is_symlink(), "port")
        with Command("record", "--port", link, "--out", folder, "--duration", "5") as record:
            assert record.end() == 0
    (recording,) = folder.glob("*.mcap")
    table = tmp_path / "a.csv"
    with Command("convert", recording, table) as convert:
        assert convert.end() == 0
    assert set(table.read_text().splitlines()[0].split(",")) >= OWN_FIELDS
    first, again = load_session(recording), load_session(table)
    assert np.array_equal(first.filled("device_yaw_deg"), again.filled("device_yaw_deg"))
    with Command("info", recording) as info:
        assert info.end() == 0
    assert "the device's own yaw" in info.out


def frames(count: int, *, every: int = 1, filter_number: int = 2) -> bytes:
    """A device at 100 Hz that says 0.5 deg more with each sample."""
    sent = [filter_hello_frame(Base(), 0.0, 1, filter_number)]
    for seq in range(count):
        sent.append(sample_frame(2, seq, seq * 10_000, 0, 2500, 0))
        if seq % every == 0:
            sent.append(yaw_frame(seq, seq * 10_000, 0.5 * seq, 0.25, 0.125))
    return b"".join(sent)


def test_lines_without_a_result_have_no_fields_of_the_device(port: Path) -> None:
    """A device may send every fifth."""
    with serving(port) as (serve, device):
        device.send_all(frames(100, every=5), never)
        lines = serve.take_lines(95)
    assert [line["seq"] for line in lines if "device_yaw_deg" in line] == list(range(0, 95, 5))
    assert lines[20]["device_yaw_deg"] == 10.0
    assert lines[20]["device_bias_dps"] == 0.125


def test_yaws_that_belong_to_no_sample_are_counted_in_the_log(port: Path) -> None:
    lone = yaw_frame(9, 9, 1.0, 0.1, 0.0)
    with serving(port) as (serve, device):
        device.send_all(lone + frames(60) + lone + hello_frame(Base()), never)
        assert len(serve.take_lines(60)) == 60
        serve.stop()
    assert json.loads(serve.log.splitlines()[-1])["lone_yaws"] == 2


def test_a_terminal_shows_both_yaws_and_their_difference(port: Path) -> None:
    """Our yaw stays 0, that of the device turns."""
    with speaking_on(port) as device, Terminal(*ours("serve", "--port", port), columns=160, rows=24) as terminal:
        device.wait_for_reader(never)
        device.send_all(frames(21), never)
        terminal.until(lambda it: "device +10.00 ± 0.25 deg, difference -10.00" in it.text, "both yaws")
        assert "yaw +0.00" in terminal.text


def test_a_line_has_the_fields_of_the_device_at_its_end() -> None:
    sample = corrected(1).sample
    own = corrected(1)._replace(sample=sample._replace(device_yaw=OWN_YAW))
    assert json_line(own) == json_line(corrected(1)).replace(
        "}", ',"device_yaw_deg":2.5000,"device_yaw_sigma_deg":0.1250,"device_bias_dps":-0.50000}'
    )
    without = corrected(1)._replace(sample=sample._replace(device_yaw=DeviceYaw(1.0, nan, 0.0)))
    assert "device_yaw_sigma_deg" not in json_line(without)
    assert json.loads(json_line(own)).items() >= present_fields(own, sorted(OWN_FIELDS)).items()


def test_the_difference_is_0_where_the_two_were_aligned() -> None:
    reference = DeviceReference()
    assert isnan(reference.take(None, 1.0))
    assert reference.take(DeviceYaw(100.0, nan, 0.0), 3.0) == 0.0
    assert reference.take(DeviceYaw(101.0, nan, 0.0), 5.0) == 1.0
    assert reference.take(None, 50.0) == 1.0
    assert reference.take(DeviceYaw(101.0 - 360.0, nan, 0.0), 5.0) == 1.0
    reference.align()
    assert reference.take(DeviceYaw(101.0, nan, 0.0), 0.0) == 0.0


def test_a_board_upside_down_has_its_yaw_inverted() -> None:
    """The filter in the device has not the calibration; only the sign applies to its yaw."""
    own = Sample(0, 0.0, 0.0, 1.0, device_yaw=DeviceYaw(10.0, 0.5, 0.25))
    assert Calibration("", sign=-1).sample(own).device_yaw == DeviceYaw(-10.0, 0.5, -0.25)
    assert Calibration("", scale_ccw=1.1).sample(own).device_yaw == own.device_yaw


def test_ctl_status_and_top_have_both_yaws(port: Path, tmp_path: Path) -> None:
    control = tmp_path / "control"
    with serving(port, "--control", control) as (serve, device):
        device.send_all(frames(21), never)
        serve.take_lines(20)
        with Command("ctl", control, "status") as status:
            assert status.end() == 0
        with Command("top", control) as top:
            assert top.end() == 0
    about = json.loads(status.out)
    assert about["device"]["device_filter"] == "restlevel"
    assert about["filter"]["device_bias_dps"] == 0.125
    assert about["filter"]["device_difference_deg"] == pytest.approx(-about["filter"]["device_yaw_deg"], abs=0.01)
    assert "Device yaw" in top.out
    assert "Difference" in top.out


def test_mqtt_has_the_fields_where_the_device_sends_them() -> None:
    """Other messages have no null for them."""
    own = with_own_yaw(corrected(1))
    assert json.loads(state(own)) == json.loads(state(corrected(1))) | {
        "device_yaw_deg": 2.5,
        "device_yaw_sigma_deg": 0.125,
        "device_bias_dps": -0.5,
    }


@pytest.mark.parametrize(
    "fault",
    [
        "bit_flips",
        "merged_frames",
        pytest.param("dropped_bytes", marks=pytest.mark.evaluation),
        pytest.param("duplicated_bytes", marks=pytest.mark.evaluation),
    ],
)
def test_a_bad_link_mixes_no_yaws_and_costs_no_other_sample(tmp_path: Path, fault: str) -> None:
    link, rig = tmp_path / "gyro", rig_with_own_yaw(load_rig(None), "restlevel")
    sound = Simulation(rig, load_motion("turntable"), 0, minutes=0.4).whole()
    words = ("--own-yaw", "restlevel", "--duration", "20", "--speed", "max", "--wait", "--fault", fault)
    with Command("simulated-device", "--link", link, *words) as device:
        device.until(lambda _: link.is_symlink(), "port")
        with Command("serve", "--port", link) as serve:
            serve.until_log("event=link_lost")
            serve.stop()
    lines = [line for line in serve.all_lines() if "device_yaw_deg" in line]
    expected_deg = sound.filled("device_yaw_deg")[[line["seq"] for line in lines]]
    assert [line["device_yaw_deg"] for line in lines] == pytest.approx(expected_deg.tolist(), abs=1e-4)
    assert len(lines) > 900
