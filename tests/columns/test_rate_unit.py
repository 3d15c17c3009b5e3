"""The unit of rates, from noise, turns, bias and whole numbers: named where it is another one, and never elsewhere."""

import csv
from collections.abc import Callable, Iterator
from itertools import islice
from math import nan, radians
from pathlib import Path
from random import Random

import pytest
from recordings_support import Recordings

from gyrodrift.columns.rate_unit import SURE_ODDS, RateUnit, RateUnitOdds
from gyrodrift.columns.sizes import WINDOW
from gyrodrift.values.sample import Sample

RATE_HZ = 100.0
REST_S, TURN_S = 10, 4
SHORT = 2000
"""Samples of a recording: its first rest and its first turns."""


def best(samples: list[Sample], start: int = 0) -> RateUnit | None:
    odds, result = RateUnitOdds(), list[RateUnit]()
    for index in range(start, len(samples) - WINDOW + 1, WINDOW):
        odds.take(samples[index : index + WINDOW])
        result += odds.likely()[:1]
    return max(result, key=lambda unit: unit.odds, default=None)


def gyro(as_said: Callable[[float], float], bias_dps: float = 0.8, turn_dps: float = 70.0) -> list[Sample]:
    """A cheap gyro that rests, is turned by hand, and rests."""
    noise = Random(4)
    seconds = [0.0] * REST_S + [turn_dps] * TURN_S + [0.0] * REST_S
    rates = [dps + bias_dps + noise.gauss(0.0, 0.07) for dps in seconds for _ in range(round(RATE_HZ))]
    return [Sample(i, i / RATE_HZ, 0.0, as_said(rate)) for i, rate in enumerate(rates)]


def test_a_gyro_in_deg_per_s_is_left_alone() -> None:
    for turn_dps in (0.0, 5.0, 70.0, 400.0):
        result = best(gyro(lambda rate: rate, turn_dps=turn_dps))
        assert result is None or result.odds < 0.1 * SURE_ODDS


def test_rad_per_s_are_named() -> None:
    result = best(gyro(radians))
    assert result is not None
    assert (result.unit, result.odds > SURE_ODDS) == ("rad/s", True)


@pytest.mark.parametrize("per_dps", [131.0, 65.5, 32.8, 16.4])
def test_counts_are_named(per_dps: float) -> None:
    result = best(gyro(lambda rate: float(round(rate * per_dps))))
    assert result is not None
    assert (result.unit, result.odds > SURE_ODDS) == ("counts", True)


def test_an_encoder_tells_the_sensitivity() -> None:
    angle_deg, turning = 0.0, gyro(lambda rate: float(round(rate * 32.8)), bias_dps=0.0)
    with_encoder = []
    for sample in turning:
        angle_deg += sample.rate_dps / 32.8 / RATE_HZ
        with_encoder.append(sample._replace(encoder_deg=angle_deg))
    result = best(with_encoder)
    assert result is not None
    assert (result.unit, result.per_dps) == ("counts", 32.8)


def test_whole_deg_per_s_of_a_robot_kit_are_no_counts() -> None:
    result = best(gyro(lambda rate: float(round(rate)), bias_dps=0.4, turn_dps=150.0))
    assert result is None or result.odds < SURE_ODDS


def test_nothing_is_said_of_zeros_and_of_what_is_no_number() -> None:
    """A device that takes its own bias out says exact zeros at rest."""
    assert best([Sample(i, i / RATE_HZ, 0.0, 0.0) for i in range(2000)]) is None
    assert best([Sample(i, i / RATE_HZ, 0.0, nan) for i in range(2000)]) is None


def recorded(path: Path) -> Iterator[Sample]:
    with path.open() as file:
        for number, row in enumerate(csv.DictReader(file)):
            encoder_deg = float(row.get("encoder_deg") or nan)
            yield Sample(number, float(row["t_device_s"]), 0.0, float(row["rate_dps"]), encoder_deg)


@pytest.mark.parametrize(("kept", "least"), [("packed", 10), ("further", 91)])
def test_no_real_recording_in_deg_per_s_is_suspected(kept: str, least: int, recordings: Recordings) -> None:
    """Nor with its encoder left out; the highest odds of all are well below those at which a unit is named."""
    paths = getattr(recordings, kept)()
    assert len(paths) >= least
    highest = 0.0
    for path in paths:
        samples = list(islice(recorded(path), SHORT))
        for heard in (samples, [sample._replace(encoder_deg=nan) for sample in samples]):
            result = best(heard)
            highest = max(highest, result.odds if result else 0.0)
    print(f"\nhighest odds of another unit in {len(paths)} recordings: {highest:.1f} to 1")
    assert highest < 0.3 * SURE_ODDS
