"""Readings that are no measurement: impossible ones, a sensor that does not answer, and the end of its range."""

from collections.abc import Callable
from random import Random
from typing import Any

import numpy as np
import pytest

from gyrodrift.columns.readings import ReadingJudge, StreamJudge
from gyrodrift.facts.readings import judged_readings
from gyrodrift.values.sample import Inertial, Sample

HZ = 50.0
Odd = Callable[[float, float], float]


def turn_dps(t_s: float) -> float:
    """60 deg/s from 15 to 18 s."""
    t_s -= 15.0
    return 60.0 * min(1.0, t_s / 0.25, (3.0 - t_s) / 0.25) if 0.0 < t_s < 3.0 else 0.0


def stream(odd: Odd = lambda _t, rate: rate, hz: float = HZ, seconds: float = 30.0) -> list[Sample]:
    """A turn with noise and a bias, changed by `odd`, which gets time and rate."""
    dice = Random(1)
    times = [i / hz for i in range(int(seconds * hz))]
    rates = [round(odd(t, turn_dps(t) + 0.5 + dice.gauss(0.0, 0.05)), 4) for t in times]
    return [Sample(i, t, t, rate) for i, (t, rate) in enumerate(zip(times, rates, strict=True))]


def judged(samples: list[Sample]) -> tuple[list[tuple[str, dict[str, Any]]], list[Sample]]:
    """Events and samples of a stream; a recording of it has the same verdicts."""
    events: list[tuple[str, dict[str, Any]]] = []
    judge = StreamJudge(ReadingJudge(lambda event, **fields: events.append((event, fields))))
    passed = [sample for i in range(0, len(samples), 7) for sample in judge.take(samples[i : i + 7])]
    rates = np.array([[*(sample.inertial or ())[:2], sample.rate_dps] for sample in samples])
    others = np.array([(sample.inertial or ())[3:] for sample in samples])
    recorded = judged_readings(np.array([sample.t_device_s for sample in samples]), rates, others)
    missing = [sample.rate_dps != sample.rate_dps for sample in passed]
    assert recorded.is_missing[: len(missing)].tolist() == missing
    assert [event for event in recorded.events if event[0] != "rate_moves"] == [
        event for event in events if event[0] != "rate_moves"
    ]
    assert sum(missing) == judge.missing
    return events, passed


def names_of(events: list[tuple[str, dict[str, Any]]]) -> set[str]:
    return {event for event, _ in events}


def angle_deg(samples: list[Sample]) -> float:
    """Integral over the samples that have a rate, without the bias."""
    kept = [sample for sample in samples if sample.rate_dps == sample.rate_dps]
    return float(np.trapezoid([s.rate_dps - 0.5 for s in kept], [s.t_device_s for s in kept]))


@pytest.mark.parametrize(
    ("hz", "wild_dps"), [(20.0, 1998.0), (50.0, 1998.0), (50.0, -1998.0), (50.0, 500.3), (100.0, 250.1), (400.0, 250.1)]
)
def test_single_impossible_readings_are_left_out(hz: float, wild_dps: float) -> None:
    """One each 1.5 s, at rest and in the turn."""
    events, passed = judged(stream(lambda t, rate: wild_dps if t > 1.0 and t % 1.5 < 0.99 / hz else rate, hz))
    assert names_of(events) == {"impossible_reading"}
    assert angle_deg(passed) == pytest.approx(165.0, abs=1.0)


def test_a_reading_that_is_confirmed_is_integrated() -> None:
    """A step that no hand makes, but the next reading has it too: it comes one sample late."""
    samples = stream(lambda t, rate: rate + 400.0 * (20.0 <= t < 20.5))
    events, passed = judged(samples)
    assert events == []
    assert passed == samples[: len(passed)]


