"""How much of an effect each recording shows, and whether two sets of recordings show it alike."""

import numpy as np
import pytest

from gyrodrift.diagnose.inference.baseline import CHANCE, amounts_of, amplitudes_of, chance_of, noise_variance_of

FEATURES = 20
SIGMA = np.linspace(0.5, 2.0, FEATURES)


def test_an_amount_does_not_depend_on_the_motion() -> None:
    """Recordings whose motion shows an effect ten times as well as that of others show the same amount of it."""
    rng = np.random.default_rng(3)
    changes = rng.normal(size=(3, FEATURES)) * np.array([1.0, 10.0, 3.0])[:, None]
    assert amounts_of(0.7 * changes, changes, SIGMA) == pytest.approx([0.7, 0.7, 0.7])


def test_a_recording_that_cannot_show_an_effect_says_nothing_of_its_amount() -> None:
    """A gain in a recording that rests, beside one that moves; if all of them rest, there is none of it."""
    changes = np.vstack([np.ones(FEATURES), np.zeros(FEATURES)])
    assert amounts_of(np.ones((2, FEATURES)), changes, SIGMA).tolist() == pytest.approx([1.0])
    assert amounts_of(np.ones((2, FEATURES)), 0.0 * changes, SIGMA).tolist() == pytest.approx([0.0, 0.0])


def test_an_effect_of_chance_is_new_however_it_scatters_where_it_acts() -> None:
    """Three recordings with one, four and two of its amount beside three with none; a device's gain may vary so."""
    today, before = np.array([1.0, 4.0, 2.0]), np.array([0.1, -0.1, 0.0])
    assert chance_of(today, before, 0.01, is_random=True) < CHANCE < chance_of(today, before, 0.01)


def test_an_effect_of_chance_that_the_device_had_is_not_new() -> None:
    rng, sets = np.random.default_rng(13), 4000
    result = [chance_of(rng.normal(5, 2, 3), rng.normal(5, 2, 5), 1e-4, is_random=True) for _ in range(sets)]
    assert np.mean(np.array(result) < CHANCE) < 2.0 * CHANCE


def test_noise_scatters_amounts_by_the_variance_that_is_stated() -> None:
    rng = np.random.default_rng(5)
    changes = np.tile(rng.normal(size=FEATURES), (4000, 1))
    result = amounts_of(SIGMA * rng.normal(size=changes.shape), changes, SIGMA)
    assert float(result.var()) == pytest.approx(noise_variance_of(changes, SIGMA), rel=0.1)


def test_an_amplitude_does_not_depend_on_phases() -> None:
    rng = np.random.default_rng(9)
    at_0, at_90 = rng.normal(size=(2, 6, FEATURES))
    phase = rng.uniform(0.0, 2.0 * np.pi, 6)[:, None]
    shown = 0.4 * (np.cos(phase) * at_0 + np.sin(phase) * at_90)
    assert amplitudes_of(shown, (at_0, at_90), SIGMA) == pytest.approx(np.full(6, 0.4))


def test_what_is_fitted_to_noise_is_fitted_in_both_sets() -> None:
    """Phases make an amplitude of any noise: of two sets of nothing else, one hardly ever shows more."""
    rng, sets = np.random.default_rng(11), 1500
    at_0, at_90 = rng.normal(size=(2, 3, FEATURES))
    variance = noise_variance_of(at_0, SIGMA)
    shown = [amplitudes_of(SIGMA * rng.normal(size=at_0.shape), (at_0, at_90), SIGMA) for _ in range(2 * sets)]
    result = [chance_of(today, before, variance) for today, before in zip(shown[::2], shown[1::2], strict=True)]
    assert np.mean(np.array(result) < 0.02) < 0.04


@pytest.mark.parametrize(("today", "before"), [(3, 3), (2, 3), (6, 4), (3, 1)])
def test_a_device_that_varies_is_held_to_have_changed_no_more_often_than_is_said(today: int, before: int) -> None:
    """Gains that scatter by 2 % from one recording to the next, far more than noise explains."""
    rng, sets = np.random.default_rng(7), 4000
    result = [chance_of(rng.normal(5, 2, today), rng.normal(5, 2, before), 1e-4) for _ in range(sets)]
    for chance in (0.02, 0.1):
        assert np.mean(np.array(result) < chance) == pytest.approx(chance, rel=0.3)


def test_what_all_of_one_set_show_and_none_of_the_other_is_no_chance() -> None:
    """Three recordings each; and the wider they scatter, the sooner it is."""
    today, before = np.array([1.0, 0.9, 1.1]), np.array([0.0, 0.1, -0.1])
    assert chance_of(today, before, 1e-4) < 0.001
    assert chance_of(today + np.array([0.5, 0.0, -0.5]), before, 1e-4) > 0.01
    assert chance_of(today, before, 4.0) > 0.1


def test_a_change_that_scatters_by_a_quarter_of_itself_is_told() -> None:
    """Three recordings beside two that show nothing of it: nine times in ten."""
    rng = np.random.default_rng(13)
    result = np.array([chance_of(rng.normal(1.0, 0.25, 3), rng.normal(0.0, 0.05, 2), 1e-3) for _ in range(1000)])
    assert np.mean(result < CHANCE) > 0.8
