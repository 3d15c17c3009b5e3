"""Text of people's boards: examples of libraries and habits of sketches, at random rates and paces."""

from collections.abc import Callable
from functools import reduce
from itertools import pairwise
from math import radians, sin
from operator import xor
from random import Random

import pytest

from gyrodrift.columns.guess import TextGuess, guess
from gyrodrift.link.heard import Heard
from gyrodrift.link.protocols.registry import candidates

LINES = 24
COUNTS = 131
Rates = tuple[float, float, float]
Printed = Callable[[int, float, Rates], str]
"""Measurement: its number, its time in s, and the rates about three axes in deg/s."""

LEVEL = "-0.02,0.01,0.99"


def nmea(body: str) -> str:
    return f"${body}*{reduce(xor, body.encode()):02X}\r\n"


def counts(rates: Rates) -> str:
    return " | ".join(f"Gy{axis} = {rate * COUNTS:.0f}" for axis, rate in zip("XYZ", rates, strict=True))


def esphome(name: str, value: float, unit: str) -> str:
    state = f"'MPU6050 {name}': Sending state {value:.5f} {unit} with 2 decimals of accuracy"
    return f"\x1b[0;36m[12:34:56][D][sensor:094]: {state}\x1b[0m\r\n"


SKETCHES: dict[str, Printed] = {
    "Arduino playground, MPU-6050 short sketch": lambda i, t, g: (
        f"AcX = {i % 5} | AcY = -12 | AcZ = 16{i % 9}84 | Tmp = 25.{i % 9} | {counts(g)}\n"
    ),
    "i2cdevlib, MPU6050_raw": lambda i, t, g: (
        f"a/g:\t{i % 7}\t-44\t16384\t{g[0] * COUNTS:.0f}\t{g[1] * COUNTS:.0f}\t{g[2] * COUNTS:.0f}\n"
    ),
    "SparkFun ICM-20948, scaled": lambda i, t, g: (
        f"Scaled. Acc (mg) [ -00012.34, 00001.2{i % 9}, 00999.02 ], "
        f"Gyr (DPS) [ {g[0]:08.2f}, {g[1]:08.2f}, {g[2]:08.2f} ], "
        f"Mag (uT) [ -0012.30, 00015.15, 00041.25 ], Tmp (C) [ 00025.1{i % 9} ]\n"
    ),
    "SparkFun ICM-20948, raw": lambda i, t, g: (
        f"RAW. Acc [ -0012, 00001, 16384 ], Gyr [ {g[0] * COUNTS:05.0f}, {g[1] * COUNTS:05.0f}, "
        f"{g[2] * COUNTS:05.0f} ], Mag [ -0012, 00015, 00041 ], Tmp [ 00312 ]\n"
    ),
    "Adafruit MPU6050, plotter": lambda i, t, g: (
        f"AccelX:0.01,AccelY:0.{i % 9},AccelZ:9.81,GyroX:{g[0]:.2f},GyroY:{g[1]:.2f},GyroZ:{g[2]:.2f}\n"
    ),
    "Adafruit MPU6050, CircuitPython": lambda i, t, g: (
        f"Acceleration: X:0.1{i % 9}, Y: 0.20, Z: 9.81 m/s^2\n"
        f"Gyro X:{radians(g[0]):.4f}, Y: {radians(g[1]):.4f}, Z: {radians(g[2]):.4f} rad/s\nTemperature: 25.10 C\n\n"
    ),
    "MPU6050_light, all data": lambda i, t, g: (
        f"TEMPERATURE: 25.3\nACCELERO  X: 0.0{i % 9}\tY: 0.01\tZ: 0.99\n"
        f"GYRO      X: {g[0]:.2f}\tY: {g[1]:.2f}\tZ: {g[2]:.2f}\n"
        f"ACC ANGLE X: 0.1\tY: 0.2\nANGLE     X: 0.1\tY: 0.2\tZ: {g[2] * t:.2f}\n"
        "=====================================================\n\n"
    ),
    "ESPHome, states of sensors": lambda i, t, g: (
        "".join(esphome(f"Gyro {axis}", rate, "°/s") for axis, rate in zip("XYZ", g, strict=True))
        + esphome("Temperature", 25.1, "°C")
    ),
    "ESPHome, log of the component": lambda i, t, g: (
        f"[12:34:56][D][mpu6050:127]: Got accel={{x=0.1{i % 9} m/s², y=0.000 m/s², z=9.812 m/s²}}, "
        f"gyro={{x={g[0]:.3f} °/s, y={g[1]:.3f} °/s, z={g[2]:.3f} °/s}}, temp=25.123°C\n"
    ),
    "ESP-IDF, log": lambda i, t, g: f"I (12345) mpu6050: gyro x={g[0]:.2f} y={g[1]:.2f} z={g[2]:.2f}\n",
    "MicroPython, a tuple": lambda i, t, g: f"({g[0]:.4f}, {g[1]:.4f}, {g[2]:.4f})\n",
    "MicroPython, tuples with labels": lambda i, t, g: f"Acc: ({LEVEL}) Gyro: ({g[0]:.4f}, {g[1]:.4f}, {g[2]:.4f})\n",
    "MicroPython, a dictionary": lambda i, t, g: (
        f"{{'gyro': {{'x': {g[0]:.4f}, 'y': {g[1]:.4f}, 'z': {g[2]:.4f}}}, 'temp': 25.1, 't_ms': {t * 1e3:.0f}}}\n"
    ),
    "JSON": lambda i, t, g: f'{{"millis":{t * 1e3:.0f},"gx":{g[0]:.3f},"gy":{g[1]:.3f},"gz":{g[2]:.3f}}}\n',
    "JSON with lists": lambda i, t, g: (
        f'{{"ts":{t * 1e6:.0f},"acc":[{LEVEL}],"gyro":[{g[0]:.3f},{g[1]:.3f},{g[2]:.3f}]}}\n'
    ),
    "JSON of a phone": lambda i, t, g: (
        f'{{"sensor":"gyroscope","timestamp":{t * 1e9:.0f},'
        f'"values":{{"x":{g[0]:.3f},"y":{g[1]:.3f},"z":{g[2]:.3f}}}}}\n'
    ),
    "CSV with a header": lambda i, t, g: (
        ("" if i else "time_us,ax,ay,az,gx,gy,gz\n") + f"{t * 1e6:.0f},{LEVEL},{g[0]:.3f},{g[1]:.3f},{g[2]:.3f}\n"
    ),
    "a header below a title": lambda i, t, g: (
        ("" if i else "Gyroscope in degrees/second\nX\tY\tZ\n") + f"{g[0]:.2f}\t{g[1]:.2f}\t{g[2]:.2f}\n"
    ),
    "decimal commas": lambda i, t, g: f"{t * 1e3:.0f};{g[0]:.3f};{g[1]:.3f};{g[2]:.3f}\n".replace(".", ","),
    "labels and units": lambda i, t, g: (
        f"t: {t * 1e3:.0f} ms gx: {g[0]:.2f} deg/s gy: {g[1]:.2f} deg/s gz: {g[2]:.2f} deg/s\n"
    ),
    "a row with units": lambda i, t, g: f"{t:.3f} s, {g[0]:.2f} dps, {g[1]:.2f} dps, {g[2]:.2f} dps\n",
    "Kris Winer's MPU-9250": lambda i, t, g: (
        f"X-acceleration: 12.0{i % 9} mg Y-acceleration: 10.00 mg Z-acceleration: 999.10 mg \n"
        f"X-gyro rate: {g[0]:.1f} degrees/sec Y-gyro rate: {g[1]:.1f} degrees/sec Z-gyro rate: {g[2]:.1f} degrees/sec\n"
        "Temperature is 25.1 degrees C\n"
    ),
    "WitMotion, Arduino": lambda i, t, g: (
        f"Acc:0.0{i % 9} 0.01 0.99\nGyro:{g[0]:.2f} {g[1]:.2f} {g[2]:.2f}\nAngle:0.10 0.20 {g[2] * t:.2f}\n"
    ),
    "ST, mdps": lambda i, t, g: f"Angular rate [mdps]:{g[0] * 1e3:4.2f}\t{g[1] * 1e3:4.2f}\t{g[2] * 1e3:4.2f}\r\n",
    "a sentence of NMEA kind": lambda i, t, g: nmea(f"PIMU,{t * 1e3:.0f},{g[0]:.2f},{g[1]:.2f},{g[2]:.2f}"),
    "bars": lambda i, t, g: f"{t * 1e3:.0f}|{g[0]:.2f}|{g[1]:.2f}|{g[2]:.2f}\n",
    "a word first": lambda i, t, g: f"gyro,{t * 1e3:.0f},{g[0]:.3f},{g[1]:.3f},{g[2]:.3f}\n",
}


