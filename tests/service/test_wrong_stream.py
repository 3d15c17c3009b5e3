"""`gyrodrift serve` and `record` on a stream that is not what they expect: one line says what it is and what to do."""

import csv
import shlex
from collections.abc import Callable
from math import radians
from pathlib import Path
from random import Random

import pytest
from support import Command, never, speaking_on

OPTIONS = ("--timeout", "1", "--log-level", "error")
NOISE = Random(7)


def statement(port: Path, line: Callable[[int], str], *options: str, command: str = "serve") -> str:
    """The last line of the log of a command that gives up with the status of the link."""
    with speaking_on(port) as device, Command(command, "--port", port, *OPTIONS, *options) as host:
        device.wait_for_reader(never)
        number = 0
        while host.process.poll() is None and device.send_all(line(number).encode() + b"\r\n", never):
            number += 1
            host._read(0.01)
        assert host.end() == 3
    return host.log.splitlines()[-1]


def counts(number: int) -> str:
    return f"t:{1000 + 10 * number},gx:{number % 7},gy:{number % 5},gz:{int(NOISE.gauss(0.0, 20.0))}"


@pytest.mark.parametrize("options", [(), ("--baud", "115200"), ("--baud", "9600", "--protocol", "csv")])
def test_text_that_does_not_parse_is_quoted_and_its_columns_are_named(port: Path, options: tuple[str, ...]) -> None:
    """The rate is right where the text can be read, given or not; what is proposed reads it once the unit is said."""
    report = statement(port, counts, *options)
    assert report.startswith(f"gyrodrift: {port}: the device prints text, so the baud rate is right, but no line is a")
    assert '"t:1' in report
    assert "looks like t_ms, gx, gy, gz (label:value pairs)" in report
    assert "its unit is unknown" in report
    assert f"gyrodrift doctor --port {port} --turn" in report
    proposed = shlex.split(report[report.index("--columns") :])[1].rstrip(",")
    assert proposed == "t=t_ms, gz=rate:UNIT"
    proposed = proposed.replace("UNIT", "lsb/131")
    with speaking_on(port) as device, Command("serve", "--port", port, "--columns", proposed) as serve:
        device.wait_for_reader(never)
        device.send_all("".join(f"{counts(i)}\r\n" for i in range(50)).encode(), never)
        lines = serve.take_lines(50)
        assert serve.stop() == 0
    assert lines[-1]["t_s"] - lines[0]["t_s"] == pytest.approx(0.49)
    assert max(abs(line["rate_dps"]) for line in lines) < 1.0


@pytest.mark.parametrize(
    ("line", "looks"),
    [
        ('{{"ms":{0},"gyro":{{"x":1,"z":0.25}}}}', "looks like t_ms, gx, gz (a JSON object)"),
        ("MPU6050 connection failed", "looks like a message; is its program running?"),
        ("!z+170.00+000.53-001.20+123.40A5", "looks like data of an unknown form"),
        ("$GPTXT,{0},hello", "looks like"),
        ("\x1b[31mrate\x1b[0m {0} \x07 " + "x" * 300, "…"),
    ],
)
def test_whatever_is_quoted_is_one_printable_line_of_bounded_length(port: Path, line: str, looks: str) -> None:
    report = statement(port, lambda number: line.format(10 * number))
    assert looks in report
    assert report.isprintable()
    assert len(report) < 1000


def test_bytes_that_are_no_text_at_a_given_baud_rate_are_told_to_be_tried_at_others(port: Path) -> None:
    random = Random(5)
    with speaking_on(port) as device, Command("serve", "--port", port, *OPTIONS, "--baud", "9600") as serve:
        device.wait_for_reader(never)
        while serve.process.poll() is None and device.send_all(random.randbytes(40), never):
            serve._read(0.01)
        assert serve.end() == 3
    assert "frame at 9600 baud; the baud rate may be wrong: without --baud all usual rates are tried" in serve.log


@pytest.mark.parametrize("command", [("serve",), ("record", "--out", "{folder}")])
@pytest.mark.parametrize("protocol", ["csv", "native"])
def test_a_clock_of_milliseconds_is_refused_and_what_came_is_kept(
    port: Path, tmp_path: Path, command: tuple[str, ...], protocol: str
) -> None:
    fault = ("--wait", "--quiet", "--protocol", protocol, "--fault", "millisecond_clock")
    with Command("--link", port, *fault, module="firmware_sim") as device:
        device.until(lambda _: port.is_symlink(), "link")
        words = [word.format(folder=tmp_path / "sessions") for word in command]
        with Command(*words, "--port", port, "--log-level", "error") as host:
            assert host.end() == 3
    assert "milliseconds, not microseconds" in host.log
    assert ("--columns 't_ms, rate:dps, encoder, temp'" in host.log) == (protocol == "csv")
    assert "Traceback" not in host.log
    if command[0] == "record":
        (kept,) = (tmp_path / "sessions").glob("*.mcap")
        assert str(kept) in host.out


def test_rates_in_rad_per_s_are_warned_of_with_the_odds_and_the_setting(port: Path, tmp_path: Path) -> None:
    session = tmp_path / "radians.csv"
    with session.open("w", newline="") as file:
        rows = csv.writer(file)
        rows.writerow(["t_device_s", "rate_dps"])
        for i in range(2000):
            turn_dps = 90.0 if 1200 <= i < 1500 else 0.0
            rows.writerow([i / 100, radians(turn_dps + 0.5 + NOISE.gauss(0.0, 0.07))])
    with Command("replay", session, "--link", port, "--speed", "max") as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", port, "--protocol", "csv") as serve:
            assert len(serve.take_lines(2000)) == 2000
            assert serve.stop() == 0
    assert serve.log.count("event=rate_unit_differs unit=rad/s odds=") == 1
    assert "to 1" in serve.log
    assert "--columns 't_us, rate:rads'" in serve.log


