"""`gyrodrift serve` as a user runs it: a process, a serial port, JSON lines, a log, an exit status."""

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from itertools import islice, pairwise
from pathlib import Path
from random import Random
from typing import Any

import pytest
from support import PATIENCE_S, Command, ended_here, near, never, speaking_on

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.filters.registry import FILTERS
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.link.protocols.native import NativeDecoder
from gyrodrift.link.protocols.registry import detected_names
from gyrodrift.service.control_client import ControlClient

RIG = Rig(base=Base(bias_dps=0.3))
BLOCK = "hdr: {{i_c_dps: {i_c}, tau_s: 0.5, theta_w_dps: 1, c1: 0, c2: 1}}\n"


def spoken(protocol: str, count: int) -> list[bytes]:
    frames = ENCODERS[protocol].frames(measure(RIG, load_profile("turntable"), 1), RIG.base)
    return [frame.content for frame in islice(frames, count)]


@pytest.mark.parametrize(
    ("options", "name", "certain"),
    [
        ([], "restlevel", {"yaw_sigma_deg", "confidence", "bias_sigma_dps", "rest_probability"}),
        (["--filter", "hdr"], "hdr", set()),
    ],
)
def test_every_sample_becomes_a_line_with_the_yaw_of_the_filter(
    port: Path, options: list[str], name: str, certain: set[str]
) -> None:
    frames, chosen = spoken("native", 606), FILTERS[name]
    c, state, expected = chosen.coefficients(chosen.params()), chosen.state(), []
    for reading in NativeDecoder().push(b"".join(frames)):
        assert reading.t_us is not None
        chosen.step(c, state, reading.t_us / 1e6, reading.rate_dps)
        rounded = (round(reading.rate_dps, 5), round(state.yaw_deg, 4), round(state.bias_dps, 5))
        expected.append((reading.seq, reading.t_us / 1e6, *rounded))
    with speaking_on(port) as device, Command("serve", "--port", port, *options) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(frames), never)
        lines = serve.take_lines(len(expected))
        assert serve.stop() == 0
    got = [(x["seq"], x["t_s"], x["rate_dps"], x["yaw_deg"], x["bias_dps"]) for x in lines]
    assert got == expected
    assert all(x["corrected_dps"] == near(x["rate_dps"] - x["bias_dps"], 1.6e-5) for x in lines)
    keys = {"seq", "t_s", "rate_dps", "corrected_dps", "yaw_deg", "bias_dps", "encoder_deg", "temp_c"}
    assert set(lines[0]) == keys | {"correction_deg", "corrections"} | certain
    assert f"event=filter_chosen name={name} parameters=defaults" in serve.log


def test_what_runs_without_a_word_keeps_yaw_on_the_shipped_rig(port: Path) -> None:
    with Command("--link", port, "--speed", "max", "--duration", "20", module="firmware_sim") as device:
        device.until_log("native on")
        with Command("serve", "--port", port) as serve:
            last = serve.take_lines(2000)[-1]
            serve.stop()
    assert abs(last["yaw_deg"] - last["encoder_deg"]) < 1.0
    assert last["bias_dps"] == pytest.approx(0.35, abs=0.03)


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_it_cleanly(port: Path, number: int) -> None:
    """The stats are logged, the port is free again, and there is no traceback."""
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(spoken("csv", 100)), never)
        serve.take_lines(99)
        assert serve.stop(number) == 0
        assert "event=service_end" in serve.log
        assert "Traceback" not in serve.log
        with Command("serve", "--port", port) as again:
            again.until_log("link_open")
            assert again.stop() == 0


def test_lines_are_thinned_on_request(port: Path) -> None:
    with speaking_on(port) as device, Command("serve", "--port", port, "--rate", "10") as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(spoken("csv", 502)), never)
        lines = serve.take_lines(51)
        serve.stop()
    assert [line["t_s"] for line in lines] == pytest.approx([i / 10 for i in range(51)])


@contextmanager
def config_changed_half_way(port: Path, config: Path, to: str) -> Iterator[tuple[Command, dict[str, Any]]]:
    """The service half way through a stream, after another config was applied; with the last line before that."""
    config.write_text(BLOCK.format(i_c=0.001))
    frames = spoken("csv", 400)
    with speaking_on(port) as device, Command("serve", "--port", port, "--config", config) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(frames[:200]), never)
        before = serve.take_lines(199)[-1]
        config.write_text(to)
        serve.until_log("config_applied")
        device.send_all(b"".join(frames[200:]), never)
        yield serve, before