REQUEST = {
    "Arduino playground, MPU-6050 short sketch": f"lsb/{COUNTS}",
    "i2cdevlib, MPU6050_raw": f"lsb/{COUNTS}",
    "SparkFun ICM-20948, raw": f"lsb/{COUNTS}",
    "Adafruit MPU6050, plotter": "dps",
    "MPU6050_light, all data": "dps",
    "ESP-IDF, log": "dps",
    "MicroPython, tuples with labels": "dps",
    "MicroPython, a dictionary": "dps",
    "JSON": "dps",
    "JSON with lists": "dps",
    "CSV with a header": "dps",
    "WitMotion, Arduino": "dps",
}
"""Nothing says their unit: this is what a person has to answer."""

UNSAID = {
    "MicroPython, a tuple",
    "JSON of a phone",
    "decimal commas",
    "a sentence of NMEA kind",
    "bars",
    "a word first",
}
"""Nothing says which of their numbers is the yaw rate."""


def found_in(name: str, seed: int) -> tuple[TextGuess, bytes, list[Rates], float]:
    random = Random(seed * 1000 + len(name))
    step_s, begin_s, turn_dps = (
        random.choice((0.005, 0.01, 0.02)),
        random.uniform(1.0, 50.0),
        random.choice((0.0, 60.0)),
    )
    rates = [
        (random.gauss(0.0, 1.0), random.gauss(0.0, 1.0), random.gauss(0.0, 1.0) + turn_dps * sin(i / 5))
        for i in range(LINES)
    ]
    text = "".join(SKETCHES[name](i, begin_s + i * step_s, item) for i, item in enumerate(rates)).encode()
    heard = Heard()
    heard.add(b"the line at which listening began\n" + text, 0.0)
    assert heard.is_text
    result = guess(heard.lines(), text.count(b"\n") / (LINES * step_s))
    assert result is not None
    return result, text, rates, step_s


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", sorted(SKETCHES.keys() - UNSAID))
def test_what_a_board_prints_is_understood(name: str, seed: int) -> None:
    """The columns read the rate about the third axis, and the time where there is one; its unit may be asked for."""
    result, text, rates, step_s = found_in(name, seed)
    assert result.template is not None, [column.looks_like for column in result.columns]
    assert all(column.why for column in result.columns if column.entry != "_")
    assert result.is_unit_known == (name not in REQUEST)
    spec = result.template.replace("UNIT", REQUEST.get(name, "UNIT"))
    (protocol,) = candidates("auto", spec)
    readings = protocol.decoder().push(text)
    assert len(readings) == LINES
    assert [reading.rate_dps for reading in readings] == pytest.approx([item[2] for item in rates], abs=0.06)
    times_us = [reading.t_us for reading in readings if reading.t_us is not None]
    assert bool(times_us) == protocol.has_clock == any(name in spec for name in ("t_us", "t_ms", "t_s", "t_ns"))
    steps_us = [after - before for before, after in pairwise(times_us)]
    assert steps_us == pytest.approx([step_s * 1e6] * len(steps_us), abs=1001.0)


