"""An odd stream that arrives whole is reported once, a usual one is not."""

from random import Random
from typing import Any

import pytest

from gyrodrift.columns.readings import ReadingJudge, StreamJudge
from gyrodrift.service.stream_watch import AxesWatch, PaceWatch
from gyrodrift.values.sample import Inertial, Sample

HZ = 100.0
FINE_DPS = 0.0076


def noisy(count: int, level_dps: float = 0.4, lsb_dps: float = FINE_DPS, sigma_dps: float = 0.05) -> list[float]:
    """Rates in steps, as a sensor says them."""
    dice = Random(1)
    return [round(dice.gauss(level_dps, sigma_dps) / lsb_dps) * lsb_dps for _ in range(count)]


def told_of(rates: list[float], turn: int = 4) -> list[tuple[str, dict[str, Any]]]:
    """Events of a stream whose samples come by a few."""
    result: list[tuple[str, dict[str, Any]]] = []
    watch = StreamJudge(ReadingJudge(lambda event, **fields: result.append((event, fields))))
    samples = [Sample(n, n / HZ, 0.0, rate) for n, rate in enumerate(rates)]
    for position in range(0, len(samples), turn):
        watch.take(samples[position : position + turn])
    assert watch.judge.hung_s == pytest.approx(
        sum(fields["seconds"] for event, fields in result if event == "rate_moves")
    )
    return result


@pytest.mark.promise("Recovery")
def test_a_rate_that_hangs_is_told_once_and_once_more_when_it_moves() -> None:
    """A hanging rate is reported once, and once more when it moves."""
    rates = [*noisy(1000), *[40.0] * 3000, *noisy(1000), *[0.41] * 300, *noisy(100)]
    result = told_of(rates)
    assert [event for event, _ in result] == ["rate_hangs", "rate_moves", "rate_hangs", "rate_moves"]
    assert result[0][1] | {"hint": ""} == {"rate_dps": 40.0, "seconds": pytest.approx(0.5, abs=0.05), "hint": ""}
    assert result[1][1] == {"rate_dps": 40.0, "seconds": 30.0, "since_s": 10.0}


@pytest.mark.parametrize(
    "rates",
    [
        noisy(20_000),
        [*noisy(1000), *[0.0] * 3000, *noisy(1000)],
        [0.4] * 1500,
        [*noisy(1000, lsb_dps=0.061), *[0.427] * 3000],
        [rate for rate in noisy(200, sigma_dps=0.3) for _ in range(60)],
        [*noisy(1000), *[40.0] * 40, *noisy(1000)],
        [float("nan")] * 5000,
    ],
    ids=["noise", "zero at rest", "constant from the start", "coarse steps", "a slow sensor", "a moment", "no rate"],
)
def test_what_is_usual_is_not_told(rates: list[float]) -> None:
    """A sensor may be coarse, slow, or say zero at rest."""
    assert told_of(rates) == []


def paced(stretches: list[tuple[float, float]]) -> list[str]:
    """Events of stretches of so many host seconds, in which the device clock goes so fast."""
    result: list[str] = []
    watch = PaceWatch(lambda event, **_: result.append(event))
    host_s = device_s = 0.0
    for seconds, per_s in stretches:
        for _ in range(round(seconds * HZ)):
            host_s, device_s = host_s + 1.0 / HZ, device_s + per_s / HZ
            watch.take([Sample(0, device_s, host_s, 0.0)])
    return result


@pytest.mark.promise("Recovery")
def test_a_clock_that_counts_something_else_is_told_once() -> None:
    """A device clock that changes its unit is reported within 6 s."""
    assert paced([(10.0, 1.0), (60.0, 1e-3)]) == ["clock_unit_differs"]
    assert paced([(10.0, 1.0), (20.0, 1e-3), (10.0, 1.0), (20.0, 1e-6)]) == ["clock_unit_differs"] * 2


def test_a_clock_that_stood_still_once_is_right() -> None:
    """A device may sleep, a host's clock may be set, either way; a replay may be fast."""
    assert paced([(10.0, 1.0), (3.0, 0.0), (10.0, 1.0), (10.0, 50.0)]) == []
    result: list[str] = []
    watch = PaceWatch(lambda event, **_: result.append(event))
    for n in range(6000):
        watch.take([Sample(n, n / HZ, n / HZ + (3600.0 if 2000 < n < 4000 else 0.0), 0.0)])
    assert result == []


GRAVITY = Inertial(0.1, 0.2, 0.3, 0.0, 0.0, 9.8)
RATES = Inertial(0.1, 0.2, 0.3)


def told_of_axes(*parts: tuple[Inertial | None, float]) -> list[tuple[str, float]]:
    """Events, with their seconds, of a stream that sends each of these for some seconds."""
    events: list[tuple[str, float]] = []
    watch = AxesWatch(lambda event, **fields: events.append((event, fields["seconds"])))
    axes = [inertial for inertial, seconds in parts for _ in range(round(seconds * HZ))]
    for index, inertial in enumerate(axes):
        watch.take([Sample(index, index / HZ, 0.0, 0.3, inertial=inertial)])
    return events


def test_accelerations_that_stop_are_told_and_their_return_too() -> None:
    zeros = Inertial(0.1, 0.2, 0.3, 0.0, 0.0, 0.0)
    assert told_of_axes((GRAVITY, 5.0), (RATES, 4.0), (GRAVITY, 1.0), (zeros, 3.0)) == [
        ("accelerations_missing", 2.01),
        ("accelerations_back", 4.01),
        ("accelerations_missing", 2.01),
    ]


def test_three_rates_that_never_have_an_acceleration_are_told_once() -> None:
    assert told_of_axes((RATES, 60.0)) == [("accelerations_missing", 2.01)]


def test_a_device_of_three_axes_that_becomes_one_of_one_axis_is_told() -> None:
    assert told_of_axes((GRAVITY, 5.0), (None, 10.0), (GRAVITY, 5.0)) == [("axes_missing", 2.01), ("axes_back", 10.01)]


def test_one_axis_and_a_slow_accelerometer_tell_nothing() -> None:
    assert told_of_axes((None, 60.0)) == []
    assert told_of_axes(*[(GRAVITY, 0.01), (RATES, 0.99)] * 20) == []
    assert told_of_axes(*[(GRAVITY, 0.5), (None, 0.5)] * 20) == []
