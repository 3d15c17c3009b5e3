"""Records of candidates: what is tried of each effect, in which sizes."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import HINTS, candidate_of

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.diagnose.simulate.candidate import Candidate, Hints
from gyrodrift.diagnose.simulate.candidates import KINDS, candidates, register
from gyrodrift.diagnose.simulate.grids import between, linear_grid, read_grid, simulated_grid


def of(name: str, hints: Hints = HINTS) -> list[Candidate]:
    return [one for one in candidates(hints) if one.name == name]


def test_every_effect_has_a_record() -> None:
    """With a sentence on what it means, in the middle of another one."""
    assert set(KINDS) == set(CATALOGUE)
    for kind in KINDS.values():
        assert kind.meaning[0].islower()
        assert not kind.meaning.endswith(".")


@pytest.mark.parametrize("name", KINDS)
def test_every_size_is_one_that_the_simulator_takes(name: str) -> None:
    """From the first to the last, simulated or not, the effect carries that size and the fixed parameters."""
    for candidate in of(name):
        for size in (*candidate.grid_points, candidate.sizes[0], candidate.sizes[-1]):
            effect = candidate.make(float(size))
            assert effect.name == name
            assert hasattr(effect, candidate.parameter)


def test_variants_of_an_effect_are_told_apart() -> None:
    """No two candidates have both name and variant in common."""
    keys = [(one.name, one.variant) for one in candidates(HINTS)]
    assert len(set(keys)) == len(keys)


def test_groups_hold_effects_that_look_alike_and_say_how_to_part_them() -> None:
    """Latency and bandwidth both lag; a scale factor is alone but for its name."""
    assert KINDS["latency"].looks_like == KINDS["bandwidth"].looks_like
    assert KINDS["latency"].looks_like.name == "lag"
    assert KINDS["saturation"].looks_like.name == "saturation"
    assert all(kind.looks_like.separated_by for kind in KINDS.values())


def test_hints_become_second_parameters_and_sizes() -> None:
    """The tone's frequency, the height of outliers, and steps that are read off."""
    hints = replace(HINTS, line_hz=33.0, spike_dps=7.0, rate_step_dps=0.125, angle_step_deg=1.0)
    assert of("vibration", hints)[0].make(1.0).model_dump()["frequency_hz"] == 33.0
    assert of("spikes", hints)[0].make(1.0).model_dump()["height_dps"] == 7.0
    assert [one.sizes.tolist() for one in of("quantization", hints)] == [[0.125]] * 7
    assert of("encoder_quantization", hints)[0].make(1.0).model_dump()["cpr"] == 360


def test_a_low_pass_has_its_time_constant_as_its_size() -> None:
    """1 / (2π·10 Hz) is a cut-off of 10 Hz, so that size 0 is none."""
    effect = candidate_of("bandwidth").make(1.0 / (20.0 * np.pi))
    assert effect.model_dump()["cutoff_hz"] == pytest.approx(10.0)


def test_what_comes_once_per_turn_is_tried_in_twelve_phases() -> None:
    """All the way round."""
    assert [one.phase_deg for one in of("g_sensitivity")] == [30.0 * step for step in range(12)]


def test_sizes_stand_in_even_ratios() -> None:
    """Twelve to a decade, with both ends."""
    sizes = between(0.01, 10.0)
    assert len(sizes) == 37
    assert sizes[[0, 12, 24, 36]] == pytest.approx([0.01, 0.1, 1.0, 10.0])
    assert np.ptp(np.diff(np.log(sizes))) < 1e-12


def test_a_linear_grid_has_both_signs_and_two_points_within() -> None:
    """A tenth of the largest size either way."""
    grid = linear_grid(0.01, 10.0)
    assert grid.points.tolist() == [-1.0, 1.0]
    assert np.array_equal(grid.sizes, -grid.sizes[::-1])
    assert (grid.sizes[0], grid.sizes[-1]) == (-10.0, 10.0)


def test_a_simulated_grid_decides_between_its_first_and_last_point() -> None:
    """And a size that was read off is the only one."""
    grid = simulated_grid(0.3, 2.0, 8.0)
    assert grid.points.tolist() == [0.3, 2.0, 8.0]
    assert (grid.sizes[0], grid.sizes[-1]) == pytest.approx((0.3, 8.0))
    assert read_grid(0.5).points.tolist() == read_grid(0.5).sizes.tolist() == [0.5]


def test_a_record_that_cannot_be_is_refused() -> None:
    """Of no effect, of no parameter, or a second one."""
    known = KINDS["latency"]
    with pytest.raises(ValueError, match="no such effect"):
        register(replace(known, name="gremlins"))
    with pytest.raises(ValueError, match="candidate already"):
        register(known)
