"""A difference common to baseline and recordings is no gap; a difference within the baseline is chance."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from inference_support import Amounts, row

from gyrodrift.diagnose.features.design_matrix import COLUMNS, DesignMatrix
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER, SLOW
from gyrodrift.diagnose.features.within_second import LAG_FEATURES
from gyrodrift.diagnose.inference.baseline import against, baseline_of
from gyrodrift.diagnose.inference.evidence import NOT_COMPARED
from gyrodrift.diagnose.inference.pooling import evidence_of
from gyrodrift.diagnose.simulate.response_table import ResponseTable

ALL = np.ones(len(FEATURES), bool)
NONE = np.zeros((2, len(FEATURES)))
ITEM = NONE[:1]
RATE, WANDER = NUMBER["rate"], NUMBER["wander_20s"]


def design(seconds: int) -> DesignMatrix:
    item = SimpleNamespace(
        static=SimpleNamespace(vectors=np.zeros((seconds, len(COLUMNS)))),
        lag=SimpleNamespace(vectors=np.zeros((100 * seconds, len(LAG_FEATURES)))),
    )
    return cast("DesignMatrix", item)


def table(difference: Amounts) -> ResponseTable:
    return ResponseTable("one", row(difference), np.full(len(FEATURES), 0.1), NONE[:1], NONE, {})


SHORT, LONG = design(100), design(400)


def test_what_all_have_in_common_cancels() -> None:
    """A device that reads 3 too much in each feature's own units, before and today."""
    own: Amounts = {"rate": 3.0, "wander_20s": 3.0}
    baseline = baseline_of([table(own)] * 4, [SHORT] * 4, ALL)
    (today,) = against([table({"rate": 8.0, "wander_20s": 3.0})], [SHORT], baseline)
    assert today.difference[RATE] == pytest.approx(5.0)
    assert today.difference[WANDER] == pytest.approx(0.0)


def test_another_length_of_recording_does_not_matter() -> None:
    """Coefficients grow with the root of the seconds, 3 in 100 s are 6 in 400 s; a logarithm of a variance does not."""
    baseline = baseline_of([table({"rate": 3.0, "wander_20s": 3.0})] * 4, [SHORT] * 4, ALL)
    (today,) = against([table({"rate": 6.0, "wander_20s": 3.0})], [LONG], baseline)
    assert today.difference[[RATE, WANDER]] == pytest.approx([0.0, 0.0])
    assert baseline.common[RATE] == pytest.approx(0.3)


def test_what_the_simulator_differs_from_itself_by_is_not_the_device() -> None:
    """The mean of the null is taken off first: of 3, one is what replaying leaves."""
    nulls = np.tile(row({"rate": 1.0}), (2, 1))
    item = ResponseTable("one", row({"rate": 3.0}), np.zeros(len(FEATURES)), NONE[:1], nulls, {})
    assert baseline_of([item] * 3, [SHORT] * 3, ALL).common[RATE] == pytest.approx(0.2)


def test_a_device_that_scatters_has_to_differ_by_more() -> None:
    """Recordings of 1 to 5 widen what one has to differ by, and nothing is compared that never moves."""
    scattered = [table({"rate": value}) for value in (1.0, 2.0, 4.0, 5.0)]
    steady = [table({"rate": 3.0})] * 4
    wide, narrow = (baseline_of(item, [SHORT] * 4, ALL) for item in (scattered, steady))
    assert wide.common[RATE] == pytest.approx(narrow.common[RATE])
    assert wide.scatter(ITEM)[RATE] > 1.3 * narrow.scatter(ITEM)[RATE]
    assert narrow.scatter(ITEM)[WANDER] == NOT_COMPARED
    (today,) = against([table({"rate": 8.0})], [SHORT], wide)
    assert today.thresholds[RATE] == pytest.approx(np.hypot(0.1, 10.0 * wide.scatter(ITEM)[RATE]))
    assert today.thresholds[WANDER] == pytest.approx(NOT_COMPARED)


def test_a_scatter_of_many_recordings_is_that_of_the_next_one() -> None:
    values = np.random.default_rng(7).normal(0.0, 1.0, 40)
    baseline = baseline_of([table({"rate": float(value)}) for value in values], [SHORT] * 40, ALL)
    own = 0.1 * float(np.std(values, ddof=1))
    assert 0.95 * own < baseline.scatter(ITEM)[RATE] < 1.5 * own


def test_recordings_that_differ_among_themselves_differ_from_the_baseline_by_chance() -> None:
    """A scatter that only the later ones have widens it too; that of coefficients is that of their motions."""
    steady = baseline_of([table({"rate": 3.0, "wander_20s": 3.0})] * 3, [SHORT] * 3, ALL)
    equal, unlike = (np.array([row({"rate": v, "wander_20s": v}) for v in item]) for item in ((3, 3, 3), (1, 3, 5)))
    assert steady.scatter(unlike)[WANDER] > 1.2 * steady.scatter(equal)[WANDER]
    assert steady.scatter(unlike)[RATE] == pytest.approx(steady.scatter(equal)[RATE])


