"""Tones and low-passes in the spectrum of a rest."""

import numpy as np
import pytest

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect, with_effects
from gyrodrift.facts.spectrum import spectrum_of
from gyrodrift.values.arrays import Floats


def test_a_tone_is_found_with_its_frequency_and_amplitude() -> None:
    rng = np.random.default_rng(1)
    noise = 0.035 * rng.standard_normal(3000)
    tone = 0.02 * np.sin(2.0 * np.pi * 27.0 * np.arange(3000) / 100.0)
    observed = spectrum_of(noise + tone, 100.0)
    assert observed is not None
    assert observed.tone_hz == pytest.approx(27.0, abs=0.1)
    assert observed.tone_dps == pytest.approx(0.02, rel=0.2)
    assert observed.upper_share == pytest.approx(1.0, abs=0.3)
    assert all(
        item is not None and item.tone_hz is None for item in (spectrum_of(_white(rng), 100.0) for _ in range(200))
    )
    assert spectrum_of(noise[:500], 100.0) is None


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("effect", ["bias_instability", "bias_instability:floor_dph=72", "popcorn", "rate_random_walk"])
def test_noise_that_rises_to_low_frequencies_is_no_tone(effect: str) -> None:
    """`doctor` does not report flicker noise as a tone."""
    rates = [(simulated_rest(effect, seed, samples)) for seed in range(5) for samples in (3000, 12000)]
    spectra = [spectrum_of(rate_dps, 100.0) for rate_dps in rates]
    assert [spectrum.tone_hz for spectrum in spectra if spectrum is not None] == [None] * 10


def test_a_tone_in_flicker_noise_is_found() -> None:
    tone = 0.03 * np.sin(2.0 * np.pi * 11.0 * np.arange(3000) / 100.0)
    spectrum = spectrum_of(simulated_rest("bias_instability:floor_dph=72", 1, 3000) + tone, 100.0)
    assert spectrum is not None
    assert spectrum.tone_hz == pytest.approx(11.0, abs=0.1)
    assert spectrum.tone_dps == pytest.approx(0.03, rel=0.2)


def simulated_rest(effect: str, seed: int, samples: int) -> Floats:
    """Rates of the shipped rig at rest with one more effect, deg/s, shape (samples,)."""
    rig = with_effects(load_rig(None), [parse_effect(effect)])
    blocks: list[Floats] = []
    for block in measure(rig, load_profile("rest"), seed):
        blocks.append(np.asarray(block.rate_raw * rig.base.dps_per_lsb, dtype=np.float64))
        if sum(map(len, blocks)) >= samples:
            break
    return np.concatenate(blocks)[:samples]


def _white(rng: np.random.Generator) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    return np.asarray(rng.standard_normal(3000))


def test_a_low_pass_shows_at_half_the_sample_rate() -> None:
    """A mean of four samples, as some firmware sends it."""
    means = np.convolve(np.random.default_rng(2).standard_normal(3003), np.full(4, 0.25), "valid")
    observed = spectrum_of(means, 100.0)
    assert observed is not None
    assert observed.upper_share < 0.5
