"""Second parameters of candidates, read off recordings."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import BASE, HINTS, MOTION, plain, session_of, subject_from

from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.candidate_kind import Hints
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.hints import hints_of
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.simulation.sessions import Simulation


def hints_with(*effects: str) -> Hints:
    return hints_of([subject_from(session_of(*map(parse_effect, effects)))])


def test_where_nothing_is_shown_a_hint_is_what_is_usual() -> None:
    """A plain session has neither outliers nor jumps, and its steps are those of the rig."""
    hints = hints_of([plain()])
    assert (hints.spike_dps, hints.slip_deg) == (20.0, 0.5)
    assert hints.rate_step_dps == pytest.approx(0.00763, rel=1e-3)
    assert hints.angle_step_deg == pytest.approx(0.01, rel=1e-3)


def test_a_tone_is_found_at_its_frequency() -> None:
    hints = hints_with("vibration:amplitude_dps=0.3,frequency_hz=17")
    assert hints.line_hz == pytest.approx(17.0, abs=100.0 / 256.0)


def test_steps_and_limits_are_read_off() -> None:
    hints = hints_with("quantization:step_dps=0.25", "saturation:limit_dps=60", "encoder_quantization:cpr=1024")
    assert hints.rate_step_dps == pytest.approx(0.25, rel=2e-3)
    assert hints.largest_dps == pytest.approx(60.0, rel=0.01)
    assert hints.angle_step_deg == pytest.approx(360.0 / 1024.0, rel=0.02)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("is_tie", [True, False])
def test_steps_that_finer_ones_round_are_known_within_what_these_leave(*, seed: int, is_tie: bool) -> None:
    rng = np.random.default_rng(seed)
    lsb_dps = float(rng.choice([0.0076, 0.0153, 0.0305, 0.061]))
    step_dps = lsb_dps * (rng.integers(2, 6) + 0.5 if is_tie else rng.uniform(2.0, 8.0))
    base = BASE.model_copy(update={"dps_per_lsb": lsb_dps, "noise_dps_rthz": rng.uniform(0.002, 0.02)})
    rig = Rig(base=base, effects=(parse_effect(f"quantization:step_dps={step_dps:.6f}"),))
    item = subject_of(recording_of(Simulation(rig, MOTION, seed=seed, minutes=1.5).whole()), Rig(base=base))
    assert hints_of([item]).rate_step_dps == pytest.approx(step_dps, rel=1e-6 if is_tie else 1e-2)


@pytest.mark.parametrize("interval_ms", [24.0, 31.0, 53.0])
def test_bunches_are_as_far_apart_as_they_come(interval_ms: float) -> None:
    assert hints_with(f"usb_batching:interval_ms={interval_ms}").bunch_s == pytest.approx(interval_ms * 1e-3, rel=0.01)
    assert hints_with("sample_drop:share_percent=1").bunch_s == hints_with("timestamp_jitter").bunch_s == 0.0


def test_the_spread_of_ticks_and_the_handover_are_read_off() -> None:
    uneven = hints_with("usb_batching:interval_ms=60,spread_percent=40,handover_ms=2")
    assert uneven.bunch_spread == pytest.approx(0.4, rel=0.1)
    assert uneven.handover_s == pytest.approx(2e-3, rel=0.05)
    even = hints_with("usb_batching:interval_ms=53")
    assert (even.bunch_spread, even.handover_s) == pytest.approx((0.0, 0.0), abs=1e-6)
    assert hints_with("timestamp_jitter").bunch_spread == 0.0


@pytest.mark.parametrize("seed", range(6))
def test_ticks_about_as_far_apart_as_samples_are_found(seed: int) -> None:
    rng = np.random.default_rng(seed)
    rate_hz = float(rng.choice([50.0, 100.0, 200.0]) * rng.uniform(0.99, 1.01))
    interval_ms = 1e3 / rate_hz * float(rng.choice([rng.uniform(0.5, 0.95), rng.uniform(1.05, 1.5)]))
    base = BASE.model_copy(update={"sample_rate_hz": rate_hz, "host_jitter_s": float(rng.choice([0.0, 3e-4]))})
    rig = Rig(base=base, effects=(parse_effect(f"usb_batching:interval_ms={interval_ms}"),))
    item = subject_of(recording_of(Simulation(rig, MOTION, seed=seed, minutes=1.5).whole()), Rig(base=base))
    assert hints_of([item]).bunch_s == pytest.approx(interval_ms * 1e-3, rel=1e-3)


def test_samples_at_the_pace_of_their_own_clock_come_at_no_ticks() -> None:
    for extra in ({"host_jitter_s": 0.0}, {"host_jitter_s": 1e-4, "sample_rate_hz": 99.3}):
        base = BASE.model_copy(update=extra)
        session = Simulation(Rig(base=base), MOTION, seed=1, minutes=1.5).whole()
        assert hints_of([subject_of(recording_of(session), Rig(base=base))]).bunch_s == 0.0


@pytest.mark.parametrize("set_by_s", [-30.0, -1.0, 600.0])
def test_a_host_whose_clock_is_set_is_survived(set_by_s: float) -> None:
    """Back or ahead in the middle of a session: none are known, or ticks of which the true ones are a multiple."""
    rig = Rig(base=BASE, effects=(parse_effect("usb_batching:interval_ms=13"),))
    session = Simulation(rig, MOTION, seed=1, minutes=1.5).whole()
    assert session.t_host_s is not None
    moved_s = session.t_host_s + np.where(np.arange(len(session.t_host_s)) > len(session.t_host_s) // 2, set_by_s, 0.0)
    found_s = hints_of([subject_from(replace(session, t_host_s=moved_s))]).bunch_s
    times = 0.013 / found_s if found_s else 0.0
    assert times == pytest.approx(round(times), abs=0.01)


def test_what_is_shown_is_simulated_and_a_size() -> None:
    for bunch_s, is_own in ((0.053, True), (0.0, False), (0.3, False)):
        (item,) = (item for item in candidates(replace(HINTS, bunch_s=bunch_s)) if item.name == "usb_batching")
        assert (1e3 * bunch_s in item.grid_points, 1e3 * bunch_s in item.sizes) == (is_own, is_own)


def test_uneven_bunches_are_tried_where_they_show() -> None:
    """Spread and handover as shown, beside bunches on even ticks; little of both is not tried."""
    for spread, handover_s, fixed in (
        (0.4, 2e-3, ["", "spread_percent 40, handover_ms 2"]),
        (0.4, 1e-4, ["", "spread_percent 40"]),
        (0.01, 2e-3, ["", "handover_ms 2"]),
        (0.01, 1e-4, [""]),
    ):
        hints = replace(HINTS, bunch_s=0.053, bunch_spread=spread, handover_s=handover_s)
        assert [item.variant for item in candidates(hints) if item.name == "usb_batching"] == fixed


@pytest.mark.parametrize(("slope_dps_per_c", "curve_per_c"), [(0.02, 0.02), (0.01, -0.08)])
def test_a_sweep_of_the_temperature_shows_the_curve_of_the_bias(slope_dps_per_c: float, curve_per_c: float) -> None:
    session = session_of()
    for span_c, shown in ((40.0, curve_per_c), (10.0, 0.0)):
        temp_c = 25.0 + np.linspace(-0.6 * span_c, 0.4 * span_c, len(session.rate_dps))
        bias_dps = slope_dps_per_c * (temp_c - 25.0) * (1.0 + curve_per_c * (temp_c - 25.0))
        heated = replace(session, temp_c=temp_c, rate_dps=session.rate_dps + bias_dps)
        assert hints_of([subject_from(heated)]).curve_per_c == pytest.approx(shown, rel=0.05)
    assert hints_of([plain()]).curve_per_c == 0.0


def test_a_shown_curve_is_tried_beside_the_usual_ones() -> None:
    usual = ["", "curve_per_c -0.01", "curve_per_c 0.01"]
    for curve_per_c, shown in ((0.0, []), (0.08, ["curve_per_c 0.08"]), (-3.0, ["curve_per_c -0.5"])):
        hints = replace(HINTS, curve_per_c=curve_per_c)
        assert [item.variant for item in candidates(hints) if item.name == "temp_bias"] == [*usual, *shown]


@pytest.mark.parametrize("level_dps", [0.0, 1.334])
def test_of_a_single_level_there_are_sizes_all_the_same(level_dps: float) -> None:
    """A part that rests behind steps wider than its noise says one number, and all candidates can be simulated."""
    session = session_of()
    item = replace(
        session, rate_dps=np.full(len(session.rate_dps), level_dps), encoder_deg=np.zeros(len(session.rate_dps))
    )
    hints = hints_of([subject_from(item)])
    assert hints.rate_step_dps == pytest.approx(level_dps or 0.00763)
    for candidate in candidates(hints, Rig(base=BASE)):
        if not candidate.is_out_of_catalogue:
            assert candidate.applied(float(candidate.sizes[0]), ()).name == candidate.name


def test_outliers_are_found_with_their_height() -> None:
    assert hints_with("spikes:height_dps=30,share_percent=0.2").spike_dps == pytest.approx(30.0, rel=0.01)


def test_many_small_outliers_hide_no_few_large_ones() -> None:
    observed = replace(plain().cleaned, spikes_dps=np.array([40.0, -40.0, 40.0, *[3.0] * 20]))
    item = replace(plain(), cleaned=observed)
    assert hints_of([item]).spike_dps == 40.0


def test_outliers_that_coarse_counts_hide_are_found_with_their_height() -> None:
    base = BASE.model_copy(update={"encoder_cpr": 512})
    rig = Rig(base=base, effects=(parse_effect("spikes:height_dps=15,share_percent=0.4"),))
    item = subject_of(recording_of(Simulation(rig, MOTION, seed=1, minutes=1.5).whole()), Rig(base=base))
    assert hints_of([item]).spike_dps == pytest.approx(15.0, rel=0.05)


@pytest.mark.parametrize("step_dps", [0.061, 0.0305])
@pytest.mark.parametrize("seed", range(3))
def test_the_width_of_a_dead_band_is_known_to_part_of_a_step(step_dps: float, seed: int) -> None:
    width_dps = float(np.random.default_rng(seed).uniform(0.2, 0.7))
    base = BASE.model_copy(update={"dps_per_lsb": step_dps, "noise_dps_rthz": 0.006})
    rig = Rig(base=base, effects=(parse_effect(f"deadband:width_dps={width_dps:.4f}"),))
    item = subject_of(recording_of(Simulation(rig, MOTION, seed=seed, minutes=3.0).whole()), Rig(base=base))
    assert hints_of([item]).least_dps == pytest.approx(width_dps, abs=0.3 * step_dps)


@pytest.mark.parametrize("leaks", [0, 1, 2])
def test_a_dead_band_may_leak_twice(leaks: int) -> None:
    item = subject_from(session_of(parse_effect("deadband:width_dps=0.5")))
    near = np.concatenate([np.linspace(0.1, 0.12, leaks), np.random.default_rng(1).uniform(0.5, 3.0, 300)])
    rate_dps = np.where(np.abs(item.cleaned.recording.rate_dps) < 3.0, 0.0, item.cleaned.recording.rate_dps)
    rate_dps[: len(near)] = near
    observed = replace(item.cleaned, recording=replace(item.cleaned.recording, rate_dps=rate_dps))
    assert hints_of([replace(item, cleaned=observed)]).least_dps == pytest.approx(0.5, abs=0.02)


def test_without_a_dead_band_all_that_rounds_to_a_step_is_put_out() -> None:
    """Zero is what is nearer to it than half a step."""
    base = BASE.model_copy(update={"dps_per_lsb": 0.061, "noise_dps_rthz": 0.02})
    rig = Rig(base=base)
    item = subject_of(recording_of(Simulation(rig, MOTION, seed=1, minutes=3.0).whole()), rig)
    assert hints_of([item]).least_dps == pytest.approx(0.0305, abs=0.3 * 0.061)


@pytest.mark.parametrize("offset", [0.004, 0.02, 0.03, 0.045, 0.06])
def test_sizes_are_above_zero_where_a_bias_was_taken_off_coarse_steps(offset: float) -> None:
    base = BASE.model_copy(update={"dps_per_lsb": 0.061, "noise_dps_rthz": 0.003})
    session = Simulation(Rig(base=base), MOTION, seed=2, minutes=1.5).whole()
    shown = hints_of([subject_of(recording_of(replace(session, rate_dps=session.rate_dps - offset)), Rig(base=base))])
    assert 0.0 < shown.least_dps < 0.061
    assert shown.rate_step_dps == pytest.approx(0.061, rel=0.02)


def test_a_slip_is_found_with_its_height() -> None:
    assert hints_with("encoder_slip:step_deg=2,per_hour=200").slip_deg == pytest.approx(2.0, rel=0.05)


def test_of_several_sessions_the_median_counts_and_the_largest_rate_of_all() -> None:
    """Two with steps and one without: the step is theirs."""
    coarse = subject_from(session_of(parse_effect("quantization:step_dps=0.25")))
    hints = hints_of([coarse, plain(), coarse])
    assert hints.rate_step_dps == pytest.approx(0.25, rel=2e-3)
    assert hints.largest_dps == max(float(np.abs(item.cleaned.rate_dps).max()) for item in (coarse, plain()))


@pytest.mark.parametrize(("sample_period_s", "most_ms"), [(0.0035, 5.0), (0.0525, 21.0)])
def test_stamps_scatter_no_further_than_samples_are_apart(sample_period_s: float, most_ms: float) -> None:
    hints = replace(hints_of([plain()]), sample_period_s=sample_period_s)
    (jitter,) = [item for item in candidates(hints, Rig(base=BASE)) if item.name == "timestamp_jitter"]
    assert jitter.sizes[-1] == pytest.approx(most_ms)