def test_a_rare_event_of_some_recordings_widens_nothing() -> None:
    """A slip of the encoder in one of three is no scatter of the device."""
    steady = baseline_of([table({"slip_power": 1.0})] * 3, [SHORT] * 3, ALL)
    slipped, none = (np.array([row({"slip_power": v}) for v in item]) for item in ((0, 6, 0), (0, 0, 0)))
    slip = NUMBER["slip_power"]
    assert steady.scatter(slipped)[slip] == pytest.approx(steady.scatter(none)[slip])


def test_what_the_baseline_is_off_by_does_not_average_out() -> None:
    """A mean of nine recordings scatters by as much as that of the three that it is compared with, and more."""
    values = np.random.default_rng(7).normal(0.0, 1.0, 3)
    baseline = baseline_of([table({"rate": float(value)}) for value in values], [SHORT] * 3, ALL)
    of_mean = [baseline.scatter(np.repeat(ITEM, count, axis=0))[RATE] / np.sqrt(count) for count in (1, 9)]
    assert of_mean[1] == pytest.approx(of_mean[0] * np.sqrt((1 / 9 + 1 / 3) / (1 + 1 / 3)))


def test_what_stands_out_by_itself_has_to_be_further_off_the_fewer_recordings_there_are() -> None:
    """The scatter of three recordings is not known well, that of forty is; what is explained as a whole need not."""
    values = np.random.default_rng(7).normal(0.0, 1.0, 40)
    request = [
        baseline_of([table({"wander_20s": float(value)}) for value in values[:count]], [SHORT] * count, ALL)
        for count in (3, 40)
    ]
    few, many = (float(item.extra_sigma(ITEM)[WANDER] / item.scatter(ITEM)[WANDER]) for item in request)
    assert few > 2.0 * many
    (today,) = against([table({"wander_20s": 30.0})], [SHORT], request[0])
    evidence = evidence_of([today], [])
    assert np.broadcast_to(evidence.sigma_factor, len(FEATURES))[WANDER] > 1.5
    assert evidence.z[0, WANDER] > 3.0


def test_one_recording_is_a_baseline_too() -> None:
    baseline = baseline_of([table({"rate": 4.0})], [SHORT], ALL)
    assert baseline.common[RATE] == pytest.approx(0.4)
    assert 0.28 < baseline.scatter(ITEM)[RATE] < 15.0 * 0.28


def test_what_cannot_be_compared_never_deviates() -> None:
    baseline = baseline_of([table({"rate": 3.0})] * 3, [SHORT] * 3, ~ALL)
    tables = against([table({"rate": 1e4, "wander_20s": 1e4})], [SHORT], baseline)
    assert tables[0].difference[RATE] == 1e4
    assert np.abs(evidence_of(tables, []).z).max() < 0.1
    assert baseline.scatter(ITEM)[RATE] == NOT_COMPARED


def test_a_baseline_without_damage_says_that_there_was_none() -> None:
    """Missing samples need no motion to be seen; where a coefficient is 0, its motion may have been missing."""
    baseline = baseline_of([table({})] * 3, [SHORT] * 3, ALL)
    (today,) = against([table({"drop_share": 0.3, "rate": 3.0})], [SHORT], baseline)
    z = evidence_of([today], []).z[0]
    assert z[NUMBER["drop_share"]] == pytest.approx(3.0)
    assert abs(z[RATE]) < 0.1


def test_slow_features_say_nothing_of_single_samples() -> None:
    """Regressors and the bias second by second; no noise, no values, no stamps."""
    names = {FEATURES[number].name for number in np.flatnonzero(SLOW)}
    assert {"rate", "temperature", "turn_sine_rate", "wander_20s", "walk_60s"} <= names
    assert not any(name.startswith(("noise_", "equal_", "stamp_", "arrival_", "angle_", "tails_")) for name in names)


def test_a_late_reference_makes_no_scale_error_uncertain() -> None:
    for cause, is_chance in (("acceleration", False), ("rate_cubed", True)):
        before = baseline_of([table({cause: 5.0, "rate": 1e-3})] * 3, [SHORT] * 3, ALL)
        scatter = before.scatter(np.zeros((3, len(FEATURES))))[RATE]
        assert bool(scatter > 0.03) is is_chance


def test_a_radio_loses_as_much_as_it_likes() -> None:
    """Two per cent before and none today, 0.14 in the root of a share, is no difference; ten times as much is."""
    baseline = baseline_of([table({"drop_share": lost}) for lost in (0.13, 0.14, 0.15)], [SHORT] * 3, ALL)
    for lost, stands_out in ((0.0, False), (1.4, True)):
        today = against([table({"drop_share": lost})] * 3, [SHORT] * 3, baseline)
        z = today[0].difference / today[0].thresholds
        assert (abs(z[NUMBER["drop_share"]]) > 5.0) == stands_out


def test_noise_in_motion_varies_as_that_over_other_lengths_does() -> None:
    """Two recordings that agree over one length and differ by 5 over another say little of either, and all of rest."""
    names = ("noise_fast_1", "noise_fast_4", "noise_rest_1")
    baseline = baseline_of(
        [table(dict(zip(names, (0.01, way * 2.5, 0.01), strict=True))) for way in (-1, 1)], [SHORT] * 2, ALL
    )
    fast, second, rest = (baseline.scatter(ITEM)[NUMBER[name]] for name in names)
    assert 1.0 < fast < second
    assert rest < 0.02
