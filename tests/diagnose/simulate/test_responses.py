"""How features respond to known effects on a short session, against what the effects do by hand."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d
from simulate_support import HINTS, MOTION, RATE_HZ, base_run, candidate_of, feature, plain, response_at

from firmware_sim.rig import parse_effect
from gyrodrift.diagnose.features.vector import FEATURES, STATIC
from gyrodrift.diagnose.simulate.candidate import Touches
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.recalibration import recalibrated_with
from gyrodrift.diagnose.simulate.responses import plausible, points_of, response_table
from gyrodrift.values.arrays import Floats

OF_TIMES = np.array(
    [item.name.startswith(("clock_", "stamp_", "arrival_", "drop_", "repeat_", "disorder_")) for item in FEATURES]
)
LINEAR_FEATURES = ("rate", "abs_rate", "rate_cubed", "turn_sine", "turn_cosine", "lag")


def true_dps() -> Floats:
    """The rate of the table at the samples."""
    rate_dps: Floats = MOTION.motion_at(np.arange(plain().design.samples) / RATE_HZ)[1]
    return rate_dps


def test_a_gain_moves_the_rate_coefficient_by_its_share_of_the_rate() -> None:
    seconds = true_dps()[: plain().design.samples // 100 * 100].reshape(-1, 100).mean(axis=1)
    moved = feature(response_at(candidate_of("scale_factor"), 1.0), "rate")
    assert moved == pytest.approx(0.01 * np.linalg.norm(seconds - seconds.mean()), rel=5e-3)


def test_a_delay_moves_the_lag_by_delay_times_acceleration() -> None:
    rate_dps = gaussian_filter1d(true_dps(), 0.02 * RATE_HZ)
    expected = np.column_stack([np.ones(len(rate_dps)), rate_dps, np.abs(rate_dps)])
    accelerations = np.gradient(rate_dps, 1.0 / RATE_HZ)
    next_to = accelerations - expected @ np.linalg.lstsq(expected, accelerations, rcond=None)[0]
    short, long = feature(response_at(candidate_of("latency"), 2.0, 8.0), "lag")[:, 0]
    assert long == pytest.approx(-0.008 * np.linalg.norm(next_to), rel=0.02)
    assert long / short == pytest.approx(4.0, rel=0.05)


@pytest.mark.parametrize(
    "name", [name for name, kind in KINDS.items() if len(kind.candidates(HINTS)[0].grid_points) == 2]
)
def test_a_linear_effect_responds_half_at_half_the_size_and_turns_with_its_sign(name: str) -> None:
    candidate = candidate_of(name)
    most = float(candidate.grid_points[-1])
    whole, half, opposite = response_at(candidate, most, most / 2.0, -most)[:, 0]
    for item in LINEAR_FEATURES:
        assert feature(half, item) == pytest.approx(0.5 * feature(whole, item), abs=1e-6 + 1e-9 * most)
        assert feature(opposite, item) == pytest.approx(-feature(whole, item), abs=1e-6 + 1e-9 * most)


@pytest.mark.parametrize(
    ("text", "form"),
    [
        ("warmup:amplitude_dps=0.4,time_constant_s=180,fast_share=0.4,fast_time_constant_s=30", "fast_share"),
        ("warmup:amplitude_dps=-0.4,time_constant_s=35", "time_constant_s 35"),
        ("temp_bias:slope_dps_per_c=0.1,curve_per_c=0.013", "curve_per_c 0.01"),
        ("temp_bias:slope_dps_per_c=-0.1,curve_per_c=-0.007", "curve_per_c -0.01"),
    ],
)
def test_a_slow_bias_is_known_by_its_form(text: str, form: str) -> None:
    effect = parse_effect(text)
    moved = (plain().simulated((effect,), 0).values - base_run(0).values)[:STATIC]
    result: list[tuple[float, float, str]] = []
    for item in KINDS[effect.name].candidates(HINTS):
        most = float(item.grid_points[-1])
        step = response_at(item, most)[0, 0, :STATIC] / most
        size = float(step @ moved / (step @ step))
        result.append((float(np.linalg.norm(moved - size * step)), size, item.variant))
    _, size, variant = min(result)
    assert form in variant
    assert size == pytest.approx(getattr(effect, KINDS[effect.name].parameter), rel=0.15)


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.touches is Touches.TIMES])
def test_an_effect_on_times_leaves_rate_and_angle_alone(name: str) -> None:
    """Simulated in full, only features of clock and link move; the period by the host's clock is hardly another one."""
    candidate = candidate_of(name)
    effect = candidate.make(float(candidate.grid_points[-1]))
    moved = plain().simulated((effect,), 0).values - base_run(0).values
    assert np.abs(moved[~OF_TIMES]).max() < 0.005
    assert np.abs(moved[OF_TIMES]).max() > 1e-3


