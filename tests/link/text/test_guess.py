"""What an unknown text holds: sketches and examples of libraries, line by line as they print."""

from collections.abc import Callable
from math import cos, sin
from random import Random

import pytest

from gyrodrift.link.protocols.registry import candidates
from gyrodrift.link.text.guess import guess

LINES = 20
NOISE = Random(3)


def n(sigma: float) -> float:
    return NOISE.gauss(0.0, sigma)


def accelerations(i: int) -> str:
    return f"{int(n(50))},{int(n(50))},{16384 + int(n(50))}"


SKETCHES: dict[str, tuple[Callable[[int], str], str, str]] = {
    "raw counts": (
        lambda i: f"{1000 + 10 * i},{int(n(20))},{int(n(20))},{int(n(20))}",
        "t_ms, gx, gy, gz",
        "t_ms, _, _, rate:lsb/131",
    ),
    "serial plotter": (lambda i: f"gx:{n(1):.2f},gy:{n(1):.2f},gz:{n(1):.2f}", "gx, gy, gz", "gz=rate"),
    "JSON": (
        lambda i: f'{{"t":{10_000 * i},"gyro":{{"x":1,"y":2,"z":{n(1):.3f}}}}}',
        "t_us, gx, gy, gz",
        "t=t_us, gyro.z=rate",
    ),
    "i2cdevlib, MPU6050_raw": (
        lambda i: f"a/g:\t{16000 + int(n(50))}\t{int(n(50))}\t300\t{int(n(20))}\t{int(n(20))}\t{int(n(20))}",
        "_, ax, ay, az, gx, gy, gz",
        "_, _, _, _, _, _, rate:lsb/131",
    ),
    "six columns, told by gravity": (
        lambda i: f"{accelerations(i)},{int(n(20))},{int(n(20))},{int(n(20))}",
        "ax, ay, az, gx, gy, gz",
        "_, _, _, _, _, rate:lsb/131",
    ),
    "Adafruit, MPU6050 basic readings": (
        lambda i: (
            f"Acceleration X: {n(0.1):.2f}, Y: 0.10, Z: 9.81 m/s^2\n"
            f"Rotation X: {n(0.1):.2f}, Y: 0.00, Z: {n(0.1):.2f} rad/s\nTemperature: 25.10 degC\n"
        ),
        "gx, gy, gz",
        "Rotation Z=rate:rads",
    ),
    "seconds and a temperature": (
        lambda i: f"{i / 100:.2f} {n(0.1):.3f} 25.{i % 4}",
        "t_s, gz, temp",
        "t_s, rate, temp",
    ),
    "rate and angle": (
        lambda i: f"{10 * i},{cos(i / 5):.3f},{sin(i / 5) / 20:.5f}",
        "t_ms, gz, encoder",
        "t_ms, rate, encoder",
    ),
    "the one axis that turns": (
        lambda i: f"{10 * i},{90 * sin(i):.1f},{n(0.1):.1f},{n(0.1):.1f}",
        "t_ms, gx, gy, gz",
        "t_ms, rate",
    ),
    "rate alone": (lambda i: f"{n(1):.2f}", "gz", "rate"),
    "counter": (lambda i: f"{i},{n(1):.2f}", "seq, gz", "seq, rate"),
}


@pytest.mark.parametrize("name", SKETCHES)
def test_columns_are_found_and_can_be_pasted(name: str) -> None:
    """From twenty lines that came at 100 Hz; read by what was found, every line but the held first ones is a sample."""
    line, looks, spec = SKETCHES[name]
    text = "\n".join(line(i) for i in range(LINES)) + "\n"
    lines_per_s = 100.0 * text.count("\n") / LINES
    found = guess(text.splitlines(), lines_per_s)
    assert found is not None
    assert (", ".join(column.said for column in found.columns), found.spec) == (looks, spec)
    assert all(column.why for column in found.columns if column.entry != "_")
    (protocol,) = candidates("auto", found.spec)
    assert len(protocol.decoder().push(text.encode())) == LINES


def test_names_above_the_columns_are_heeded() -> None:
    """Wherever the rate stands, and in what unit."""
    lines = ["time_ms,yaw_rate_rads,temperature", *(f"{10 * i},{n(0.01):.4f},{20 + i % 3}" for i in range(9))]
    found = guess(lines)
    assert found is not None
    assert found.spec == "t_ms, rate:rads, temp"


@pytest.mark.parametrize(
    ("step", "lines_per_s", "unit"),
    [
        (10, 100.0, "t_ms"),
        (10_000, 100.0, "t_us"),
        (1, 1000.0, "t_ms"),
        (1000, 1000.0, "t_us"),
        (10_000_000, 100.0, "t_ns"),
        (5, None, "t_ms"),
        (5000, None, "t_us"),
    ],
)
def test_the_unit_of_a_clock_is_told_from_its_pace(step: int, lines_per_s: float | None, unit: str) -> None:
    """Or, where that is unknown, from the size of its steps."""
    found = guess([f"{step * i},{n(1):.2f}" for i in range(LINES)], lines_per_s)
    assert found is not None
    assert found.meaning(0) == unit


@pytest.mark.parametrize(
    "lines",
    [
        [],
        ["Initializing I2C devices...", "Testing device connections...", "MPU6050 connection failed"] * 5,
        [
            "ets Jun  8 2016 00:22:57",
            "rst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)",
            "mode:DIO, clock div:1",
        ],
    ],
    ids=["nothing", "messages", "boot loader"],
)
def test_messages_for_people_have_no_columns(lines: list[str]) -> None:
    """However often they come."""
    assert guess(lines) is None


def test_angles_alone_are_no_rate() -> None:
    """A device that works out yaw by itself has to be told to send rates."""
    found = guess([f"ypr\t{n(1):.2f}\t{n(1):.2f}\t{n(1):.2f}" for _ in range(9)])
    assert found is not None
    assert found.spec is None
    assert [column.said for column in found.columns] == ["_", "yaw", "pitch", "roll"]


def test_a_temperature_in_counts_is_left_out() -> None:
    """It would be taken for °C."""
    found = guess([f"gz={n(1):.2f} temp={-3600 - i}" for i in range(9)])
    assert found is not None
    assert found.spec == "gz=rate"
