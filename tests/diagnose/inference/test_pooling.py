"""Evidence out of tables of single sessions: nulls pooled, responses taken to sizes that were not simulated."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import candidate, row

from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, LINEAR, NUMBER
from gyrodrift.diagnose.inference.log_variances import interpolated, scaled
from gyrodrift.diagnose.inference.nulls import beyond_chance, common_share
from gyrodrift.diagnose.inference.pooling import evidence_of
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.response_table import ResponseTable, key, simulated_key
from gyrodrift.values.arrays import Floats

LOG = FEATURES[int(np.flatnonzero(IS_LOG)[0])].name
SHARE = FEATURES[int(np.flatnonzero(~IS_LOG & ~LINEAR)[0])].name


NONE = np.zeros(len(FEATURES))


def table(name: str, nulls: Floats, answers: dict[str, Floats] | None = None) -> ResponseTable:
    return ResponseTable(
        name, row({"rate": 7.0}), row({"rate": 2.0}), np.zeros((1, len(FEATURES))), nulls, answers or {}
    )


def test_nulls_of_all_sessions_are_one_sample() -> None:
    """Their mean is taken off, their spread and the relevance threshold are one sigma.

    About 2 they are −2, 0 and −1, 3. Run by run their means are −1.5 and 1.5, of variance 4.5, where independent ones
    would have half of 3.5: 2.57 times that, which two runs' worth of 1 and one of data take to 1.52.
    """
    nulls = [np.array([row({"rate": 1e-12}), row({"rate": 2.0})]), np.array([row({"rate": 1.0}), row({"rate": 5.0})])]
    evidence = evidence_of([table("one", nulls[0]), table("two", nulls[1])], [])
    index = NUMBER["rate"]
    pooled = np.var([0.0, 2.0, 1.0, 5.0], ddof=1)
    own = np.array([[pooled], [0.5 * (pooled + 5.0)]])  # the second scatters by more, 1 and 9
    variance = own * (2.0 + 2.0 * 4.5 / 3.5) / 3.0
    variance += 2.0 * (2.0**2 - np.var([0.0, 2.0, 1.0, 5.0], ddof=1) / 4.0)  # of rebuilding, shared by both
    assert evidence.names == ("one", "two")
    assert evidence.difference[:, index] == pytest.approx([5.0, 5.0])
    assert evidence.sigma[:, index, None] == pytest.approx(np.sqrt(variance + 4.0))
    assert evidence.nulls[:, :, index] == pytest.approx(np.array([[-2.0, 0.0], [-1.0, 3.0]]) / np.sqrt(variance + 4.0))
    assert evidence.z[0, index] == pytest.approx(5.0 / np.sqrt(variance[0, 0] + 4.0))


def test_sessions_that_have_no_such_motion_make_no_spread_smaller() -> None:
    own = np.array([row({"rate_cubed": value}) for value in (-3.0, 1.0, 2.0, 4.0)])
    absent = np.zeros_like(own)
    evidence = evidence_of([table("fast", own), table("slow", absent), table("slower", absent)], [])
    index = NUMBER["rate_cubed"]
    share = common_share(np.array([own - row({"rate_cubed": 1.0}), absent, absent]))[index]
    assert evidence.sigma[0, index] == pytest.approx(np.sqrt(np.var([-3.0, 1.0, 2.0, 4.0], ddof=1) * share))
    assert evidence.difference[:, index] == pytest.approx([-1.0, 0.0, 0.0])


def test_a_session_that_scatters_more_than_others_is_believed_less() -> None:
    wide, narrow = (np.array([row({"rate_cubed": size * way}) for way in (-1.0, 1.0)] * 8) for size in (3.0, 1.0))
    evidence = evidence_of([table("fast", wide), table("slow", narrow)], [])
    pooled = (9.0 + 1.0) * 16.0 / 31.0
    share = common_share(np.array([wide, narrow]))[NUMBER["rate_cubed"]]
    expected = np.sqrt(np.array([0.5 * (pooled + 9.0), pooled]) * share)
    assert evidence.sigma[:, NUMBER["rate_cubed"]] == pytest.approx(expected)


def test_what_sessions_have_in_common_widens_their_mean() -> None:
    """Four sessions with the same eight nulls: the variance of the mean is that of a single session.

    Two runs' worth of 1 hold it back: (2 + 7·4·8/7 / 1) / 9 of ±1, and never less than 1.
    """
    runs = np.array([1.0, -1.0, 1.0, -1.0, 1.0, -1.0, 1.0, -1.0])[:, None]
    assert common_share(np.array([runs] * 4)) == pytest.approx([(2.0 + 32.0) / 9.0])
    assert common_share(np.array([runs, -runs, runs, -runs])) == pytest.approx([1.0])
    assert common_share(np.array([runs])) == pytest.approx([1.0])
    independent = np.random.default_rng(3).standard_normal((4, 8, 500))
    assert common_share(independent).mean() == pytest.approx(1.0, abs=0.25)


def test_a_feature_that_these_motions_do_not_have_never_deviates() -> None:
    evidence = evidence_of([table("one", np.zeros((2, len(FEATURES))))], [])
    assert np.isfinite(evidence.z).all()
    assert evidence.z[0, NUMBER["abs_rate"]] == 0.0


def test_sizes_between_two_that_were_simulated_are_interpolated() -> None:
    """Along the logarithm of the size: 2 lies half way between 1 and 4."""
    item = replace(candidate("latency"), grid_points=np.array([1.0, 4.0, 16.0]), sizes=np.array([1.0, 2.0, 4.0, 16.0]))
    nodes = np.array([row({"lag": 10.0}), row({"lag": 30.0}), row({"lag": 50.0})])[:, None]
    assert interpolated(item, nodes)[:, 0, NUMBER["lag"]] == pytest.approx([10.0, 20.0, 30.0, 50.0])


def test_a_linear_effect_is_scaled_to_both_sides_of_zero() -> None:
    item = replace(candidate("scale_factor"), grid_points=np.array([-1.0, 1.0]), sizes=np.array([-2.0, -0.5, 0.5, 2.0]))
    nodes = np.array([row({"rate": -10.0}), row({"rate": 12.0})])[:, None]
    assert interpolated(item, nodes)[:, 0, NUMBER["rate"]] == pytest.approx([-20.0, -5.0, 6.0, 24.0])


def test_what_a_linear_effect_does_to_variances_grows_with_its_square() -> None:
    result = scaled(row({LOG: np.log(2.0), SHARE: 0.5, "rate": 1.0}), np.array([0.5, 2.0]))
    assert result[:, NUMBER[LOG]] == pytest.approx(np.log([1.25, 5.0]))
    assert result[:, NUMBER[SHARE]] == pytest.approx([0.25, 0.5])
    assert result[:, NUMBER["rate"]] == pytest.approx([0.5, 2.0])


def test_a_phase_is_turned_out_of_its_sine_and_cosine() -> None:
    item = replace(
        candidate("scale_factor"),
        name="g_sensitivity",
        phase_deg=30.0,
        grid_points=np.array([1.0]),
        sizes=np.array([2.0]),
    )
    answers = {
        simulated_key(item, 0.0): row({"turn_sine": 4.0})[None, None],
        simulated_key(item, 90.0): row({"turn_cosine": 4.0})[None, None],
    }
    (response,) = evidence_of([table("one", np.zeros((2, len(FEATURES))), answers)], [item]).responses
    assert response.mean[0, 0, NUMBER["turn_sine"]] == pytest.approx(8.0 * np.cos(np.pi / 6.0))
    assert response.mean[0, 0, NUMBER["turn_cosine"]] == pytest.approx(8.0 * np.sin(np.pi / 6.0))


def test_realisations_are_kept_for_each_session() -> None:
    item = replace(candidate("rate_random_walk"), realisations=2, grid_points=np.array([1.0]), sizes=np.array([1.0]))
    draws = np.array([[row({"time": 3.0}), row({"time": 1.0})], [row({"time": -3.0}), row({})]])
    tables = [table(str(number), NONE + np.zeros((2, 1)), {key(item): draw[None]}) for number, draw in enumerate(draws)]
    (response,) = evidence_of(tables, [item]).responses
    assert response.realized is not None
    assert np.array_equal(response.realized[0], draws)
    assert response.mean[0, :, NUMBER["time"]] == pytest.approx([2.0, -1.5])


def turning(phase_deg: float) -> Candidate:
    """Once per turn at any phase, simulated at amplitude 1 and tried at 1 to 4."""
    return replace(
        candidate("scale_factor"),
        name="g_sensitivity",
        phase_deg=phase_deg,
        is_phase_free=True,
        grid_points=np.array([1.0]),
        sizes=np.array([1.0, 2.0, 4.0]),
    )


def at_phase(deg: float, amplitude: float) -> Floats:
    """(F,) what a session shows of it: 3 per amplitude in the sine, and 3 in the cosine."""
    phase = np.deg2rad(deg)
    return row({"turn_sine": 3.0 * amplitude * np.cos(phase), "turn_cosine": 3.0 * amplitude * np.sin(phase)})


def test_a_free_phase_is_found_in_each_session_at_one_amplitude() -> None:
    shown = (30.0, 200.0)
    tried = [turning(deg) for deg in (0.0, 30.0, 60.0)]
    answers = {simulated_key(tried[0], deg): at_phase(deg, 1.0)[None, None] for deg in (0.0, 90.0)}
    tables = [
        replace(table(str(deg), np.zeros((2, len(FEATURES))), answers), difference=at_phase(deg, 4.0)) for deg in shown
    ]
    evidence = evidence_of(tables, tried)
    (response,) = evidence.responses
    assert response.phases_deg is not None
    assert response.phases_deg % 360.0 == pytest.approx(shown)
    assert response.mean[2] == pytest.approx(evidence.difference, abs=1e-12)
    assert response.mean[1] == pytest.approx(0.5 * evidence.difference, abs=1e-12)


def test_a_phase_is_found_where_sine_and_cosine_share_what_they_change() -> None:
    """A turn and a half shows less of one than of the other, and what is like both: no two are at right angles."""
    at_0, at_90 = row({"turn_sine": 3.0, "turn_sine_rate": 2.0}), row({"turn_cosine": 1.0, "turn_sine_rate": 2.0})
    item = turning(0.0)
    answers = {simulated_key(item, deg): index[None, None] for deg, index in ((0.0, at_0), (90.0, at_90))}
    for shown_deg in (-150.0, -40.0, 20.0, 70.0):
        phase = np.deg2rad(shown_deg)
        difference = 2.0 * (np.cos(phase) * at_0 + np.sin(phase) * at_90)
        shown = replace(table("one", np.zeros((2, len(FEATURES))), answers), difference=difference)
        (response,) = evidence_of([shown], [item]).responses
        assert response.phases_deg == pytest.approx([shown_deg])


def test_another_cause_does_not_turn_a_phase() -> None:
    answers = {
        simulated_key(turning(0.0), deg): (at_phase(deg, 1.0) + row({"abs_rate": 0.5}))[None, None]
        for deg in (0.0, 90.0)
    }
    difference = at_phase(70.0, 2.0) + row({"abs_rate": -40.0})
    shown = replace(table("one", np.zeros((2, len(FEATURES))), answers), difference=difference)
    (response,) = evidence_of([shown], [turning(0.0)]).responses
    assert response.phases_deg == pytest.approx([70.0])


def test_the_phase_of_the_weaker_of_two_is_found_beside_the_stronger() -> None:
    """An eccentric encoder errs in what a tilt changes, too: by itself the tilt would have its phase."""
    tilt = turning(0.0)
    encoder = replace(tilt, name="encoder_eccentricity", sizes=np.array([4.0, 8.0, 12.0]))
    bias = {deg: at_phase(deg, 1.0) for deg in (0.0, 90.0)}
    angle = {
        0.0: row({"turn_sine_rate": 6.0, "turn_cosine": 2.0}),
        90.0: row({"turn_cosine_rate": 6.0, "turn_sine": 2.0}),
    }
    answers = {
        simulated_key(item, deg): index[deg][None, None]
        for item, index in ((tilt, bias), (encoder, angle))
        for deg in index
    }
    tilt_deg, encoder_deg = 30.0, -140.0
    phase = np.deg2rad(encoder_deg)
    difference = at_phase(tilt_deg, 2.0) + 8.0 * (np.cos(phase) * angle[0.0] + np.sin(phase) * angle[90.0])
    shown = replace(table("one", np.zeros((2, len(FEATURES))), answers), difference=difference)
    evidence = evidence_of([shown], [tilt, encoder])
    result = {
        name: [item.phases_deg for item in evidence.responses if item.candidate.name == name]
        for name in (tilt.name, encoder.name)
    }
    assert result[encoder.name][0] == pytest.approx([encoder_deg], abs=20.0)
    assert result[tilt.name][0] != pytest.approx([tilt_deg], abs=30.0)
    assert result[tilt.name][1] == pytest.approx([tilt_deg], abs=20.0)


def test_a_phase_is_weighed_by_what_is_known() -> None:
    """A sine that chance makes as large says nothing of the phase: it is that of the cosine."""
    item = replace(turning(0.0), sizes=np.array([1.0, 5.0 / 3.0, 4.0]))
    answers = {simulated_key(item, deg): at_phase(deg, 1.0)[None, None] for deg in (0.0, 90.0)}
    noisy = np.array([row({"turn_sine": sine, "turn_cosine": 1e-9}) for sine in (100.0, -100.0)])
    shown = replace(table("one", noisy, answers), difference=row({"turn_sine": 5.0, "turn_cosine": 5.0}))
    (response,) = evidence_of([shown], [item]).responses
    assert response.phases_deg is not None
    assert response.phases_deg[0] == pytest.approx(90.0, abs=1.0)


def test_what_rebuilding_changes_it_may_have_changed_before() -> None:
    """A null that is off by 5 on average: the recordings may be by as much, however many they are."""
    number = NUMBER["wander_20s"]
    nulls = np.zeros((8, len(FEATURES)))
    nulls[:, number] = 5.0 + np.tile([-0.5, 0.5], 4)
    for sessions in (2, 6):
        tables = [
            ResponseTable(f"s{n}", row({"wander_20s": -3.0}), np.zeros(len(FEATURES)), nulls, nulls, {})
            for n in range(sessions)
        ]
        z = evidence_of(tables, []).z[:, number]
        assert z.mean() * np.sqrt(sessions) == pytest.approx(-8.0 / 5.0, rel=0.05)


def test_a_null_that_is_off_by_chance_widens_nothing() -> None:
    nulls = np.random.default_rng(2).normal(0.0, 1.0, (12, len(FEATURES)))
    result = beyond_chance(nulls.mean(axis=0), nulls.var(axis=0, ddof=1) / len(nulls))
    assert np.median(result) < 0.01
    assert result.mean() < 0.15


def test_a_regressor_that_some_replays_lack_is_not_compared() -> None:
    number = NUMBER["direction"]
    for present in (0, 3, 8):
        nulls = np.random.default_rng(1).normal(0.0, 1.0, (8, len(FEATURES)))
        nulls[present:, number] = 0.0
        table = ResponseTable("s", row({"direction": 9.0}), np.full(len(FEATURES), 1e-3), nulls, nulls, {})
        z = evidence_of([table], []).z[0, number]
        assert bool(abs(z) > 3.0) is (present == 8)


def test_a_clock_that_is_exact_in_every_replay_is_compared() -> None:
    """Every recording has a clock ratio, so that a null of 0 says how exact it is."""
    nulls = np.random.default_rng(1).normal(0.0, 1.0, (8, len(FEATURES)))
    nulls[:, NUMBER["clock_ratio"]] = 0.0
    table = ResponseTable("s", row({"clock_ratio": 9.0}), np.ones(len(FEATURES)), nulls, nulls, {})
    assert evidence_of([table], []).z[0, NUMBER["clock_ratio"]] == pytest.approx(9.0)
