"""`gyrodrift serve` at boards of other people: it proposes what something says, and asks for everything else."""

import select
from collections.abc import Callable
from contextlib import closing
from itertools import count
from math import radians
from pathlib import Path
from random import Random
from typing import NamedTuple

import pytest
from support import PATIENCE_S, never, speaking_on

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.values.errors import DeviceSilentError

LINE_S = 0.02


class Motion(NamedTuple):
    """One moment: number of the line, time in s, rates in deg/s, accelerations in g, and yaw in degrees."""

    i: int
    t_s: float
    x: float
    y: float
    z: float
    ax: float
    ay: float
    az: float
    yaw: float


def motion(i: int, dice: Random) -> Motion:
    """At rest, level, with a bias of 0.5 deg/s; yaw is where it has been left."""
    x, y, z = (dice.gauss(mean, 0.05) for mean in (0.3, -0.8, 0.5))
    ax, ay, az = (dice.gauss(mean, 0.003) for mean in (0.01, -0.02, 0.995))
    return Motion(i, LINE_S * i, x, y, z, ax, ay, az, 170.0)


Printed = Callable[[Motion], str]
PROPOSED: dict[str, tuple[Printed, str]] = {
    "accelerations in m/s² beside rates of two digits": (
        lambda m: (
            f"AccelX:{9.81 * m.ax:.2f},AccelY:{9.81 * m.ay:.2f},AccelZ:{9.81 * m.az:.2f}, "
            f"GyroX:{radians(m.x):.2f},GyroY:{radians(m.y):.2f},GyroZ:{radians(m.z):.2f}\r\n"
        ),
        "AccelX=ax:mps2, AccelY=ay:mps2, AccelZ=az:mps2, GyroX=gx:rads, GyroY=gy:rads, GyroZ=rate:rads",
    ),
    "a degree sign of Latin-1": (lambda m: f"Gx: {m.x:.2f}\xb0/s\tGz: {m.z:.2f}\xb0/s\r\n", "Gz=rate:dps"),
    "a line with a pace in Hz": (
        lambda m: (
            f"a(x,y,z) {1e3 * m.ax:.2f} {1e3 * m.ay:.2f} {1e3 * m.az:.2f} [mg] g(x,y,z) {m.x:.2f} {m.y:.2f} {m.z:.2f} "
            f"[dps] o(y,p,r) {m.yaw:.2f} -0.37 5.95 rate = {943 + m.x:.2f} Hz\r\n"
        ),
        "a x=ax:mg, a y=ay:mg, a z=az:mg, g x=gx:dps, g y=gy:dps, g z=rate:dps",
    ),
    "angles, and a pace in Hz in turns": (
        lambda m: f"rate = {735 + m.x:.2f} Hz\r\nYaw, Pitch, Roll: {m.yaw:.2f}, 0.18, -178.11\r\n",
        "Yaw=yaw:deg",
    ),
    "known firmware behind a #": (
        lambda m: f"#YPRAG={-m.yaw:.2f},-0.48,1.51,2,-6,-255,{radians(m.x):.4f},0.01,{-radians(m.z):.4f}\r\n",
        "YPRAG 9=rate:rads:-",
    ),
    "the example that all copy": (lambda m: f"ypr\t{m.yaw:.2f}\t0.53\t-1.20\r\n", "ypr x=yaw:deg"),
    "a heading above its values, in dps": (
        lambda m: f"Accelerometer (g):\r\n Z = {m.az:.4f}\r\nGyroscope (dps):\r\n X = {m.x:.4f}\r\n Z = {m.z:.4f}\r\n",
        "Gyroscope (dps) Z=rate:dps",
    ),
}