@pytest.mark.parametrize(
    "odd",
    [
        lambda t, rate: 400.0 * np.sin(2 * np.pi * 8.0 * t) + rate,
        lambda t, rate: rate + (200.0 if round(t * HZ) % 2 else -200.0) * (t > 5.0),
        lambda t, rate: rate + 1000.0 * max(0.0, 1.0 - abs(t - 20.0) / 0.1),
        lambda t, rate: 0.0 if abs(rate) < 1.0 else rate,
        lambda t, rate: float(round(rate)),
        lambda t, rate: 0.5 + turn_dps(t),
        lambda t, rate: 60.0 * (t > 10.0),
    ],
    ids=["shaken", "vibration", "a flick", "dead band", "coarse", "without noise", "a step without noise"],
)
def test_usual_devices_are_left_alone(odd: Odd) -> None:
    events, passed = judged(stream(odd))
    assert events == []
    assert not any(sample.rate_dps != sample.rate_dps for sample in passed)


@pytest.mark.parametrize("value_dps", [0.0, 0.53])
def test_a_rate_that_never_changes_is_said(value_dps: float) -> None:
    """Nothing else shows whether the device rests behind a dead band or its sensor is dead."""
    events, passed = judged(stream(lambda _t, _rate: value_dps))
    assert names_of(events) == {"rate_hangs"}
    assert "has not changed since the start" in events[0][1]["hint"]
    assert not any(sample.rate_dps != sample.rate_dps for sample in passed)


@pytest.mark.parametrize(
    "odd",
    [
        lambda t, rate: 0.0 if round(t * HZ) % 5 == 2 else rate,
        lambda t, rate: -1.0 if round(t * HZ) % 5 == 2 else rate,
        lambda t, rate: -250.0 if round(t * HZ) % 50 in {5, 6} else rate,
        lambda t, rate: -250.14 if round(t * HZ) % 37 == 5 else rate,
    ],
    ids=["zeros", "ones", "ends of range in pairs", "ends of range"],
)
def test_failed_reads_are_left_out_once_the_noise_is_known(odd: Odd) -> None:
    events, passed = judged(stream(odd))
    assert names_of(events) == {"impossible_reading"}
    turn = [sample for sample in passed if 14.9 < sample.t_device_s < 18.1]
    assert angle_deg(turn) == pytest.approx(165.0, abs=3.0)


@pytest.mark.parametrize("value_dps", [60.512, -0.0076, 1998.0])
def test_a_sensor_that_hangs_is_said_and_not_integrated(value_dps: float) -> None:
    """Its bus repeats the last reading, or has only ones, or its largest number."""
    events, passed = judged(stream(lambda t, rate: value_dps if 16.0 <= t < 17.0 else rate))
    assert [event for event, _ in events] == ["rate_hangs", "rate_moves"]
    assert events[0][1]["seconds"] < 1.0
    missing = [s.t_device_s for s in passed if s.rate_dps != s.rate_dps]
    assert missing[0] < 16.2
    assert missing[-1] == pytest.approx(17.0, abs=0.03)


@pytest.mark.parametrize("value", [-1.0, 32767.0, 0.0])
def test_a_sensor_that_never_answers_is_said_within_a_second(value: float) -> None:
    axes = Inertial(value, value, value, value, value, value)
    events, _ = judged([Sample(i, i / 10, 0.0, value, inertial=axes) for i in range(100)])
    assert names_of(events) == {"rate_hangs"}
    assert "does not answer" in events[0][1]["hint"]
    assert events[0][1]["seconds"] <= 1.1


@pytest.mark.parametrize("limit_dps", [250.13, 40.0])
def test_the_end_of_the_range_is_counted(limit_dps: float) -> None:
    """A known one, and any other; the rate is a lower bound, so it is kept."""
    events, passed = judged(stream(lambda t, rate: max(-limit_dps, min(limit_dps, 7.0 * rate))))
    assert names_of(events) == {"clipped"}
    assert events[0][1]["limit_dps"] == limit_dps
    assert not any(sample.rate_dps != sample.rate_dps for sample in passed)
