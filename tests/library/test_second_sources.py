"""Second sources in a program: what it gives to a filter, and what is refused."""

from math import cos, nan, sin

import pytest

from gyrodrift import AttitudeFilter, Hdr, Restlevel
from gyrodrift.values.errors import UsageError


def yaw_deg(t_s: float) -> float:
    """Yaw of a device that swings with 10 deg/s."""
    return 20.0 * (1.0 - cos(0.5 * t_s))


def test_a_heading_now_and_then_corrects_a_turning_device() -> None:
    """The bias of 0.7 deg/s is hidden, because the device never rests."""
    plain, aided = Restlevel(), Restlevel()
    for index in range(6000):
        t_s = 0.01 * index
        rate_dps = 0.7 + 10.0 * sin(0.5 * t_s) + 0.05 * (-1) ** index
        plain.update_at(rate_dps, t_s)
        estimate = aided.update_at(rate_dps, t_s)
        if index % 500 == 100:
            measured_s = t_s - 0.5 * (index > 100)
            aided.heading(yaw_deg(measured_s) + 20.0, 1.0, t_s=measured_s)
    assert estimate.bias_dps == pytest.approx(0.7, abs=0.15)
    assert estimate.yaw_sigma_deg < 4.0
    assert estimate.yaw_deg == pytest.approx(yaw_deg(59.99), abs=2.0 * estimate.yaw_sigma_deg)
    assert aided.aids["heading"].age_s == pytest.approx(4.49)
    assert aided.aids["heading"].differs == ""
    assert plain.aids == {}


def test_three_axes_take_them_too() -> None:
    attitude = AttitudeFilter()
    for index in range(200):
        attitude.update_at((0.0, 0.0, 0.1), (0.0, 0.0, 9.81), t_s=0.01 * index)
        attitude.standing(True)
        attitude.speed(0.0, 0.1)
    attitude.wheels(1.0, 1.1)
    assert set(attitude.aids) == {"standing", "speed", "wheels"}


def test_what_cannot_be_weighed_is_refused() -> None:
    Hdr().speed(0.0)
    with pytest.raises(UsageError, match="hdr gives no uncertainty"):
        Hdr().heading(1.0, 1.0)
    for value, sigma in ((nan, 1.0), (1.0, 0.0)):
        with pytest.raises(UsageError, match="expected finite numbers and a sigma above 0"):
            Restlevel().turn_rate(value, sigma)
    with pytest.raises(UsageError, match="part of it such as 90"):
        Restlevel().heading(1.0, 1.0, modulo_deg=70)
