"""Columns that are no rate are contradicted at the first turn, and turntables of all kinds are not."""

from collections.abc import Callable
from math import degrees, nan, radians, sin
from random import Random

import pytest

from gyrodrift.columns.shape import RateShape
from gyrodrift.values.sample import Sample

HZ = 50
Column = Callable[[float, float, float, Random], float]
"""Value of a column by time, yaw and true rate."""


def judged(
    true_dps: Callable[[float], float], column: Column, third: Column | None = None, seconds: int = 30
) -> RateShape:
    noise, shape, yaw_deg, samples = Random(3), RateShape(), 0.0, []
    for i in range(seconds * HZ):
        t_s = i / HZ
        rate_dps = true_dps(t_s)
        angle = nan if third is None else third(t_s, yaw_deg, rate_dps, noise)
        samples.append(Sample(i, t_s, t_s, column(t_s, yaw_deg, rate_dps, noise), angle))
        yaw_deg += rate_dps / HZ
    for start in range(0, len(samples), 7):
        shape.take(samples[start : start + 7])
    return shape


def turn(t_s: float) -> float:
    return max(0.0, min(60.0, 240.0 * (t_s - 5.0), 240.0 * (8.0 - t_s)))


def wrapped(yaw_deg: float) -> float:
    return (yaw_deg + 180.0) % 360.0 - 180.0


def gyro(_: float, __: float, rate_dps: float, noise: Random) -> float:
    return round(rate_dps + noise.gauss(0.5, 0.05), 3)


NO_RATES: dict[str, tuple[Column, Column | None]] = {
    "heading": (lambda _, yaw, __, ___: round(wrapped(yaw + 20.0), 2), None),
    "radians": (lambda _, yaw, __, ___: round(radians(yaw), 4), None),
    "part of a quaternion": (lambda _, yaw, __, ___: round(sin(radians(0.5 * yaw)), 4), None),
    "potentiometer": (lambda _, yaw, __, noise: float(round(512.0 + 3.0 * yaw + noise.gauss(0.0, 1.0))), None),
    "pressure": (lambda _, __, ___, noise: round(101325.0 + noise.gauss(0.0, 3.0), 2), None),
    "angle, and its rate": (lambda _, yaw, __, ___: round(yaw, 2), gyro),
    "other axis, and an angle": (
        lambda _, __, ___, noise: round(noise.gauss(0.3, 0.05), 2),
        lambda _, yaw, __, ___: yaw,
    ),
}


@pytest.mark.parametrize("name", NO_RATES)
def test_what_is_no_rate_is_contradicted(name: str) -> None:
    assert judged(turn, *NO_RATES[name]).contradiction


@pytest.mark.parametrize("name", ["compass", "light"])
def test_a_noisy_level_that_stays_is_told_and_asked_in_a_recording(name: str) -> None:
    at_rest = {"compass": 20.0, "light": 300.0}[name]
    shape = judged(turn, lambda _, yaw, __, noise: at_rest + yaw + noise.gauss(0.0, 1.0), seconds=60)
    assert (shape.contradiction, bool(shape.doubt), bool(shape.unreturned)) == ("", True, True)


TABLES: dict[str, Callable[[float], float]] = {
    "rest": lambda _: 0.0,
    "turn": turn,
    "always": lambda _: 200.0,
    "from rest for minutes": lambda t_s: min(90.0, max(0.0, 45.0 * (t_s - 5.0))),
    "to and fro within a sample": lambda t_s: 180.0 if t_s % 4.0 < 2.0 else -180.0,
    "stairs": lambda t_s: 20.0 * (t_s // 6.0),
    "slow": lambda t_s: 3.0 if t_s > 5.0 else 0.0,
    "oscillation": lambda t_s: 60.0 * sin(2.0 * t_s),
}
SENSORS: dict[str, Column] = {
    "gyro": gyro,
    "biased": lambda t_s, __, rate, noise: round(rate + 12.0 + 0.03 * t_s + noise.gauss(0.0, 0.1), 2),
    "fiber-optic": lambda _, __, rate, noise: round(rate + noise.gauss(0.0, 0.01), 4),
    "held": lambda _, __, rate, noise: round(rate + noise.gauss(0.0, 0.1), 2) if abs(rate) > 1.0 else 0.0,
}


@pytest.mark.parametrize("sensor", SENSORS)
@pytest.mark.parametrize("table", TABLES)
def test_no_gyro_on_a_turntable_is_contradicted(table: str, sensor: str) -> None:
    assert judged(TABLES[table], SENSORS[sensor], seconds=90).contradiction == ""
    with_encoder = judged(TABLES[table], SENSORS[sensor], lambda _, yaw, __, ___: round(wrapped(yaw), 1))
    assert with_encoder.contradiction == ""


def test_an_encoder_that_follows_proves_the_rate_in_any_unit() -> None:
    assert judged(turn, gyro, lambda _, yaw, __, ___: yaw).is_over
    assert judged(turn, lambda *values: degrees(gyro(*values)), lambda _, yaw, __, ___: yaw).is_over
