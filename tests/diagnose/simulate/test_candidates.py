"""Records of candidates: what is tried of each effect, in which sizes."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import BASE, HINTS, candidate_of

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.report.effect_words import SENTENCES
from gyrodrift.diagnose.simulate.candidate import Candidate, Touches
from gyrodrift.diagnose.simulate.candidate_kind import SAME_SIZE, Hints
from gyrodrift.diagnose.simulate.candidates import KINDS, candidates, register
from gyrodrift.diagnose.simulate.grids import between, linear_grid, simulated_grid
from gyrodrift.diagnose.simulate.response_table import key


def of(name: str, hints: Hints = HINTS) -> list[Candidate]:
    return [item for item in candidates(hints) if item.name == name]


def test_every_effect_has_a_record() -> None:
    assert set(KINDS) == set(CATALOGUE)
    assert all(kind.meaning or name in SENTENCES for name, kind in KINDS.items())


@pytest.mark.parametrize("name", KINDS)
def test_every_size_is_one_that_the_simulator_takes(name: str) -> None:
    for candidate in of(name):
        for size in (*candidate.grid_points, candidate.sizes[0], candidate.sizes[-1]):
            effect = candidate.make(float(size))
            assert effect.name == name
            assert hasattr(effect, candidate.parameter)


def test_variants_of_an_effect_are_told_apart() -> None:
    keys = [(item.name, item.variant) for item in candidates(HINTS)]
    assert len(set(keys)) == len(keys)


def test_groups_hold_effects_that_look_alike() -> None:
    """Latency and bandwidth both lag; a scale factor is alone but for its name."""
    assert KINDS["latency"].group == KINDS["bandwidth"].group == "lag"
    assert {item.group for item in candidates(HINTS) if item.name == "saturation"} == {"saturation"}


def test_hints_become_second_parameters_and_sizes() -> None:
    """The tone's frequency, the height of outliers, and steps that are read off."""
    hints = replace(HINTS, line_hz=33.0, spike_dps=7.0, rate_step_dps=0.125, angle_step_deg=1.0)
    assert of("vibration", hints)[0].make(1.0).model_dump()["frequency_hz"] == 33.0
    assert of("spikes", hints)[0].make(1.0).model_dump()["height_dps"] == 7.0
    assert [item.sizes.tolist() for item in of("quantization", hints)] == [[0.125]]
    assert of("encoder_quantization", hints)[0].make(1.0).model_dump()["cpr"] == 360


def test_steps_no_coarser_than_those_of_the_rig_are_the_rigs() -> None:
    for step_dps in (1e-6, 0.0076, 0.009):
        (fine,) = of("quantization", replace(HINTS, rate_step_dps=step_dps))
        assert fine.sizes.tolist() == [max(step_dps, HINTS.dps_per_lsb)]


def test_a_low_pass_has_its_time_constant_as_its_size() -> None:
    effect = candidate_of("bandwidth").make(1.0 / (20.0 * np.pi))
    assert effect.model_dump()["cutoff_hz"] == pytest.approx(10.0)


def test_a_low_pass_is_tried_in_either_order() -> None:
    tried = of("bandwidth")
    assert [item.make(item.sizes[0]).model_dump()["order"] for item in tried] == [1, 2]
    assert len({key(item) for item in tried}) == 2


def test_what_comes_once_per_turn_is_tried_in_twelve_phases() -> None:
    assert [item.phase_deg for item in of("g_sensitivity")] == [30.0 * step for step in range(12)]


def test_sizes_stand_in_even_ratios() -> None:
    """Twenty-four to a decade, with both ends."""
    sizes = between(0.01, 10.0)
    assert len(sizes) == 73
    assert sizes[[0, 24, 48, 72]] == pytest.approx([0.01, 0.1, 1.0, 10.0])
    assert np.ptp(np.diff(np.log(sizes))) < 1e-12