def test_a_changed_config_is_applied_between_two_samples_and_told_key_by_key(port: Path, tmp_path: Path) -> None:
    """Yaw and drift estimate go on."""
    with config_changed_half_way(port, tmp_path / "c.yaml", BLOCK.format(i_c=0.002)) as (serve, before):
        assert "hdr.i_c_dps: 0.001 → 0.002" in serve.log
        first, second = serve.take_lines(2)
        assert serve.stop() == 0
    assert abs(first["yaw_deg"] - before["yaw_deg"]) < 0.1
    assert abs(first["bias_dps"] - before["bias_dps"]) == pytest.approx(0.002)
    assert abs(second["bias_dps"] - first["bias_dps"]) == pytest.approx(0.002)


def printed(t_ms: range) -> bytes:
    return b"".join(b"%d 5 262\r\n" % t for t in t_ms)


def test_columns_of_the_config_are_followed_with_no_line_lost(port: Path, tmp_path: Path) -> None:
    """A sensitivity put right half way through a line; a clock that goes away is not, and the log says so."""
    config = tmp_path / "c.yaml"
    config.write_text("columns: t_ms, _, rate:lsb/131\n")
    with speaking_on(port) as device, Command("serve", "--port", port, "--config", config) as serve:
        device.wait_for_reader(never)
        device.send_all(printed(range(0, 1000, 10)) + b"1000 5", never)
        before = serve.take_lines(99)
        config.write_text("columns: [t_ms, _, 'rate:lsb/65.5:-']\n")
        serve.until_log("config_applied")
        device.send_all(b" 262\r\n" + printed(range(1010, 2000, 10)), never)
        after = serve.take_lines(100)
        config.write_text("columns: _, _, rate\n")
        serve.until_log("columns_kept")
        assert serve.stop() == 0
    assert {line["rate_dps"] for line in before} == {2.0}
    assert [line["rate_dps"] for line in after][1:] == [-4.0] * 99
    assert [line["seq"] for line in before + after] == list(range(199))


def test_another_filter_is_taken_while_it_runs_and_yaw_goes_on(port: Path, tmp_path: Path) -> None:
    peer = f"filter: restlevel\nrestlevel: {json.dumps(asdict(RestlevelParams()))}\n"
    with config_changed_half_way(port, tmp_path / "c.yaml", peer) as (serve, before):
        after = serve.take_lines(200)
        assert serve.stop() == 0
    assert "yaw_sigma_deg" not in before
    assert after[0]["yaw_deg"] == pytest.approx(before["yaw_deg"], abs=0.1)
    assert all(line["yaw_sigma_deg"] >= 0.0 and 0.0 < line["confidence"] <= 1.0 for line in after)


def test_an_invalid_change_is_refused_whole_and_the_old_config_stays(port: Path, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text(BLOCK.format(i_c=0.001))
    frames = spoken("csv", 300)
    with speaking_on(port) as device, Command("serve", "--port", port, "--config", config) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(frames[:100]), never)
        before = serve.take_lines(99)[-1]
        config.write_text(BLOCK.format(i_c="lots"))
        serve.until_log("config_rejected")
        assert f"{config}:1:7 hdr.i_c_dps: is 'lots' (text); expected a number from 0 to 10 deg/s" in serve.log
        device.send_all(b"".join(frames[100:]), never)
        assert abs(serve.take_lines(1)[0]["bias_dps"] - before["bias_dps"]) == pytest.approx(0.001)
        assert serve.stop() == 0