def test_a_clock_that_drifts_moves_the_ratio_of_the_clocks_by_that() -> None:
    moved = response_at(candidate_of("clock_drift"), 5000.0)
    assert feature(moved, "clock_ratio") == pytest.approx(0.005, abs=1e-9)


@cache
def scale_of_chance() -> Floats:
    """(F,) of features of the plain session: null runs and relevance thresholds."""
    table = response_table(plain(), [], null_runs=6)
    scale: Floats = np.sqrt(table.nulls.var(axis=0, ddof=1) + table.thresholds**2)
    return scale


@pytest.mark.parametrize("name", [name for name, kind in KINDS.items() if kind.touches is Touches.VALUES])
def test_an_effect_on_values_leaves_times_alone(name: str) -> None:
    """The response is that of a full simulation, with its own rebuilt motion, but for a share of it and of chance."""
    candidate = candidate_of(name)
    size = float(candidate.grid_points[len(candidate.grid_points) // 2])
    effects = (candidate.make(size),)
    moved = recalibrated_with(plain(), effects).simulated(effects, 0).values - base_run(0).values
    assert not moved[OF_TIMES].any()
    off = np.abs(response_at(candidate, size)[0, 0] - moved)
    cross_talk = np.where(np.arange(len(moved)) < STATIC, 0.04 * np.linalg.norm(moved[:STATIC]), 0.0)
    allowed = 0.2 * np.abs(moved) + cross_talk + 3.0 * scale_of_chance()
    assert [FEATURES[number].name for number in np.flatnonzero(off > allowed)] in ([], ["reach"])


@pytest.mark.parametrize(
    "name", [name for name, kind in KINDS.items() if kind.touches is Touches.SLOW_RATE and kind.realisations == 1]
)
def test_an_effect_on_the_slow_rate_is_added_as_the_rig_would(name: str) -> None:
    """The response without a new simulation is that of one, but for a count of rounding."""
    candidate = candidate_of(name)
    size = float(candidate.grid_points[len(candidate.grid_points) // 2])
    full = plain().simulated((candidate.make(size),), 0).values - base_run(0).values
    added = response_at(candidate, size)[0, 0]
    for item in LINEAR_FEATURES:
        assert feature(added, item) == pytest.approx(feature(full, item), abs=0.02, rel=0.02)


def test_a_response_of_the_slow_rate_has_no_part_in_times() -> None:
    for name in ("scale_factor", "?wander_20s"):
        assert not response_at(candidate_of(name), 0.1)[0, 0][OF_TIMES].any()


def test_realisations_differ_and_come_again() -> None:
    """Popcorn twice is twice the same draws, which are not each other."""
    popcorn = replace(candidate_of("popcorn"), realisations=5)
    drawn = response_at(popcorn, 0.1)
    assert drawn.shape == (1, 5, len(FEATURES))
    assert np.array_equal(drawn, response_at(popcorn, 0.1))
    assert len(np.unique(drawn[0], axis=0)) == 5


def test_the_table_of_a_session_without_a_gap_is_within_its_null_distribution() -> None:
    """Differences, thresholds, runs and nulls have one column for each feature; a session of the rig differs little."""
    tried = [candidate_of("scale_factor"), replace(candidate_of("g_sensitivity"), phase_deg=30.0)]
    table = response_table(plain(), tried, null_runs=6)
    assert list(table.responses) == ["scale_factor "]
    assert table.responses["scale_factor "].shape == (2, 1, len(FEATURES))
    assert table.runs.shape[1] == table.nulls.shape[1] == len(FEATURES)
    sigma = np.hypot(table.nulls.std(axis=0, ddof=1), table.thresholds)
    off = np.abs(table.difference - table.nulls.mean(axis=0))[sigma > 0.0] / sigma[sigma > 0.0]
    assert np.quantile(off, 0.95) < 3.0


def test_a_grid_ends_at_the_first_size_that_a_recording_rules_out() -> None:
    """A delay of 400 ms is not simulated in a session without a delay; its prior probability stays counted."""
    latency = candidate_of("latency")
    table = response_table(plain(), [latency], null_runs=1)
    points = points_of(table)["latency "]
    assert 2 <= points < len(latency.grid_points)
    (kept,) = plausible([latency], [table])
    assert kept.grid_points.tolist() == latency.grid_points[:points].tolist()
    assert kept.sizes.max() <= kept.grid_points[-1]
    assert len(kept.sizes) + kept.ruled_out == len(latency.sizes)
    again = response_table(
        plain(), [latency, candidate_of("scale_factor")], 1, {"latency ": points, "scale_factor ": 0}
    )
    assert np.array_equal(again.responses["latency "], table.responses["latency "])
    assert "scale_factor " not in again.responses