def csv_lines(columns: Callable[[float, float, float], str]) -> bytes:
    """Lines of a sketch: `columns` gets time, yaw and rate of a turn by 165 deg between two rests."""
    lines, yaw_deg = [], 0.0
    for i in range(700):
        rate_dps = max(0.0, min(60.0, 4.0 * (i - 250), 4.0 * (400 - i)))
        yaw_deg += rate_dps * 0.02
        lines.append(f"{20_000 * i},{columns(0.02 * i, yaw_deg, rate_dps + NOISE.gauss(0.5, 0.05))}\n")
    return "".join(lines).encode()


NO_RATES = {
    "heading": (lambda _, yaw, __: f"{(yaw + 200.0) % 360.0 - 180.0:.2f}", "wraps from"),
    "angle": (lambda _, yaw, __: f"{yaw:.2f}", "after a motion"),
    "counts": (lambda _, __, rate: f"{131.0 * rate:.0f}", "whole numbers"),
    "rad/s": (lambda _, __, rate: f"{radians(rate):.5f}", "rate:rads"),
}


@pytest.mark.parametrize("name", NO_RATES)
def test_csv_lines_whose_second_column_is_no_rate_end_with_a_question(port: Path, name: str) -> None:
    columns, reason = NO_RATES[name]
    with speaking_on(port) as device, Command("serve", "--port", port) as serve:
        device.wait_for_reader(never)
        device.send_all(csv_lines(columns), never)
        assert serve.end() == 3
    assert "event=verdict_withdrawn" in serve.log
    assert reason in serve.log
    assert f"gyrodrift doctor --port {port} --turn" in serve.log


def test_a_recording_keeps_what_is_no_rate(port: Path, tmp_path: Path) -> None:
    with speaking_on(port) as device, Command("record", "--port", port, "--out", tmp_path / "s") as record:
        device.wait_for_reader(never)
        device.send_all(csv_lines(NO_RATES["heading"][0]), never)
        record.until_log("event=rate_doubted")
        assert record.stop() == 0


def test_numbers_that_nothing_names_are_asked_for(port: Path) -> None:
    report = statement(
        port, lambda number: f"{NOISE.gauss(0.3, 0.1):.2f},{NOISE.gauss(-0.8, 0.1):.2f},0.5{number % 10}"
    )
    assert "none of them is known to be the yaw rate" in report
    assert f"gyrodrift doctor --port {port} --turn" in report
    assert "--columns '" not in report


def test_a_rate_without_a_unit_that_is_hardly_in_deg_per_s_ends_the_service(port: Path) -> None:
    rates = [radians((90.0 if 1200 <= i < 1500 else 0.0) + 0.5 + NOISE.gauss(0.0, 0.07)) for i in range(2000)]
    text = "".join(f"{10 * i} {rate:.5f}\n" for i, rate in enumerate(rates)).encode()
    for columns, status in (("t_ms, rate", 3), ("t_ms, rate:dps", 0)):
        with speaking_on(port) as device, Command("serve", "--port", port, "--columns", columns) as serve:
            device.wait_for_reader(never)
            device.send_all(text, never)
            if status:
                assert serve.end() == status
                assert "the unit of its rates is not stated" in serve.log
            else:
                serve.until_log("rate_unit_differs")
                assert serve.stop() == status


def test_a_device_that_sends_an_angle_is_differentiated(port: Path) -> None:
    angles = [(170.0 + 0.6 * max(0, min(i - 100, 275))) for i in range(500)]
    text = "".join(f"{20 * i};{(angle + 180.0) % 360.0 - 180.0:.2f}\n" for i, angle in enumerate(angles)).encode()
    with (
        speaking_on(port) as device,
        Command("serve", "--port", port, "--columns", "t_ms, yaw:deg", "--filter", "hdr") as serve,
    ):
        device.wait_for_reader(never)
        device.send_all(text, never)
        lines = serve.take_lines(499)
        assert serve.stop() == 0
    assert "rate_from_angle" in serve.log
    assert lines[-1]["t_s"] - lines[0]["t_s"] == pytest.approx(9.96)
    assert sum(line["rate_dps"] for line in lines) * 0.02 == pytest.approx(165.0)


def test_accelerations_in_g_are_warned_of_once_with_the_setting(port: Path) -> None:
    lines = [f"{10 * i},0.1,0.2,{0.3 + 0.1 * (i % 3):.1f},0.01,0.02,{0.99 + 0.01 * (i % 2):.2f}\n" for i in range(400)]
    columns = "t_ms, gx:dps, gy:dps, gz:dps, ax, ay, az"
    with speaking_on(port) as device, Command("serve", "--port", port, "--columns", columns) as serve:
        device.wait_for_reader(never)
        device.send_all("".join(lines).encode(), never)
        serve.take_lines(390)
        serve.until_log("accel_unit_differs")
        assert serve.stop() == 0
    assert serve.log.count("accel_unit_differs") == 1
    assert "in --columns, write ax:g, ay:g, az:g" in serve.log