UNIT_ASKED: dict[str, tuple[Printed, str]] = {
    "lines that end in CR": (lambda m: f"gx={m.x:.2f},gy={m.y:.2f},gz={m.z:.2f}\r", "gz=rate:UNIT"),
    "lines that differ by their first word": (
        lambda m: (
            f"Orient:\tx= {m.yaw:.2f} |\ty= 0.12 |\tz= -1.31\r\nGyro:\tx= {m.x:.2f} |\ty= {m.y:.2f} |\tz= {m.z:.2f}\r\n"
            "Linear:\tx= 0.01 |\ty= -0.02 |\tz= 0.00\r\n\r\ntemperature: 25\r\n--\r\n"
        ),
        "Gyro z=rate:UNIT",
    ),
    "one value a line under a heading": (
        lambda m: (
            f"Gyroscope:\r\n X = {m.x:.4f}\r\n Y = {m.y:.4f}\r\n Z = {m.z:.4f}\r\n\r\n"
            "Thermometer:\r\n Degrees C = 25.1\r\n"
        ),
        "Gyroscope Z=rate:UNIT",
    ),
    "Teleplot with times": (
        lambda m: f">gx:{1000 * m.t_s:.0f}:{m.x:.2f}\r\n>gz:{1000 * m.t_s:.0f}:{m.z:.2f}\r\n",
        "gz=rate:UNIT",
    ),
    "JSON of a kilobyte": (
        lambda m: f'{{"gz":{m.z:.3f},{",".join(f"{chr(34)}ch{n}{chr(34)}:{n}.5" for n in range(90))}}}\r\n',
        "gz=rate:UNIT",
    ),
    "counts": (lambda m: f"gx:{131 * m.x:.0f} gy:{131 * m.y:.0f} gz:{131 * m.z:.0f}\r\n", "gz=rate:UNIT"),
}

REQUEST: dict[str, Printed] = {
    "marks around three numbers": lambda m: f"<{m.x:.2f},{m.y:.2f},{m.z:.2f}>\r\n",
    "three axes behind a clock": lambda m: f"{2_000_000 + 20_000 * m.i},{m.x:.3f},{m.y:.3f},{m.z:.3f}\r\n",
    "raw counts": lambda m: f"{430 + int(131 * m.x)},{int(131 * m.y)},{int(131 * m.z)}\r\n",
    "whole seconds of Unix time": lambda m: f"{1_700_000_000 + m.i // 50},{m.x:.2f},{m.y:.2f},{m.z:.2f}\r\n",
    "accelerations in counts before rates": lambda m: (
        f"{256 * m.ax:.0f}\t{256 * m.ay:.0f}\t{256 * m.az:.0f}\t{m.x:.2f}\t{m.y:.2f}\t{m.z:.2f}\r\n"
    ),
    "angles by axis": lambda m: f"X : 0.10\tY : 0.20\tZ : {m.yaw:.2f}\r\n",
    "date, time and many columns": lambda m: (
        f"07/01/2020,13:35:{41 + m.t_s:05.2f},{1e3 * m.ax:.2f},{1e3 * m.ay:.2f},{1e3 * m.az:.2f},"
        f"{m.x:.2f},{m.y:.2f},{m.z:.2f},8.25,32.55,-63.60,29.70,{10 + m.x / 10:.2f},\r\n"
    ),
    "seconds of two digits": lambda m: f"{m.t_s / 4:.2f},{m.x:.2f},{m.y:.2f},{m.z:.2f}\r\n",
}


def statement(port: Path, printed: Printed) -> str:
    dice, now_s = Random(1), [100.0]

    def hear(link: Link) -> None:
        for number in count():
            assert device.send_all(printed(motion(number, dice)).encode("latin-1"), never)
            fd = link.fileno()
            assert fd is not None
            select.select([fd], [], [], PATIENCE_S)
            assert link.read() == []
            now_s[0] += LINE_S

    with speaking_on(port) as device:
        link = Link(LinkOptions(str(port), baud=115200, timeout_s=3.0), lambda _, **__: None, lambda: now_s[0])
        device.wait_for_reader(never)
        with closing(link), pytest.raises(DeviceSilentError) as raised:
            hear(link)
    return str(raised.value)


@pytest.mark.parametrize("name", PROPOSED)
def test_what_something_says_is_proposed_with_its_unit(port: Path, name: str) -> None:
    printed, columns = PROPOSED[name]
    assert f"--columns '{columns}'" in statement(port, printed)


@pytest.mark.parametrize("name", UNIT_ASKED)
def test_a_unit_that_nothing_says_is_asked_for(port: Path, name: str) -> None:
    printed, columns = UNIT_ASKED[name]
    report = statement(port, printed)
    assert f"{columns}'" in report
    assert f"gyrodrift doctor --port {port} --turn" in report


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("name", REQUEST)
def test_what_no_number_is_said_to_be_is_asked_for(port: Path, name: str) -> None:
    """A number without a name leads to a question."""
    report = statement(port, REQUEST[name])
    assert "none of them is known to be the yaw rate" in report
    assert f"gyrodrift doctor --port {port} --turn" in report
    assert "--columns '" not in report