def test_a_linear_grid_has_both_signs_and_two_points_within() -> None:
    """A tenth of the largest size either way."""
    grid = linear_grid(0.01, 10.0)
    assert grid.points.tolist() == [-1.0, 1.0]
    assert np.array_equal(grid.sizes, -grid.sizes[::-1])
    assert (grid.sizes[0], grid.sizes[-1]) == (-10.0, 10.0)


def test_a_simulated_grid_decides_between_its_first_and_last_point() -> None:
    grid = simulated_grid(0.3, 2.0, 8.0)
    assert grid.points.tolist() == [0.3, 2.0, 8.0]
    assert (grid.sizes[0], grid.sizes[-1]) == pytest.approx((0.3, 8.0))


def test_a_record_that_cannot_be_is_refused() -> None:
    expected = KINDS["latency"]
    with pytest.raises(ValueError, match="no such effect"):
        register(replace(expected, name="gremlins"))
    with pytest.raises(ValueError, match="candidate already"):
        register(expected)


def beside(text: str, *, absolute: bool = False) -> tuple[Effect, list[Candidate]]:
    """An effect in a rig, and what is tried of it there."""
    effect = parse_effect(text)
    rig = Rig(base=BASE.model_copy(update={"encoder_absolute": absolute}), effects=(effect,))
    return effect, [item for item in candidates(HINTS, rig) if item.name == effect.name]


@pytest.mark.parametrize(
    "text", ["scale_factor:error_percent=1.2", "temp_bias", "clock_drift", "warmup", "warmup:amplitude_dps=0.2"]
)
def test_of_a_linear_effect_in_the_rig_sizes_are_what_comes_on_top(text: str) -> None:
    effect, (candidate,) = beside(text)
    name = candidate.parameter
    has = effect.model_dump()[name]
    assert candidate.in_rig == effect
    assert np.array_equal(candidate.sizes, candidate_of(effect.name).sizes)
    for size in (candidate.sizes[3], candidate.sizes[-3]):
        assert candidate.make(size).model_dump() == {**effect.model_dump(), name: pytest.approx(has + size)}
        assert candidate.make(size).model_fields_set == set(type(effect).model_fields)  # a report lists what is stated
        # What is simulated beside the rig is what comes on top alone.
        assert candidate.added(size, (effect,)).model_dump() == {**effect.model_dump(), name: size}


@pytest.mark.parametrize("text", ["g_sensitivity:amplitude_dps=0.1", "encoder_eccentricity:amplitude_deg=0.3"])
def test_an_amplitude_in_the_rig_goes_down_to_nothing(text: str) -> None:
    effect, (candidate,) = beside(f"{text},phase_deg=30")
    name = candidate.parameter
    assert candidate.make(candidate.sizes[0]).model_dump()[name] == pytest.approx(0.0, abs=1e-12)
    assert (np.diff(candidate.sizes) > 0.0).all()
    assert not candidate.is_phase_free
    in_session = effect.model_copy(update={"phase_deg": 77.0})
    assert candidate.applied(0.05, (in_session,)).model_dump()["phase_deg"] == 77.0
    assert candidate.added(0.05, (in_session,)).model_dump() == {"name": effect.name, name: 0.05, "phase_deg": 77.0}
    assert candidate.added(-0.05, (in_session,)).model_dump() == {"name": effect.name, name: 0.05, "phase_deg": 257.0}


