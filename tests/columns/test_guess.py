"""Columns of unknown text: sketches and examples of libraries, line by line."""

import re
from collections.abc import Callable
from math import cos, sin
from pathlib import Path
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.columns.guess import guess
from gyrodrift.columns.naming import rules
from gyrodrift.link.protocols.registry import candidates

LINES = 20
NOISE = Random(3)


def n(sigma: float) -> float:
    return NOISE.gauss(0.0, sigma)


def accelerations(i: int) -> str:
    return f"{int(n(50))},{int(n(50))},{16384 + int(n(50))}"


STATEMENT: dict[str, tuple[Callable[[int], str], str, str]] = {
    "Adafruit, MPU6050 basic readings": (
        lambda i: (
            f"Acceleration X: {n(0.1):.2f}, Y: 0.10, Z: 9.81 m/s^2\n"
            f"Rotation X: {n(0.1):.2f}, Y: 0.00, Z: {n(0.1):.2f} rad/s\nTemperature: 25.10 degC\n"
        ),
        "gx, gy, gz",
        "Rotation X=gx:rads, Rotation Y=gy:rads, Rotation Z=rate:rads",
    ),
    "accelerations and rates in one line": (
        lambda i: f"a(x,y,z) 1 2 999 [mg] g(x,y,z) 1 2 {n(1):.2f} [dps] o(y,p,r) 1 2 3 rate = {700 + n(9):.2f} Hz",
        "ax, ay, az, gx, gy, gz, angle, angle, angle, rates",
        "a x=ax:mg, a y=ay:mg, a z=az:mg, g x=gx:dps, g y=gy:dps, g z=rate:dps",
    ),
    "one axis, named with its unit": (
        lambda i: f"t_ms:{10 * i},rate_dps:{n(1):.2f}",
        "t_ms, gz",
        "t_ms=t_ms, rate_dps=rate:dps",
    ),
    "Razor AHRS": (
        lambda i: f"#YPRAG=-170.00,-0.48,1.51,1.94,-6.46,-255.02,0.01,0.02,{n(0.01):.4f}",
        "_, yaw, pitch, roll, ax, ay, az, gx, gy, gz",
        "YPRAG 9=rate:rads:-",
    ),
    "values under a heading": (
        lambda i: (
            f"Accelerometer (g):\n X = 0.1\n Y = 0.2\n Z = 0.9\n\nGyroscope (dps):\n X = 1\n Y = 2\n Z = {n(1):.3f}\n"
        ),
        "gz",
        "Gyroscope (dps) Z=rate:dps",
    ),
    "lines that differ by their first word": (
        lambda i: f"accel 1 2 3\ngyro_dps 1 2 {n(1):.2f}\nmag 4 5 6",
        "_, gx, gy, gz",
        "gyro_dps x=gx:dps, gyro_dps y=gy:dps, gyro_dps z=rate:dps",
    ),
    "Teleplot with times": (
        lambda i: f">gx:{20 * i}:1§dps\n>gz:{20 * i}:{n(1):.2f}§dps",
        "t_ms, gz",
        "t_ms=t_ms, gz=rate:dps",
    ),
    "yaw, pitch and roll": (
        lambda i: f"Yaw, Pitch, Roll: 170.{i % 9}, 0.18, -178.1",
        "yaw, pitch, roll",
        "Yaw=yaw:deg",
    ),
    "a compass": (lambda i: f"heading: {200 + n(1):.1f}", "heading", "heading=yaw:deg:-"),
}


@pytest.mark.parametrize("name", STATEMENT)
def test_columns_that_something_names_can_be_pasted(name: str) -> None:
    line, looks, spec = STATEMENT[name]
    text = "\n".join(line(i) for i in range(LINES)) + "\n"
    result = guess(text.splitlines(), 100.0 * text.count("\n") / LINES)
    assert result is not None
    assert (", ".join(column.looks_like for column in result.columns), result.spec) == (looks, spec)
    assert all(column.why for column in result.columns if column.entry != "_")
    (protocol,) = candidates("auto", spec)
    assert len(protocol.decoder().push(text.encode())) == LINES


UNIT_ASKED: dict[str, tuple[Callable[[int], str], str]] = {
    "serial plotter": (lambda i: f"gx:{n(1):.2f},gy:{n(1):.2f},gz:{n(1):.2f}", "gz=rate:UNIT"),
    "counts": (lambda i: f"gx:{int(n(20))},gy:{int(n(20))},gz:{int(n(20))}", "gz=rate:UNIT"),
    "JSON": (lambda i: f'{{"t":{10_000 * i},"gyro":{{"x":1,"y":2,"z":{n(1):.3f}}}}}', "t=t_us, gyro.z=rate:UNIT"),
    "degrees of a rate": (lambda i: f"gz: {n(1):.2f} deg", "gz=rate:UNIT"),
    "i2cdevlib, MPU6050_raw": (
        lambda i: f"a/g:\t{16000 + int(n(50))}\t{int(n(50))}\t300\t{int(n(20))}\t{int(n(20))}\t{int(n(20))}",
        "a/g 6=rate:UNIT",
    ),
    "an angle since the last line": (lambda i: f"dtheta_z: {n(0.1):.3f}", "dtheta_z=delta:UNIT"),
    "a quaternion that may be in another order": (
        lambda i: f"q0:1.0 q1:0.{i % 9} q2:0.0 q3:0.1",
        "q0=q.w, q1=q.x, q2=q.y, q3=q.z",
    ),
    "a small yaw": (lambda i: f"yaw: {n(0.1):.3f}", "yaw=yaw:UNIT"),
}


