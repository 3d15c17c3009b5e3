"""The gyro: bias, noise, counts and range."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.gyro import COUNTS_MOST, Gyro
from firmware_sim.motion import Floats
from firmware_sim.rig import Base

STILL = np.zeros(100_000)


def gyro(base: Base, seed: int = 0) -> Gyro:
    return Gyro(base, np.random.default_rng(seed))


def base(rate_hz: float = 100.0, lsb_dps: float = 0.5, noise: float = 0.0, bias_dps: float = 0.0) -> Base:
    return Base(sample_rate_hz=rate_hz, dps_per_lsb=lsb_dps, noise_dps_rthz=noise, bias_dps=bias_dps)


@pytest.mark.parametrize("bias_dps", [-2.0, 0.0, 0.35])
def test_the_mean_at_rest_is_the_bias(bias_dps: float) -> None:
    """Standing still, a noisy gyro gives its bias, to within five times the error of the mean."""
    counts, _ = gyro(base(lsb_dps=1e-3, noise=0.005, bias_dps=bias_dps)).measure(STILL)
    error_dps = 0.005 * np.sqrt(50.0) / np.sqrt(STILL.size)
    assert abs(float(counts.mean()) * 1e-3 - bias_dps) < 5.0 * error_dps


@pytest.mark.parametrize("rate_hz", [10.0, 100.0, 1000.0])
@pytest.mark.parametrize("noise_dps_rthz", [0.005, 0.02])
def test_the_noise_has_the_density_of_the_rig(rate_hz: float, noise_dps_rthz: float) -> None:
    """A sample scatters by density times the root of half the sample rate; five standard errors are 1.1 %."""
    counts, _ = gyro(base(rate_hz, 1e-4, noise_dps_rthz)).measure(STILL)
    assert float(counts.std()) * 1e-4 == pytest.approx(noise_dps_rthz * np.sqrt(rate_hz / 2.0), rel=0.011)


def test_the_noise_is_white() -> None:
    """A sample knows nothing of the one before it."""
    counts, _ = gyro(base(lsb_dps=1e-4, noise=0.005)).measure(STILL)
    assert abs(np.corrcoef(counts[:-1], counts[1:])[0, 1]) < 5.0 / np.sqrt(STILL.size)


@given(st.floats(-16000.0, 16000.0), st.floats(-50.0, 50.0))
def test_without_noise_a_rate_becomes_the_nearest_count(rate_dps: float, bias_dps: float) -> None:
    """The count times the step is within half a step of rate plus bias."""
    counts, is_clipped = gyro(base(bias_dps=bias_dps)).measure(np.array([rate_dps]))
    assert abs(counts[0] * 0.5 - (rate_dps + bias_dps)) <= 0.25 * (1.0 + 1e-9)
    assert not is_clipped[0]


@given(st.lists(st.integers(-COUNTS_MOST, COUNTS_MOST), max_size=50))
def test_without_noise_whole_counts_come_back_exactly(counts: list[int]) -> None:
    """A rate that is a whole number of steps is measured as just that number."""
    measured, _ = gyro(base()).measure(np.array(counts, dtype=np.float64) * 0.5)
    assert measured.tolist() == counts


def test_a_slowly_rising_rate_climbs_in_steps_of_one_count() -> None:
    """The output of a fine ramp is a staircase of even steps."""
    counts, _ = gyro(base(lsb_dps=0.1)).measure(np.linspace(0.0, 1.0, 1001))
    steps, lengths = np.unique(counts, return_counts=True)
    assert steps.tolist() == list(range(11))
    assert set(lengths[1:-1].tolist()) <= {99, 100, 101}


@pytest.mark.parametrize(
    ("rate_dps", "count", "clipped"),
    [
        (COUNTS_MOST * 0.5, COUNTS_MOST, False),
        (-COUNTS_MOST * 0.5, -COUNTS_MOST, False),
        ((COUNTS_MOST + 1) * 0.5, COUNTS_MOST, True),
        (-(COUNTS_MOST + 1) * 0.5, -COUNTS_MOST, True),
        (1e6, COUNTS_MOST, True),
        (-1e6, -COUNTS_MOST, True),
    ],
)
def test_a_rate_out_of_range_is_clipped_and_says_so(rate_dps: float, count: int, clipped: bool) -> None:  # noqa: FBT001 - a row of the table
    """Both ends of the range are a true value; beyond them the end is given with a flag."""
    counts, is_clipped = gyro(base()).measure(np.array([rate_dps]))
    assert (counts.tolist(), is_clipped.tolist()) == ([count], [clipped])


def test_counts_are_16_bit_and_flags_are_truth_values() -> None:
    """The arrays have the types of the wire and the shape of the input."""
    counts, is_clipped = gyro(base()).measure(np.zeros(7))
    assert (str(counts.dtype), str(is_clipped.dtype)) == ("int16", "bool")
    assert counts.shape == is_clipped.shape == (7,)


@given(st.lists(st.integers(0, 200), max_size=8), st.integers(0, 2**32))
def test_blocks_of_any_size_give_the_same_counts(cuts: list[int], seed: int) -> None:
    """However the rates are cut, every sample has the count it has when measured in one go."""
    noisy = base(lsb_dps=1e-3, noise=0.01)
    rates_dps: Floats = np.linspace(-30.0, 30.0, 200)
    whole, clipped = gyro(noisy, seed).measure(rates_dps)
    in_parts = gyro(noisy, seed)
    parts = [in_parts.measure(part) for part in np.split(rates_dps, sorted(cuts))]
    assert np.concatenate([counts for counts, _ in parts]).tolist() == whole.tolist()
    assert np.concatenate([flags for _, flags in parts]).tolist() == clipped.tolist()