def test_defaults_are_told_and_so_is_a_file_that_is_gone_for_a_while(port: Path, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text("filter: hdr\nhdr: {tau_s: 0.5}\n")
    frames = spoken("csv", 300)
    with speaking_on(port) as device, Command("serve", "--port", port, "--config", config) as serve:
        serve.until_log("config_completed")
        report = "defaults=\"['hdr.i_c_dps: 0.0006', 'hdr.theta_w_dps: 0.5608', 'hdr.c1: 0.7839', 'hdr.c2: 1.2161']\""
        assert report in serve.log
        device.wait_for_reader(never)
        device.send_all(b"".join(frames[:100]), never)
        before = serve.take_lines(99)[-1]
        config.rename(tmp_path / "away")
        serve.until_log("config_gone")
        device.send_all(b"".join(frames[100:200]), never)
        after = serve.take_lines(100)
        config.write_text("filter: hdr\nhdr: {tau_s: 0.25}\n")
        serve.until_log("hdr.tau_s: 0.5 → 0.25")
        assert serve.stop() == 0
    assert abs(after[0]["bias_dps"] - before["bias_dps"]) < 0.001
    events = [line.split("event=")[1].split(" ")[0] for line in serve.log.splitlines() if "event=config_" in line]
    assert events == ["config_completed", "config_gone", "config_back", "config_applied"]


def test_a_stream_of_another_rate_than_the_config_is_warned_of(port: Path, tmp_path: Path) -> None:
    config = tmp_path / "c.yaml"
    config.write_text("sample_rate_hz: 50\n" + BLOCK.format(i_c=0.001))
    with speaking_on(port) as device, Command("serve", "--port", port, "--config", config) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(spoken("csv", 100)), never)
        serve.until_log("sample_rate_differs")
        assert "tuned_at_hz=50.0 stream_hz=100.0" in serve.log
        serve.stop()


def test_a_device_that_comes_back_goes_on_with_yaw_and_learns_its_bias_anew(port: Path) -> None:
    frames = b"".join(spoken("native", 300))
    with ExitStack() as stack:
        first = stack.enter_context(ExitStack())
        device = first.enter_context(speaking_on(port))
        serve = stack.enter_context(Command("serve", "--port", port, "--filter", "hdr"))
        device.wait_for_reader(never)
        device.send_all(frames, never)
        before = serve.take_lines(297)[-1]
        first.close()
        serve.until_log("event=link_lost")
        device = stack.enter_context(speaking_on(port))
        device.wait_for_reader(never)
        device.send_all(frames, never)
        after = serve.take_lines(297)
        serve.until_log("event=bias_reopened")
        assert serve.stop() == 0
    assert "event=link_restored" in serve.log
    assert "gone_s=" in serve.log
    assert after[0]["seq"] == before["seq"] + 1
    assert after[0]["t_s"] == pytest.approx(before["t_s"] + 0.01)
    assert after[0]["yaw_deg"] == pytest.approx(before["yaw_deg"], abs=0.02)
    assert after[0]["bias_dps"] == 0.0  # its clock restarted, so the bias may be another one
    assert len({line["seq"] for line in after}) == 297


def test_damage_is_survived_and_counted(port: Path) -> None:
    """Noise between good frames, half a frame at the end."""
    frames = spoken("native", 200)
    noise = Random(2).randbytes(5000)
    with speaking_on(port) as device, Command("serve", "--port", port, "--log-format", "json") as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(frames[:100]) + b"\0" + noise + b"\0" + b"".join(frames[100:]) + frames[5][:7], never)
        lines = serve.take_lines(198)
        serve.stop()
    assert [line["seq"] for line in lines] == list(range(198))
    stats = json.loads(serve.log.splitlines()[-1])
    assert stats["event"] == "service_end"
    assert (stats["samples"], stats["gaps"], stats["rejected"]) == (198, 0, 0)
    assert stats["damaged"] >= 10


def test_bad_samples_are_counted_and_leave_no_line(port: Path) -> None:
    """A repeated time, and a rate that is no number."""
    lines = [b"%d,0.5\n" % (i * 10_000) for i in range(50)]
    lines[20:20] = [b"190000,0.7\n", b"200000,nan\n"]
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(lines), never)
        got = serve.take_lines(50)
        serve.until_log("samples_rejected")
        serve.stop()
    assert [line["t_s"] for line in got] == pytest.approx([i / 100 for i in range(50)])
    assert "rejected=2" in serve.log


def test_a_hole_is_reported_and_integrated_with_its_true_time(port: Path) -> None:
    frames = spoken("native", 303)
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(frames[:150] + frames[160:]), never)
        lines = serve.take_lines(289)
        serve.until_log("event=gap")
        serve.stop()
    assert "holes=1 missing=10 longest_s=0.11" in serve.log
    steps = [b["t_s"] - a["t_s"] for a, b in pairwise(lines)]
    assert max(steps) == pytest.approx(0.11)