@pytest.mark.parametrize("name", UNIT_ASKED)
def test_a_unit_that_nothing_says_is_asked_for(name: str) -> None:
    line, template = UNIT_ASKED[name]
    result = guess([line(i) for i in range(LINES)], 100.0)
    assert result is not None
    assert (result.spec if "UNIT" in template else None, result.template) == (None, template)
    assert not result.is_stated


UNNAMED: dict[str, Callable[[int], str]] = {
    "three numbers": lambda i: f"{n(1):.2f},{n(1):.2f},{n(1):.2f}",
    "counts and a clock": lambda i: f"{1000 + 10 * i},{int(n(20))},{int(n(20))},{int(n(20))}",
    "the one axis that turns": lambda i: f"{10 * i},{90 * sin(i):.1f},{n(0.1):.1f},{n(0.1):.1f}",
    "six columns": lambda i: f"{accelerations(i)},{int(n(20))},{int(n(20))},{int(n(20))}",
    "rate and angle": lambda i: f"{10 * i},{cos(i / 5):.3f},{sin(i / 5) / 20:.5f}",
    "one number": lambda i: f"{n(1):.2f}",
    "angles by axis": lambda i: f"X : {n(1):.2f}\tY : 0.20\tZ : {90 * sin(i / 9):.2f}",
    "a pace": lambda i: f"rate = {700 + n(9):.2f} Hz",
    "accelerations": lambda i: f"AcX: 1 AcY: {n(1):.2f} AcZ: 0.98",
    "a battery and a temperature": lambda i: f"battery: 3.7 V temp: 25.{i % 4}",
}


@pytest.mark.parametrize("name", UNNAMED)
def test_numbers_that_nothing_names_are_no_rate(name: str) -> None:
    line = UNNAMED[name]
    result = guess([line(i) for i in range(LINES)], 100.0)
    assert result is not None
    assert (result.spec, result.template) == (None, None)


@pytest.mark.promise("Text and units")
@given(
    st.lists(st.sampled_from(["noise", "level", "grows", "turns", "whole"]), min_size=1, max_size=9), st.integers(0, 99)
)
def test_no_mix_of_columns_without_labels_gives_a_rate(kinds: list[str], seed: int) -> None:
    """Without labels, no mix of columns gives a rate."""
    dice = Random(seed)
    values: dict[str, Callable[[int], str]] = {
        "noise": lambda i: f"{dice.gauss(0.5, 0.1):.3f}",
        "level": lambda i: f"{dice.gauss(9.81, 0.01):.2f}",
        "grows": lambda i: f"{10 * i}",
        "turns": lambda i: f"{90 * sin(i / 3):.1f}",
        "whole": lambda i: f"{dice.randrange(-500, 500)}",
    }
    mark = dice.choice([",", ";", "\t", " ", "|"])
    result = guess([mark.join(values[kind](i) for kind in kinds) for i in range(LINES)], 100.0)
    assert result is None or result.template is None


RATE_UNITS = {"dps": "deg/s", "rads": "rad/s", "mdps": "mdps", "mrads": "mrad/s", "lsb/60": "deg/min"}


@pytest.mark.promise("Text and units")
@given(
    st.sampled_from(["gz", "Gyro Z", "gyro_z", "yaw_rate", "wz", "GyroZ"]),
    st.sampled_from([None, *RATE_UNITS]),
    st.floats(0.01, 300.0),
    st.integers(0, 99),
)
def test_a_unit_never_passes_as_another(label: str, option: str | None, size: float, seed: int) -> None:
    """No unit is taken for another unit."""
    dice = Random(seed)
    written = RATE_UNITS[option] if option else ""
    result = guess([f"{label}: {dice.gauss(0.0, size):.3f} {written}".strip() for _ in range(LINES)], 100.0)
    assert result is not None
    assert result.turn is not None
    assert result.turn.entry in ({f"rate:{option}"} if option else {"rate:UNIT", "rate:rads"})


def test_names_above_the_columns_are_heeded() -> None:
    """Wherever the rate stands, and in what unit."""
    lines = ["time_ms,yaw_rate_rad_s,temperature", *(f"{10 * i},{n(0.01):.4f},{20 + i % 3}" for i in range(9))]
    result = guess(lines)
    assert result is not None
    assert result.spec == "t_ms, rate:rads, temp"


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
    result = guess([f"{step * i},{n(1):.2f}" for i in range(LINES)], lines_per_s)
    assert result is not None
    assert result.meaning(0) == unit


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
    assert guess(lines) is None


