"""Samples without a counter are numbered by stamps that say when they arrived."""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from recordings_support import Recordings

from gyrodrift.diagnose.recording.checked import checked_session
from gyrodrift.diagnose.recording.numbering import backlog_of, number_samples, numbers_by_clock
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats, Integers

COUNT, PERIOD_S = 5000, 0.01


def kept(share: float, rng: np.random.Generator) -> Integers:
    """Numbers of samples of which a share is lost, one by one; the first is there."""
    return np.flatnonzero(np.concatenate([[True], rng.random(COUNT - 1) >= share]))


def in_bunches(taken_s: Floats, rng: np.random.Generator, longest_s: float) -> Floats:
    """Arrivals behind a link that stops now and then: what waits comes at once, 0.1 ms apart."""
    stops_s = np.sort(rng.uniform(0.0, 0.95 * taken_s[-1], 40))  # one at the end and a loss look alike
    arrival_s = taken_s.copy()
    for begin_s, length_s in zip(stops_s, rng.uniform(0.0, longest_s, 40), strict=True):
        waits = (arrival_s >= begin_s) & (arrival_s < begin_s + length_s)
        arrival_s[waits] = begin_s + length_s + 1e-4 * np.arange(waits.sum())
    return np.asarray(np.maximum.accumulate(arrival_s))


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.0, 0.01, 0.1])
def test_what_is_lost_leaves_holes_where_it_was(share: float, seed: int) -> None:
    number = kept(share, np.random.default_rng(seed))
    for step_s in (1e-6, 1e-3):
        stamps_s = np.rint(number * 1.0003 * 0.00973 / step_s) * step_s
        assert (numbers_by_clock(stamps_s) == number).all()


@pytest.mark.parametrize("seed", range(5))
def test_what_waits_is_not_lost(seed: int) -> None:
    """A stop of the link up to half a second long is no hole, and what is lost besides is seen."""
    rng = np.random.default_rng(seed)
    number = kept(0.002, rng)
    result = numbers_by_clock(in_bunches(number.astype(np.float64) * PERIOD_S, rng, 0.5))
    assert abs(result[-1] - number[-1]) <= 2
    assert np.abs(result - number).max() <= 5


@pytest.mark.parametrize("seed", range(5))
def test_stamps_that_scatter_are_no_holes(seed: int) -> None:
    rng = np.random.default_rng(seed)
    stamps_s = PERIOD_S * (np.arange(COUNT) + rng.normal(0.0, 0.4, COUNT))
    assert np.abs(numbers_by_clock(stamps_s) - np.arange(COUNT)).max() <= 2


@pytest.mark.parametrize("waiting", [60, 500])
def test_what_had_waited_at_the_start_is_told(waiting: int) -> None:
    arrival_s: Floats = PERIOD_S * np.arange(COUNT, dtype=np.float64)
    arrival_s[:waiting] = arrival_s[waiting] - 0.0025 * np.arange(waiting, 0, -1)
    session = Session("radio", arrival_s, np.zeros(COUNT), encoder_deg=np.zeros(COUNT))
    assert backlog_of(session) == pytest.approx(waiting, abs=5)
    assert backlog_of(replace(session, seq=np.arange(COUNT))) == 0, "a counter says all that has to be known"
    assert backlog_of(session.part(waiting, COUNT)) == 0


def test_what_is_left_out_is_told(tmp_path: Path) -> None:
    taken_s: Floats = 0.02 * np.arange(1600, dtype=np.float64)
    angle_deg = 90.0 * np.sin(taken_s)
    arrival_s = np.concatenate([taken_s[200] - 0.001 * np.arange(200, 0, -1), taken_s[200:]])
    rows = np.column_stack([arrival_s, np.gradient(angle_deg, taken_s), angle_deg])
    np.savetxt(tmp_path / "radio.csv", rows, "%.6f", ",", header="t_device_s,rate_dps,encoder_deg", comments="")
    checked = checked_session(tmp_path / "radio.csv")
    assert checked.recordings[0].period_s == pytest.approx(0.02, rel=1e-3)
    report = [
        re.search(r"radio: its first (\d+) samples had waited and came at once", remark) for remark in checked.remarks
    ]
    assert [int(item[1]) for item in report if item] == [pytest.approx(200, abs=5)]


@pytest.mark.parametrize("seed", range(5))
def test_nothing_has_waited_where_stamps_are_even_or_scatter(seed: int) -> None:
    rng = np.random.default_rng(seed)
    scattered_s = PERIOD_S * (np.arange(COUNT) + rng.normal(0.0, 0.4, COUNT))
    number = kept(0.3, rng)
    for lost in (number[number < COUNT // 2], number[number >= COUNT // 2]):
        rest = np.setdiff1d(np.arange(COUNT), np.setdiff1d(np.arange(lost[0], lost[-1]), lost))
        assert backlog_of(Session("lossy", PERIOD_S * rest, np.zeros(len(rest)))) == 0
    assert backlog_of(Session("scattered", scattered_s, np.zeros(COUNT))) == 0


@pytest.mark.parametrize("t_s", [np.zeros(100), -np.arange(100.0), np.array([0.0, 1.0]), np.full(300, 5.0)])
def test_a_clock_that_says_nothing_numbers_one_after_the_other(t_s: Floats) -> None:
    assert (numbers_by_clock(t_s) == np.arange(len(t_s))).all()


@pytest.mark.parametrize(("kept", "least"), [("packed", 6), ("further", 34)])
def test_recordings_over_radio_are_even_behind_what_had_waited(kept: str, least: int, recordings: Recordings) -> None:
    paths = getattr(recordings, kept)("rasteiro_*")
    assert len(paths) >= least
    off, period_s = [], []
    for path in paths:
        session = load_session(path)
        session = session.part(backlog_of(session), len(session.t_device_s))
        number = number_samples(session).sample
        slope_s, offset_s = np.polyfit(number, session.t_device_s, 1)
        off.append(np.std(session.t_device_s - slope_s * number - offset_s) / slope_s)
        period_s.append(slope_s)
    assert np.median(off) < 0.6
    assert max(off) < 2.5
    assert 0.0095 < min(period_s) < max(period_s) < 0.012


@pytest.mark.parametrize("counter", [True, False])
def test_a_row_that_comes_twice_is_one_sample(*, counter: bool) -> None:
    row = np.sort(np.concatenate([np.arange(COUNT), np.arange(0, COUNT, 50)]))
    rate_dps = np.random.default_rng(2).normal(0.0, 1.0, COUNT)
    session = Session("twice", PERIOD_S * row, rate_dps[row], seq=row if counter else None, encoder_deg=1.0 * row)
    numbers = number_samples(session)
    assert (numbers.sample == np.arange(COUNT)).all()
    assert (numbers.repeated, numbers.disordered) == (len(row) - COUNT, 0)


def test_equal_stamps_of_different_samples_are_coarse() -> None:
    """Four samples to each stamp, some of which are equal at rest."""
    rate_dps: Floats = np.where(np.arange(COUNT) < 500, 0.0, np.random.default_rng(2).normal(0.0, 1.0, COUNT))
    stamps_s = PERIOD_S * 4.0 * np.repeat(np.arange(COUNT / 4), 4)
    numbers = number_samples(Session("coarse", stamps_s, rate_dps, encoder_deg=np.zeros(COUNT)))
    assert numbers.repeated == 0