def test_a_reader_that_has_enough_ends_it_without_noise(port: Path) -> None:
    """`gyrodrift serve ... | head -1`."""
    command = f"{sys.executable} -m gyrodrift serve --port {port} --log-level error | head -1"
    with speaking_on(port) as device:
        shell = subprocess.Popen(
            ["bash", "-o", "pipefail", "-c", command], stdout=subprocess.PIPE, stderr=subprocess.PIPE
        )
        device.wait_for_reader(never)
        device.greeting = b""
        frames = iter(spoken("csv", 20_000))
        while shell.poll() is None and device.send_all(next(frames), never):
            pass
        out, error = shell.communicate(timeout=PATIENCE_S)
    assert (out.count(b"\n"), error, shell.returncode) == (1, b"", 0)


def test_a_reader_that_sleeps_does_not_stop_the_service(port: Path, tmp_path: Path) -> None:
    words, count = ("serve", "--port", port, "--log-format", "json", "--control", tmp_path / "control"), 50_000
    with speaking_on(port) as device, Command(*words) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(b"%d,0.25\n" % (i * 1000) for i in range(count)), never)
        with ControlClient(tmp_path / "control", PATIENCE_S) as control:
            while control.ask("status")["link"]["samples"] < count:
                pass
        serve.process.send_signal(signal.SIGTERM)
        serve.end()
    stats = json.loads(serve.log.splitlines()[-1])
    assert stats["samples"] == count
    assert stats["lines_dropped"] > 0
    assert stats["lines_dropped"] + len(serve.all_lines()) == count


@pytest.mark.parametrize(
    ("arguments", "status", "message"),
    [
        (["--port", "/dev/ttyNONE"], 3, "gyrodrift: /dev/ttyNONE: there is no such port"),
        (["--port", "{port}", "--timeout", "nan"], 2, "gyrodrift: --timeout nan: expected seconds, 0 or more"),
        (
            ["--port", "{port}", "--protocol", "morse"],
            2,
            "gyrodrift: --protocol morse: there are auto, native, vectornav, ",
        ),
        (
            ["--port", "{port}", "--baud", "fast"],
            2,
            "gyrodrift: --baud fast: expected a rate in baud such as 115200, or auto",
        ),
        (["--port", "{port}", "--rate", "0"], 2, "gyrodrift: --rate 0: expected a number above 0"),
        (["--port", "{port}", "--timeout", "0.3"], 3, "gyrodrift: {port}: the device sent nothing within 0.3 s"),
        (["--port", "{port}", "--config", "nowhere.yaml"], 2, "gyrodrift: nowhere.yaml:1:1 cannot be read"),
        (["--port", "{port}", "--config", "c.yaml", "--filter", "hdr"], 2, "gyrodrift: serve: argument --filter:"),
        (["--port"], 2, "gyrodrift: serve: argument --port: expected one argument"),
        ([], 2, "gyrodrift: serve: the following arguments are required: --port"),
    ],
)
def test_a_persons_mistake_is_one_line_and_an_exit_status(
    port: Path, arguments: list[str], status: int, message: str
) -> None:
    with speaking_on(port):
        serve = ended_here("serve", *(word.format(port=port) for word in arguments))
    assert serve.status == status
    last = serve.log.splitlines()[-1]
    assert last.startswith(message.format(port=port))
    assert "Traceback" not in serve.log


def test_random_bytes_end_with_the_advice_to_check_the_baud_rate(port: Path) -> None:
    with speaking_on(port) as device, Command("serve", "--port", port, "--baud", "9600", "--timeout", "1") as serve:
        device.wait_for_reader(never)
        random = Random(3)
        while serve.process.poll() is None and device.send_all(random.randbytes(100), never):
            serve._read(0.01)
        assert serve.end() == 3
    assert f"no {detected_names()} frame at 9600 baud; the baud rate may be wrong" in serve.log


def test_the_log_goes_to_stderr_and_only_samples_to_stdout(port: Path) -> None:
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(b"".join(spoken("csv", 50)) + os.urandom(100), never)
        serve.take_lines(49)
        device.drain(never)
        serve.stop()
    assert len(serve.all_lines()) == 49