def test_a_temperature_in_counts_is_left_out() -> None:
    result = guess([f"gz_dps={n(1):.2f} temp={-3600 - i}" for i in range(9)])
    assert result is not None
    assert result.spec == "gz_dps=rate:dps"


def test_a_turn_of_one_radian_per_second_is_no_gravity() -> None:
    lines = [
        f"AccelX:0.10,AccelY:-0.20,AccelZ:{9.77 + n(0.02):.2f},"
        f"GyroX:0.01,GyroY:-0.01,GyroZ:{1.05 if i > 120 else 0.01:.2f}"
        for i in range(400)
    ]
    result = guess(lines, 80.0)
    assert result is not None
    forces = "AccelX=ax:mps2, AccelY=ay:mps2, AccelZ=az:mps2"
    assert result.spec == f"{forces}, GyroX=gx:rads, GyroY=gy:rads, GyroZ=rate:rads"


def test_an_imu_message_of_ros_as_json_gives_all_axes() -> None:
    force, rate = '"linear_acceleration":{"x":0.1,"y":-0.2,"z":%.3f}', '"angular_velocity":{"x":0.01,"y":0.02,"z":%.4f}'
    covariance = '"angular_velocity_covariance":[0,0,0,0,0,0,0,0,0]'
    head = '{"op":"publish","topic":"/imu","msg":{"orientation":{"x":0,"y":0,"z":0,"w":1}'
    line = f"{head},{rate},{covariance},{force}}}}}"
    guessed = guess([line % (0.5 + n(0.01), 9.8 + n(0.02)) for _ in range(100)], 100.0)
    assert guessed is not None
    assert guessed.spec == ", ".join(
        [f"msg.angular_velocity.{axis}={kind}:rads" for axis, kind in zip("xyz", ("gx", "gy", "rate"), strict=True)]
        + [f"msg.linear_acceleration.{axis}=a{axis}:mps2" for axis in "xyz"]
    )


@pytest.mark.parametrize(
    ("angle", "unit", "per_dps", "sign"),
    [
        ("heading", "deg", 1.0, ":-"),
        ("yaw", "deg", 1.0, ""),
        ("heading", "rad", 57.29578, ":-"),
        ("yaw", "deg", 57.29578, ""),
    ],
)
def test_an_angle_beside_a_rate_tells_its_unit_and_its_sign(angle: str, unit: str, per_dps: float, sign: str) -> None:
    rates = [40.0 * (60 <= i < 140) + n(0.2) for i in range(300)]
    lines, turned = [f"t_ms,yawRate,{angle}"], 100.0
    for i, rate in enumerate(rates):
        turned += rate * 0.02
        shown = turned % 360.0 / (57.29578 if unit == "rad" else 1.0)
        lines.append(f"{20 * i},{rate / per_dps:.5f},{shown:.4f}")
    result = guess(lines)
    assert result is not None
    assert result.template == f"t_ms, rate:{'dps' if per_dps == 1.0 else 'rads'}{sign}"


SENDERS: dict[str, tuple[Callable[[int], str], str, str]] = {
    "nodes as objects": (
        lambda i: f'{{"id": {1 + i % 2}, "gz_dps": {n(1):.3f}}}',
        "id=WHICH, gz_dps=rate:dps",
        "WHICH by the sender that you mean (1, 2)",
    ),
    "rows of a gyro and an accelerometer": (
        lambda i: f'{{"sensor": "{("ACC", "GYRO")[i % 2]}", "t_ms": {10 * i}, "z": {n(1):.3f}}}',
        "sensor=GYRO, t_ms=t_ms, z=rate:UNIT",
        "UNIT by dps, rads, mdps or lsb/N",
    ),
}


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("name", SENDERS)
def test_of_several_senders_one_is_asked_for(name: str) -> None:
    """The proposal asks for one of several senders in a stream; their rates are never mixed."""
    line, template, asked = SENDERS[name]
    result = guess([line(i) for i in range(60)], 100.0)
    assert result is not None
    assert (result.template, result.spec, result.missing) == (template, None, (asked,))


@pytest.mark.parametrize(
    "line",
    [
        lambda i: f"imu1 gz: {n(1):.3f} dps imu2 gz: {n(1):.3f} dps",
        lambda i: f"t_ms: {1000 + 20 * (i // 2) + 7 * (i % 2)} gz: {n(0.1) + 5 * (i % 2):.3f} dps",
    ],
    ids=["in one line", "without a name"],
)
def test_two_gyros_without_a_key_are_a_question(line: Callable[[int], str]) -> None:
    result = guess([line(i) for i in range(60)], 100.0)
    assert result is not None
    assert (result.template, result.question != "") == (None, True)


def test_the_page_has_all_rules_with_their_reasons() -> None:
    page = (Path(__file__).parents[2] / "docs" / "protocols.md").read_text()
    reasons = re.findall(r"^\| [a-z ]+ \| ([A-Z].*\.) \|$", page, re.MULTILINE)
    assert reasons == [rule.why for rule in rules(None)]
