"""`gyrodrift replay`: a recording that looks like the device, so that it takes the whole serial path."""

import io
import signal
from pathlib import Path
from random import Random

import numpy as np
import pytest
from support import Command, ended_here

from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.mcap.write import McapWriter
from gyrodrift.session.session import Session

SAMPLES = 400


@pytest.fixture
def session(tmp_path: Path) -> Path:
    """Times to the microsecond with jitter and a hole, rates with all their digits, angle and temperature."""
    rng = np.random.default_rng(8)
    t_us = np.cumsum(rng.integers(9000, 11000, SAMPLES)) + np.where(np.arange(SAMPLES) > 300, 700_000, 0)
    rate_dps = rng.normal(0.3, 0.1, SAMPLES) + 90.0 * np.sin(t_us / 1e6)
    turned_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) * np.diff(t_us) / 1e6)])
    rows = zip(t_us / 1e6, rate_dps, turned_deg, rng.normal(25, 1, SAMPLES), strict=True)
    lines = (",".join(repr(float(value)) for value in row) for row in rows)
    path = tmp_path / "mine.csv"
    path.write_text("t_device_s,rate_dps,encoder_deg,temp_c\n" + "\n".join(lines) + "\n")
    return path


def played(session: Path, *options: str, count: int = SAMPLES) -> list[dict[str, float]]:
    link = session.with_name("gyro")
    with Command("replay", session, "--link", link, "--speed", "max", *options) as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", link) as serve:
            lines = serve.take_lines(count)
            serve.stop()
    return lines


def table_of(session: Path) -> np.ndarray[tuple[int, int], np.dtype[np.float64]]:
    return np.loadtxt(session, delimiter=",", skiprows=1)


def rows_of(session: Path) -> list[list[float]]:
    rows: list[list[float]] = table_of(session).tolist()
    return rows


def test_csv_carries_every_digit_that_serve_writes(session: Path) -> None:
    """Time, rate, angle and temperature come out as they stand in the file."""
    digits = {"t_s": 6, "rate_dps": 5, "encoder_deg": 4, "temp_c": 2}
    expected = [[round(value, n) for value, n in zip(row, digits.values(), strict=True)] for row in rows_of(session)]
    assert [[line[key] for key in digits] for line in played(session)] == expected


def test_native_rounds_to_its_counts(session: Path) -> None:
    got = np.array(
        [[x["t_s"], x["rate_dps"], x["encoder_deg"], x["temp_c"]] for x in played(session, "--protocol", "native")]
    )
    error = np.abs(got - table_of(session)).max(axis=0)
    assert error == pytest.approx(np.array([0.0, 0.005, 0.00005, 0.005]), abs=2e-4)
    assert error[0] < 1e-9


def test_witmotion_carries_rates_in_its_own_steps(session: Path) -> None:
    link = session.with_name("gyro")
    with Command("replay", session, "--link", link, "--protocol", "witmotion", "--speed", "2") as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", link) as serve:
            lines = serve.take_lines(SAMPLES)
            serve.stop()
    got = np.array([line["rate_dps"] for line in lines])
    assert np.abs(got - table_of(session)[:, 1]).max() <= 1000 / 32768 + 1e-9


def test_it_says_that_the_own_yaw_of_the_device_is_left_out(tmp_path: Path) -> None:
    """The samples are encoded again, without it."""
    session, link = tmp_path / "own.csv", tmp_path / "gyro"
    lines = (f"{i / 100},0.3,{i / 10},0.5,0.3" for i in range(SAMPLES))
    session.write_text(
        "t_device_s,rate_dps,device_yaw_deg,device_yaw_sigma_deg,device_bias_dps\n" + "\n".join(lines) + "\n"
    )
    with Command("replay", session, "--link", link, "--speed", "max") as replay:
        replay.until_log("waiting for a reader")
    assert "own: left out: the device's own yaw; --raw plays it" in replay.log


def test_a_loop_goes_on_in_time(session: Path) -> None:
    """The second pass begins one period after the first one ended."""
    lines = played(session, "--loop", count=2 * SAMPLES + 10)
    steps = np.diff([line["t_s"] for line in lines])
    assert steps[SAMPLES - 1] == pytest.approx(0.01, abs=1e-3)
    assert [line["rate_dps"] for line in lines[SAMPLES : 2 * SAMPLES]] == table_of(session)[:, 1].round(5).tolist()


