"""Real recordings whose cause is known: their labels hold in the data, and the scorer counts as it says."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from blind.rows.recordings import read_rows, turned_about
from evaluate import real_causes_part
from evaluate.baseline import group_of
from evaluate.real_causes import AHEAD, ARRIVAL, CASES, CHAIN, DEVICES, LOOP, NOTHING, OUTSIDE, Piece
from evaluate.real_causes_part import (
    chosen,
    has_files,
    is_left_open,
    is_outside,
    is_right,
    names_label_by_share,
    names_label_first,
    names_label_or_ties,
    rig_of_case,
    unlabeled_sure,
    write_pieces,
)  # fmt: skip
from recordings_support import Recordings, further_recordings
from scipy.signal import periodogram

from firmware_sim.rig import load_rig
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.session.files import load_session
from gyrodrift.values.arrays import Floats

HEATED = next(case for case in CASES if case.device == "thermal chamber")
HAND_HELD = next(case for case in CASES if case.name == "BROAD 01")


def gap(verdict: str, *causes: tuple[str, float]) -> dict[str, Any]:
    return {
        "verdict": verdict,
        "causes": [{"effect": name, "probability": chance, "tied_with": []} for name, chance in causes],
    }


def test_every_label_is_a_group_and_says_where_it_comes_from() -> None:
    groups = {group_of(name) for name in KINDS}
    for case in CASES:
        assert {*case.labels, *case.also} <= {*groups, OUTSIDE, NOTHING}
        assert case.labels
        assert NOTHING not in case.labels or case.baseline
        assert case.source.startswith(("documented: ", "measured: "))
        assert case.device in DEVICES


def test_at_least_forty_recordings_of_fifteen_devices_are_labeled_and_none_twice() -> None:
    """Parts of a recording count as one recording; a comparison with earlier recordings is a question of its own."""
    assert len({case.name for case in CASES}) == len(CASES)
    assert len(set(DEVICES)) >= 15
    pieces = [piece for case in CASES if not case.baseline for piece in case.files]
    assert set(Counter(pieces).values()) == {1}
    assert len({piece.name for piece in pieces}) >= 40


def _intervals_s(recordings: Recordings, name: str) -> Floats:
    """Intervals between samples, without the first tenth: a radio sends late what it has stored."""
    t_s = load_session(recordings.path(name)).t_device_s
    return np.diff(t_s[len(t_s) // 10 :])


def _lag_one(intervals_s: Floats) -> float:
    """Correlation of neighbors: -0.5 where each stamp scatters by itself, 0 where the intervals do."""
    short_s = np.minimum(intervals_s, np.percentile(intervals_s, 99.0))
    return float(np.corrcoef(short_s[:-1], short_s[1:])[0, 1])


def test_the_bench_is_sampled_at_irregular_times_with_right_stamps(recordings: Recordings) -> None:
    recordings.further()
    for name in (piece.name for case in CASES if case.source == LOOP for piece in case.files):
        intervals_s = _intervals_s(recordings, name)
        low_s, high_s = np.percentile(intervals_s, [1.0, 99.0])
        assert round(1e3 * (high_s - low_s)) >= 18, name
        assert -0.25 < _lag_one(intervals_s) < 0.25, name


def test_stamps_of_arrival_scatter_by_themselves_in_every_set(recordings: Recordings) -> None:
    recordings.further()
    for case in (case for case in CASES if case.source == ARRIVAL):
        lags = [_lag_one(_intervals_s(recordings, piece.name)) for piece in case.files]
        assert min(lags) < -0.45, case.name


def test_the_stamps_of_the_car_are_tenths_of_a_second(recordings: Recordings) -> None:
    t_s = load_session(recordings.path("smartloc_berlin_potsdamer_platz")).t_device_s
    assert 10.0 * t_s == pytest.approx(np.rint(10.0 * t_s), abs=0.011)
    assert np.diff(t_s).mean() == pytest.approx(0.206, abs=0.001)


def test_the_rate_held_in_the_hand_is_four_milliseconds_late(recordings: Recordings) -> None:
    """The integral fits the angle best where it is shifted by so much, in the median of blocks of 20 s."""
    session = load_session(recordings.path("broad_14"))
    assert session.encoder_deg is not None
    steps_deg = 0.5 * (session.rate_dps[1:] + session.rate_dps[:-1]) * np.diff(session.t_device_s)
    yaw_deg = np.concatenate([[0.0], np.cumsum(steps_deg)])
    lags_ms = [_lag_ms(session.t_device_s, yaw_deg, session.encoder_deg, start_s) for start_s in range(40, 140, 20)]
    assert np.median(lags_ms) == pytest.approx(4.2, abs=1.0)


def _lag_ms(t_s: Floats, yaw_deg: Floats, angle_deg: Floats, start_s: float) -> float:
    """The shift of the least sum of squares, beside a bias and a gain."""
    chosen_rows = np.flatnonzero((t_s > start_s) & (t_s < start_s + 20.0))
    lags_ms = np.arange(-2.0, 11.0)

    def squares(lag_ms: float) -> float:
        shifted_deg = np.interp(t_s[chosen_rows] + lag_ms / 1e3, t_s, yaw_deg)
        terms = np.column_stack([shifted_deg, t_s[chosen_rows], np.ones(len(chosen_rows))])
        return float(np.linalg.lstsq(terms, angle_deg[chosen_rows], rcond=None)[1][0])

    return float(lags_ms[np.argmin([squares(lag_ms) for lag_ms in lags_ms])])


def test_the_gyro_at_rest_has_a_tone(recordings: Recordings) -> None:
    """The periodogram of each part has a line at 31.4 Hz, 50 times the median or more; noise alone has about 13."""
    rate_dps = load_session(recordings.path("mpu6050_still")).rate_dps
    for part_dps in np.array_split(rate_dps, 5):
        frequency_hz, power = periodogram(part_dps - part_dps.mean(), fs=99.3)
        loudest = int(power[frequency_hz > 0.5].argmax()) + int((frequency_hz <= 0.5).sum())
        assert frequency_hz[loudest] == pytest.approx(31.4, abs=0.2)
        assert power[loudest] > 50.0 * np.median(power)


def test_the_gyro_behind_a_radio_has_outliers(recordings: Recordings) -> None:
    """Differences to a median of five exceed eight of their sigmas, in most recordings of the LSM9DS0."""
    recordings.further()
    names = [piece.name for case in CASES if case.device == "LSM9DS0" for piece in case.files]
    assert sum(_outlier_share(load_session(recordings.path(name)).rate_dps) > 1e-3 for name in names) >= len(names) - 1


def _outlier_share(rate_dps: Floats) -> float:
    medians_dps = np.median(np.lib.stride_tricks.sliding_window_view(rate_dps, 5), axis=1)
    residual_dps = np.abs(rate_dps[2:-2] - medians_dps)
    return float(np.mean(residual_dps > 8.0 * 1.4826 * np.median(residual_dps)))


def test_the_first_cause_has_to_be_of_a_labeled_group() -> None:
    """A warm-up looks like a bias that follows the temperature; a second cause does not count."""
    assert names_label_first(HEATED, gap("effect", ("warmup", 0.7)))
    assert not names_label_first(HEATED, gap("partly", ("rate_random_walk", 0.7), ("temp_bias", 0.6)))
    assert not names_label_first(HEATED, gap("unknown"))


def test_a_cause_that_ties_with_the_first_is_counted_in_a_figure_of_its_own() -> None:
    tied = gap("partly", ("rate_random_walk", 0.5))
    tied["causes"][0]["tied_with"] = ["temp_bias"]
    assert not names_label_first(HEATED, tied)
    assert names_label_or_ties(HEATED, tied)
    assert not names_label_or_ties(HEATED, gap("unknown"))


def test_the_order_of_the_report_is_counted_in_a_figure_of_its_own() -> None:
    """A certain cause of little of the gap comes after a probable cause of most of it."""
    ordered = gap("partly", ("vibration", 0.96), ("temp_bias", 0.6))
    for cause, share in zip(ordered["causes"], (0.02, 0.7), strict=True):
        cause |= {"gap_share": share, "group_probability": cause["probability"]}
    assert names_label_by_share(HEATED, ordered)
    assert not names_label_first(HEATED, ordered)
    assert not names_label_by_share(HEATED, gap("unknown"))


def test_what_is_outside_the_catalog_has_to_stay_open() -> None:
    assert is_outside(HAND_HELD)
    assert not is_outside(HEATED)
    assert is_left_open(gap("unknown"))
    assert is_left_open(gap("partly", ("latency", 0.9)))
    assert not is_left_open(gap("none"))
    assert not is_left_open(gap("effect", ("latency", 0.9)))


def test_a_confident_cause_that_nobody_knows_of_is_counted() -> None:
    causes = (("temp_bias", 0.9), ("bias_instability", 0.9), ("spikes", 0.7), ("latency", 0.81))
    assert unlabeled_sure(HEATED, gap("partly", *causes)) == ["latency"]


def test_a_case_without_its_recordings_is_skipped_with_the_reason(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(real_causes_part, "further_recordings", lambda: None)
    remarks: list[str] = []
    bench = next(case for case in CASES if case.device == "BNO085")
    assert not has_files(bench, remarks.append)
    assert f"{bench.baseline[0].name} is not in tests/data" in remarks[0] or bench.files[0].name in remarks[0]
    assert has_files(HEATED, remarks.append)


def test_as_many_cases_of_each_device_as_are_asked_for() -> None:
    assert [case.device for case in chosen(1)] == list(dict.fromkeys(case.device for case in CASES))


def test_a_part_of_a_recording_begins_at_zero_and_its_rig_can_be_loaded(recordings: Recordings, tmp_path: Path) -> None:
    whole = load_session(recordings.path("temperature_sweep"))
    (part,) = write_pieces([Piece("temperature_sweep", index=4, count=5)], tmp_path / "sessions")
    session = load_session(part)
    assert session.t_device_s[0] == 0.0
    assert session.rate_dps[-1] == pytest.approx(whole.rate_dps[-1])
    assert len(session.t_device_s) == len(whole.t_device_s) // 5
    (tmp_path / "rig.yaml").write_text(rig_of_case(HEATED, [part]))
    assert load_rig(tmp_path / "rig.yaml").base.sample_rate_hz == pytest.approx(1.98, abs=0.01)


def test_two_sets_that_do_not_differ_have_no_gap() -> None:
    same = next(case for case in CASES if case.labels == (NOTHING,))
    assert is_right(same, gap("none"))
    assert not is_right(same, gap("unknown"))
    assert not is_right(same, gap("effect", ("latency", 0.9)))


def test_an_archive_is_read_along_an_axis_of_the_sensor(tmp_path: Path) -> None:
    """Turns about z with the sensor upright; the reference is unknown in the middle of the shorter rest."""
    t_s = np.arange(200) * 0.01
    angle_deg = 30.0 * np.sin(t_s)
    half = np.deg2rad(angle_deg) / 2.0
    quat = np.column_stack([np.cos(half), 0.0 * half, 0.0 * half, np.sin(half)])
    gyr = np.column_stack([0.0 * t_s, 0.0 * t_s, 30.0 * np.cos(t_s)])
    assert turned_about(quat)[:, 2] == pytest.approx(angle_deg)
    quat[20] = np.nan
    np.savez(tmp_path / "spatial.npz", t=t_s, gyr=gyr, quat=quat)
    rows = read_rows(tmp_path / "spatial.npz", "z").from_zero()
    assert len(rows.t_s) == 179
    assert rows.columns["encoder_deg"] == pytest.approx(angle_deg[21:] - angle_deg[21], abs=1e-4)
    angle_deg[0], angle_deg[50] = np.nan, np.nan
    np.savez(tmp_path / "flat.npz", t=t_s, rate_dps=gyr[:, 2], ref_deg=angle_deg, meta="{}")
    rows = read_rows(tmp_path / "flat.npz", "-").from_zero()
    assert len(rows.t_s) == 199
    assert rows.text().splitlines()[50].endswith(",")


@pytest.mark.parametrize(("name", "axis", "lag_ms"), [(name, CHAIN[name][0], 2.4) for name in CHAIN])
def test_the_rate_on_a_chain_is_late(recordings: Recordings, name: str, axis: str, lag_ms: float) -> None:
    assert _lag_of_archive_ms(recordings, f"diodem_{name}", axis) == pytest.approx(lag_ms, abs=0.5)


@pytest.mark.parametrize("name", AHEAD)
def test_the_rate_of_the_first_chain_is_ahead(recordings: Recordings, name: str) -> None:
    assert _lag_of_archive_ms(recordings, f"diodem_{name}", AHEAD[name][0]) == pytest.approx(-16.0, abs=1.5)


def _lag_of_archive_ms(recordings: Recordings, name: str, axis: str) -> float:
    """The shift at which what the gyro turns in half a second fits best what the reference does."""
    recordings.further()
    folder = further_recordings()
    assert folder is not None
    rows = read_rows(next(folder.rglob(f"{name}.npz")), axis)
    t_s, rate_dps, angle_deg = (rows.columns[column] for column in ("t_device_s", "rate_dps", "encoder_deg"))
    yaw_deg = np.concatenate([[0.0], np.cumsum(0.5 * (rate_dps[1:] + rate_dps[:-1]) * np.diff(t_s))])
    edges_s = np.arange(t_s[0] + 0.3, t_s[-1] - 0.3, 0.5)
    turns_deg = np.diff(np.interp(edges_s, t_s, angle_deg))
    terms = np.column_stack([turns_deg, np.ones(len(turns_deg))])
    lags_ms = np.arange(-30.0, 30.0, 0.2)

    def squares(lag_ms: float) -> float:
        late_deg = np.diff(np.interp(edges_s + 1e-3 * lag_ms, t_s, yaw_deg))
        return float(np.linalg.lstsq(terms, late_deg, rcond=None)[1][0])

    return float(lags_ms[np.argmin([squares(lag_ms) for lag_ms in lags_ms])])
