"""A unit of rates alone does not make the yaw rate: labels may say another quantity, another axis or another scale."""

from random import Random

import pytest

from gyrodrift.columns.fields import fields_of
from gyrodrift.columns.guess import TextGuess, guess

LINES_PER_S = 100.0


def guessed(form: str, head: str = "") -> TextGuess:
    noise = Random(5)
    lines = [
        form.format(
            x=noise.gauss(1, 0.3), y=noise.gauss(2, 0.3), z=noise.gauss(3, 0.3), t=5000 + 10 * i, w=25 + i / 5000
        )
        for i in range(40)
    ]
    item = len(lines[0].split("\n"))
    result = guess([head, *"\n".join(lines).split("\n")], LINES_PER_S * item)
    assert result is not None
    return result


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize(
    "form",
    [
        "gz_bias: {z:.3f} deg/s",
        "bias gz: {z:.3f} deg/s",
        "gyro_bias_z={z:.3f} rad/s",
        "gyro_bias: {x:.3f} {y:.3f} {z:.3f} dps",
        "yaw_rate_setpoint (deg/s): {z:.2f}",
        "yaw_sp: {z:.2f} dps",
        "gyro z rms [dps]: {z:.3f}",
        "max gz: {z:.2f} dps",
        "noise: {z:.3f} dps",
        "drift: {z:.3f} deg/min",
        "motor: {z:.0f} rpm",
        "servo: {z:.1f} deg/s",
        "vel_sp: {x:.1f} deg/s, vel: {y:.1f} deg/s, err: {z:.1f} deg/s",
        "Setpoint: roll={x:.2f} pitch={y:.2f} yaw={z:.2f}",
        "Setpoint: roll={x:.2f} pitch={y:.2f} yaw={z:.2f} deg/s",
        "Bias: gx={x:.2f} gy={y:.2f} gz={z:.2f} dps",
        "IMU bias: gx={x:.2f} gy={y:.2f} gz={z:.2f} dps",
        "roll: {z:.2f} deg/s",
        "500 dps | {x:.0f} | {y:.0f} | {z:.0f}",
        "{t}; {z:.0f}; 200 dps",
        "rotationX: {x:.2f} rotationY: {y:.2f} rotationZ: {z:.2f}",
        "rotation z: {z:.2f} deg",
        "gyro[0]: {x:.2f} dps, gyro[1]: {y:.2f} dps",
    ],
)
def test_a_unit_of_rates_does_not_stand_against_what_a_label_says(form: str) -> None:
    """A unit of rate does not make a yaw rate if the label names another quantity (`gz_bias`, set points, motors)."""
    result = guessed(form)
    assert result.template is None, result.template


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize(
    ("head", "form", "spec"),
    [
        ("", "Z: {z:.2f} dps Y: {y:.2f} dps X: {x:.2f} dps", "Z=rate:dps, dps Y=gy:dps, dps X=gx:dps"),
        ("", "yaw: {z:.2f} deg/s pitch: {y:.2f} deg/s roll: {x:.2f} deg/s", "yaw=rate:dps, pitch=gy:dps, roll=gx:dps"),
        (
            "",
            "gyro_yaw: {z:.2f} dps gyro_pitch: {y:.2f} dps gyro_roll: {x:.2f} dps",
            "gyro_yaw=rate:dps, gyro_pitch=gy:dps, gyro_roll=gx:dps",
        ),
        ("t_ms,r (rad/s),q (rad/s),p (rad/s)", "{t},{z:.4f},{y:.4f},{x:.4f}", "t_ms, rate:rads, gy:rads, gx:rads"),
        (
            "Tiempo (ms);Giro Z (°/s);Giro Y (°/s);Giro X (°/s)",
            "{t};{z:.2f};{y:.2f};{x:.2f}",
            "t_ms, rate:dps, gy:dps, gx:dps",
        ),
        ("Zeit [ms];Nickrate [°/s];Gierrate [°/s]", "{t};{y:.2f};{z:.2f}", "t_ms, _, rate:dps"),
        ("", "Vitesse de lacet: {z:.2f} °/s", "Vitesse de lacet=rate:dps"),
        ("", "gz_raw: {x:.0f} gz: {z:.2f} dps", "gz=rate:dps"),
        ("", "{x:.2f}dps,{y:.2f}dps,{z:.2f}dps", "gx:dps, gy:dps, rate:dps"),
        ("", "I ({t}) app: gx: {x:.2f} gz: {z:.2f} dps", "gz=rate:dps, time=t_ms"),
    ],
)
def test_the_axis_is_that_of_the_label_in_any_order_and_language(head: str, form: str, spec: str) -> None:
    """The axis is that of the label, in any order and language."""
    assert guessed(form, head).spec == spec


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize(
    ("head", "form"),
    [
        ("t_ms,gz/10 (dps)", "{t},{x:.0f}"),
        ("t_ms,gz*100 (dps)", "{t},{x:.0f}"),
        ("t_ms,100*gz (dps)", "{t},{x:.0f}"),
        ("t_ms,gz (dps) x10", "{t},{x:.0f}"),
    ],
)
def test_a_number_in_parts_of_a_unit_is_not_in_that_unit(head: str, form: str) -> None:
    """A scaled number (`gz*100`) is not taken for its unit."""
    assert guessed(form, head).spec is None


@pytest.mark.parametrize(("unit", "option"), [("0.01 deg/s", "lsb/100"), ("1e-3 rad/s", "lsb/17.45329252")])
def test_parts_of_a_unit_are_counts_per_deg_per_s(unit: str, option: str) -> None:
    assert guessed(f"gz [{unit}]: {{x:.0f}}").spec == f"gz [{unit}]=rate:{option}"


def test_the_yaw_of_a_setpoint_is_told_from_that_of_the_gyro() -> None:
    lines = [f"{word}: roll=1 pitch=2 yaw=3" for word in ("Gyro", "Attitude", "Setpoint")]
    labels = [fields.labels[-1] for line in lines if (fields := fields_of(line)) is not None]
    assert labels == ["Gyro yaw", "yaw", "Setpoint yaw"]


def test_three_numbers_with_the_length_of_gravity_are_not_taken_for_radians() -> None:
    noise = Random(5)
    lines = [f"Gx: {noise.gauss(0, 0.004):.3f} Gy: 0.010 Gz: {noise.gauss(1, 0.004):.3f}" for _ in range(40)]
    result = guess(lines, LINES_PER_S)
    assert result is not None
    assert result.spec is None


@pytest.mark.parametrize(
    "form", ["T: {w:.2f} gz: {z:.2f} dps", "us: 9980 gz: {z:.2f} dps", "t: {x:.0f} gz: {z:.2f} dps"]
)
def test_a_clock_that_does_not_go_on_is_none(form: str) -> None:
    assert guessed(form).spec == "gz=rate:dps"


def test_a_clock_of_whole_seconds_is_still_known_by_its_pace() -> None:
    lines = [f"t: {i // 50} gz: {i % 7}.1 dps" for i in range(200)]
    result = guess(lines, 50.0)
    assert result is not None
    assert result.spec == "t=t_s, gz=rate:dps"