@pytest.mark.parametrize(
    ("text", "variants"),
    [("latency:delay_ms=20", 1), ("backlash", 1), ("popcorn", 3), ("quantization:step_dps=0.3", 1), ("bandwidth", 2)],
)
def test_of_any_other_effect_in_the_rig_sizes_are_instead(text: str, variants: int) -> None:
    """The grid is that of one that the rig has not, but for sizes so near to its own that they are no others.

    Simulated in full, since the one in the rig is taken away.
    """
    effect, result = beside(text)
    fresh = of(effect.name)
    assert len(result) == len(fresh) == variants
    for candidate, second in zip(result, fresh, strict=True):
        assert candidate.in_rig == effect
        has = getattr(effect, second.parameter)
        near = [size for size in second.sizes.tolist() if size not in candidate.sizes]
        assert all(abs(getattr(second.make(size), second.parameter) / has - 1.0) < SAME_SIZE for size in near)
        assert candidate.make(candidate.sizes[0]) == second.make(second.sizes[0])
        assert candidate.touches is not Touches.SLOW_RATE


@pytest.mark.parametrize("cutoff_hz", np.geomspace(3.0, 60.0, 23).tolist())
def test_the_size_in_the_rig_is_no_other_size(cutoff_hz: float) -> None:
    same, second = beside(f"bandwidth:cutoff_hz={cutoff_hz:.6g},order=1")[1]
    assert (
        np.abs([same.make(size).model_dump()["cutoff_hz"] / cutoff_hz - 1.0 for size in same.sizes]).min() >= SAME_SIZE
    )
    assert len(same.sizes) >= len(second.sizes) - 2


@pytest.mark.parametrize("text", ["latency:delay_ms=6.6", "bandwidth:cutoff_hz=11.3,order=1", "backlash:play_deg=0.31"])
def test_the_size_in_the_rig_is_simulated_and_changes_nothing(text: str) -> None:
    effect, result = beside(text)
    candidate = result[0]
    made = [candidate.make(float(size)).model_dump()[candidate.parameter] for size in candidate.grid_points]
    has = effect.model_dump()[candidate.parameter]
    (own,) = [
        size for size, value in zip(candidate.grid_points, made, strict=True) if abs(value / has - 1.0) < SAME_SIZE
    ]
    assert candidate.make(own).model_dump()[candidate.parameter] == pytest.approx(has, rel=1e-6)
    assert (np.diff(candidate.grid_points) > 0.0).all()
    assert len(candidate.grid_points) in {len(of(effect.name)[0].grid_points) + extra for extra in (0, 1)}


def test_what_is_read_off_as_the_rig_has_it_is_no_candidate() -> None:
    width_dps = HINTS.least_dps
    effect, result = beside(f"deadband:width_dps={width_dps:.9g}")
    assert [item for item in result if item.name == effect.name] == []
    assert beside(f"deadband:width_dps={2.0 * width_dps:.9g}")[1]


def test_others_are_as_they_were_beside_an_effect_in_the_rig() -> None:
    _, result = beside("latency")
    assert len(result) == len(of("latency"))
    rig = Rig(base=BASE, effects=(parse_effect("latency"),))
    names = [item.name for item in candidates(HINTS)]
    assert [item.name for item in candidates(HINTS, rig)] == names
    assert [item.name for item in candidates(HINTS, rig) if item.in_rig is not None] == ["latency"]


def test_a_phase_is_free_unless_the_encoder_is_absolute() -> None:
    free = {item.name for item in candidates(HINTS) if item.is_phase_free}
    assert free == {"g_sensitivity", "encoder_eccentricity"}
    fixed = Rig(base=BASE.model_copy(update={"encoder_absolute": True}))
    assert not any(item.is_phase_free for item in candidates(HINTS, fixed))


@pytest.mark.parametrize("factor", [1e-9, 1e9])
def test_a_hint_beyond_what_the_simulator_takes_is_cut_to_it(factor: float) -> None:
    """Recordings may hold numbers with all their digits, or of another unit."""
    hints = replace(HINTS, rate_step_dps=HINTS.rate_step_dps * factor, angle_step_deg=HINTS.angle_step_deg * factor)
    for name in ("quantization", "encoder_quantization"):
        for candidate in of(name, hints):
            for size in (*candidate.grid_points, candidate.sizes[0], candidate.sizes[-1]):
                assert candidate.make(float(size)).name == name
