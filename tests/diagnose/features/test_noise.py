"""Noise within a second, of signals whose statistics are known."""

from dataclasses import replace

import numpy as np
import pytest
from features_support import AT_REST, PERIOD_S, T_S, TRUE_DPS, Observed, observed, white

from gyrodrift.diagnose.features.noise import root_share
from gyrodrift.diagnose.features.spectral_line import WINDOW, spectral_line, white_dps
from gyrodrift.diagnose.features.spreads import MOVING_LENGTHS, REST_LENGTHS, DifferenceIndices, spreads_of
from gyrodrift.values.arrays import Floats

SIGMA = 0.05


def noisy(noise_dps: Floats) -> Observed:
    """Past the search for outliers: what is measured is what is given."""
    item = observed(TRUE_DPS)
    return Observed(replace(item.cleaned, rate_dps=TRUE_DPS + noise_dps), item.design)


def test_white_noise_is_white_at_rest_and_in_motion() -> None:
    item = noisy(white(SIGMA))
    spreads = spreads_of(item.cleaned.rate_dps, item.design.difference_indices)
    assert np.sqrt(spreads.rest[:4]) == pytest.approx([SIGMA] * 4, rel=0.06)
    assert np.sqrt(spreads.slow + spreads.fast) == pytest.approx([SIGMA] * 4, rel=0.1)
    result = item.values()
    assert max(abs(result[f"noise_rest_{points}"]) for points in REST_LENGTHS) < 0.35
    assert max(abs(result[f"noise_slow_{points}"]) for points in MOVING_LENGTHS) < 0.25


def test_a_scatter_of_which_most_is_nothing_grows_evenly_with_what_there_is() -> None:
    """A rate that leaves zero for one sample in twelve, in six, in three: no step where half of all differences are."""
    rng = np.random.default_rng(3)
    leaves = rng.permutation(len(T_S))
    shares = np.linspace(0.08, 0.36, 15)
    result = []
    for share in shares:
        item = noisy(np.where(leaves < share * len(T_S), 0.5, 0.0))
        result.append(spreads_of(item.cleaned.rate_dps, item.design.difference_indices).rest[0])
    assert result == pytest.approx((shares * (1.0 - shares) * 0.25).tolist(), rel=0.3)


def test_outliers_in_a_short_rest_are_held_back() -> None:
    """Three of sixty samples, and so nine of all second differences, more than the tenth that a long rest may have."""
    rate_dps = white(SIGMA, 7, 60)
    rate_dps[[11, 30, 47]] += 20.0
    none = np.zeros(0, np.int64)
    rests = tuple(np.arange(len(rate_dps) // points - 2) if points < 16 else none for points in REST_LENGTHS)
    places = DifferenceIndices(rests, (none,) * len(MOVING_LENGTHS), (none,) * len(MOVING_LENGTHS), none)
    assert spreads_of(rate_dps, places).rest[0] < 6.0 * SIGMA**2


@pytest.mark.parametrize("number", range(3))
def test_correlated_noise_has_the_spread_of_its_kernel(number: int) -> None:
    """Means of two neighbours: the squares of the weights that a second difference gives to each draw, in all."""
    points = REST_LENGTHS[number]
    draws = white(SIGMA, 4, len(T_S) + 1)
    item = noisy(0.5 * (draws[1:] + draws[:-1]))
    mean = np.ones(points) / points
    second = np.zeros(2 * points + 1)
    second[[0, points, 2 * points]] = 1.0, -2.0, 1.0
    weights = np.convolve(np.convolve(mean, second), [0.5, 0.5])
    expected = SIGMA**2 * float(weights @ weights) * points / 6.0
    assert spreads_of(item.cleaned.rate_dps, item.design.difference_indices).rest[number] == pytest.approx(
        expected, rel=0.2
    )


def test_a_ramp_is_no_noise() -> None:
    item = noisy(0.3 * T_S)
    spreads = spreads_of(item.cleaned.rate_dps, item.design.difference_indices)
    assert max(*spreads.rest, *spreads.slow, *spreads.fast) < 1e-12


@pytest.mark.parametrize("sigma", [0.01, 0.05, 0.3])
def test_the_level_of_white_noise_is_known(sigma: float) -> None:
    line_dps = 10.0 * sigma * np.sin(2.0 * np.pi * 21.0 * T_S)
    assert white_dps(*noisy(white(sigma, 2) + line_dps), 1e-3) == pytest.approx(sigma, rel=0.06)


def test_noise_below_a_count_is_known_from_motion() -> None:
    noise = np.where(AT_REST, 0.0, white(SIGMA))
    assert white_dps(*noisy(noise), 0.2) == pytest.approx(SIGMA, rel=0.1)


def test_a_line_is_found_with_frequency_and_amplitude() -> None:
    frequency_hz = 51.0 / (WINDOW * PERIOD_S)
    line = spectral_line(*noisy(white(SIGMA) + 0.2 * np.sin(2.0 * np.pi * frequency_hz * T_S)))
    assert line.frequency_hz == pytest.approx(frequency_hz, rel=1e-6)
    assert line.amplitude_dps == pytest.approx(0.2, rel=0.03)
    # Power of the line over that of the noise in a Hann window: (A / 2 · Σw)² over σ² Σw², by its median ln 2.
    hann = np.hanning(WINDOW)
    ratio = (0.1 * hann.sum()) ** 2 / (SIGMA**2 * float(hann @ hann) * np.log(2.0))
    assert line.log_height == pytest.approx(np.log(ratio + 1.0), abs=0.25)


def test_without_noise_there_is_no_line() -> None:
    assert spectral_line(*noisy(np.zeros(len(T_S)))).log_height == pytest.approx(np.log(2.0), abs=0.8)


def test_bursts_raise_the_noisiest_tenth() -> None:
    bursts = np.where((T_S % 5.0) < 1.0, 3.0, 1.0)
    assert noisy(bursts * white(SIGMA)).values()["noise_uneven"] == pytest.approx(np.log(9.0), abs=0.25)
    assert noisy(white(SIGMA)).values()["noise_uneven"] < 0.5


def test_large_outliers_have_more_power_than_small_ones() -> None:
    """Eight of 30 deg/s in 20,000 are 0.6 deg/s RMS; as many of 1 deg/s do not matter."""
    result = []
    for height_dps in (30.0, 1.0):
        rate_dps = TRUE_DPS + white(SIGMA)
        rate_dps[1000:9000:1000] += height_dps
        result.append(observed(rate_dps).values()["spike_power"])
    assert np.exp(0.5 * result[0]) == pytest.approx(30.0 * np.sqrt(8.0 / 20_000.0), rel=0.01)
    assert result[1] - 2.0 * np.log(0.05) < 0.2


@pytest.mark.parametrize(("count", "of", "root"), [(0, 100, 0.0), (4, 100, 0.2), (0, 0, 0.0)])
def test_a_share_of_nothing_is_none(count: int, of: int, root: float) -> None:
    assert root_share(count, of) == root