def test_the_end_of_a_recording_ends_it_when_everything_is_read(session: Path) -> None:
    link = session.with_name("gyro")
    with Command("replay", session, "--link", link, "--speed", "max") as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", link) as serve:
            serve.take_lines(SAMPLES)
            assert replay.end() == 0
            serve.stop()
    assert f"{SAMPLES} samples sent, 0 without a reader" in replay.log
    assert not link.is_symlink()


def test_a_signal_interrupts_it(session: Path) -> None:
    with Command("replay", session, "--link", session.with_name("gyro")) as replay:
        replay.until_log("waiting for a reader")
        assert replay.stop(signal.SIGINT) == 130


def test_raw_bytes_are_played_as_they_came(tmp_path: Path) -> None:
    """Damage included: what was recorded of a bad link is a bad link again."""
    random = Random(4)
    reads = [b"%d,0.5\n%d,0.25\n" % (20_000 * i, 20_000 * i + 10_000) for i in range(200)]
    reads[100] = random.randbytes(300) + b"\n"
    stream = io.BytesIO()
    writer = McapWriter(stream)
    for number, content in enumerate(reads):
        writer.add_read(content, 1.7e9 + number * 0.02)
    writer.finish()
    session, link = tmp_path / "raw.mcap", tmp_path / "gyro"
    session.write_bytes(stream.getvalue())
    broken = session.with_name("broken.mcap")
    index = stream.getvalue().index(b"/raw") - 4
    broken.write_bytes(stream.getvalue()[:index] + b"\xff\xff\0\0" + stream.getvalue()[index + 4 :])
    with Command("replay", broken, "--raw", "--link", link) as replay:
        assert replay.end() == 4
    assert (
        replay.log == f"gyrodrift: {broken}: a record Channel is damaged; the file was changed since it was written\n"
    )
    with Command("replay", session, "--raw", "--link", link, "--speed", "max") as replay:
        replay.until_log("waiting for a reader")
        with Command("serve", "--port", link, "--log-format", "json") as serve:
            lines = serve.take_lines(398)
            assert replay.end() == 0
            serve.stop()
    assert "200 reads sent, 0 without a reader" in replay.log
    assert lines[-1]["t_s"] == pytest.approx(3.99)
    assert '"damaged": 0' not in serve.log.splitlines()[-1]


@pytest.mark.parametrize(
    ("options", "status", "message"),
    [
        (["--speed", "0"], 2, "--speed 0: expected a number above 0, or max"),
        (["--speed", "fast"], 2, "--speed fast: expected a number above 0, or max"),
        (["--lsb", "0"], 2, "--lsb 0: expected deg/s per count"),
        (["--link", "{session}"], 3, "exists and is not a link"),
        (["--raw"], 4, "is no MCAP file; only MCAP files have raw bytes"),
        (["--raw", "--loop"], 2, "raw bytes can be played only once"),
    ],
)
def test_mistakes_are_one_line(session: Path, options: list[str], status: int, message: str) -> None:
    arguments = [word.format(session=session) for word in options]
    replay = ended_here("replay", session, "--link", session.with_name("gyro"), *arguments)
    assert replay.status == status
    assert message in replay.log
    assert "Traceback" not in replay.log


def test_three_axes_pass_the_serial_path_and_are_recorded(tmp_path: Path) -> None:
    t_s = np.linspace(0.0, 4.0, SAMPLES)
    gyro_dps = np.column_stack([5.0 * np.sin(t_s), np.cos(t_s), 30.0 * np.sin(t_s)])
    accel_mps2 = np.column_stack([np.sin(t_s), 0.1 * t_s, np.full(SAMPLES, 9.81)])
    accel_mps2[50:60] = np.nan
    path, link, out = tmp_path / "six.mcap", tmp_path / "gyro", tmp_path / "out"
    write_session(path, [Session("six", t_s, gyro_dps[:, 2], gyro_dps=gyro_dps, accel_mps2=accel_mps2)])
    with Command("replay", path, "--link", link, "--speed", "max", "--protocol", "native") as replay:
        replay.until_log("waiting for a reader")
        with Command("record", "--port", link, "--out", out) as record:
            assert replay.end() == 0
            record.stop()
    (recorded,) = map(load_session, out.glob("*.mcap"))
    assert recorded.gyro_dps == pytest.approx(gyro_dps, abs=0.0051)
    assert np.array_equal(recorded.rate_dps, recorded.filled("gyro_z_dps"))
    assert recorded.accel_mps2 == pytest.approx(accel_mps2, abs=0.0025, nan_ok=True)
    assert recorded.metadata["device"]["axes"] == "3"