@pytest.mark.parametrize("seed", [1, 2])
@pytest.mark.parametrize("name", sorted(UNSAID))
def test_numbers_without_a_name_and_a_unit_are_asked_for(name: str, seed: int) -> None:
    result, *_ = found_in(name, seed)
    assert result.template is None
    assert result.spec is None


TIMED = {
    "MicroPython, a dictionary": "t_ms",
    "JSON": "t_ms",
    "JSON with lists": "t_us",
    "JSON of a phone": "t_ns",
    "CSV with a header": "t_us",
    "a row with units": "t_s",
}


@pytest.mark.parametrize("name", TIMED)
def test_the_clock_is_found(name: str) -> None:
    lines = "".join(SKETCHES[name](i, 3.0 + i / 100, (0.1, 0.2, sin(i))) for i in range(LINES)).splitlines()
    result = guess(lines, 100.0)
    assert result is not None
    assert TIMED[name] in [column.entry for column in result.columns]


@pytest.mark.parametrize("line", ["a" * 700 + ":", "[a:" * 230 + "]", "a b " * 170 + "=", "a=[" * 230, "1 " * 380])
def test_a_long_line_of_junk_makes_no_rate(line: str) -> None:
    """Nor is it believed to be a row of values."""
    (protocol,) = candidates("text", "gz=rate")
    assert protocol.decoder().push(f"{line}\n".encode() * 5) == []
