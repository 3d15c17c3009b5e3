"""The whole bench: the same measurements from the same seed, however they are cut into blocks."""

from itertools import chain, islice

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim import encoder
from firmware_sim.bench import AMBIENT_C, measure
from firmware_sim.motion import Profile, load_profile
from firmware_sim.rig import Base, Rig

NOISY = Rig(base=Base(noise_dps_rthz=0.02, bias_dps=0.3))
IDEAL = Rig(base=Base(noise_dps_rthz=0.0, bias_dps=0.0))

Row = tuple[int, int, int, bool, int, int]


@pytest.fixture(scope="module")
def turntable() -> Profile:
    return load_profile("turntable")


def first_rows(count: int, rig: Rig, profile: Profile, seed: int = 0, block_samples: int = 4096) -> list[Row]:
    blocks = measure(rig, profile, seed, block_samples)
    return list(islice(chain.from_iterable(block.rows() for block in blocks), count))


def test_the_same_seed_gives_the_same_bytes(turntable: Profile) -> None:
    """Two runs of one rig, profile and seed agree in every bit of every array."""
    one, other = (list(islice(measure(NOISY, turntable, 7), 2)) for _ in range(2))
    for left, right in zip(one, other, strict=True):
        for name in left.__slots__:
            assert getattr(left, name).tobytes() == getattr(right, name).tobytes()


@given(st.integers(0, 2**63), st.integers(0, 2**63))
def test_a_different_seed_gives_different_rates(turntable: Profile, seed: int, other: int) -> None:
    """Runs with unequal seeds differ, and runs with equal seeds do not."""
    left, right = (first_rows(50, NOISY, turntable, number, 50) for number in (seed, other))
    assert (left == right) == (seed == other)


@given(st.integers(1, 300))
def test_the_size_of_the_blocks_makes_no_difference(turntable: Profile, block_samples: int) -> None:
    """Blocks of one sample and of any other size hold the same measurements."""
    assert first_rows(300, NOISY, turntable, 1, block_samples) == first_rows(300, NOISY, turntable, 1)


def test_only_the_rate_is_random(turntable: Profile) -> None:
    """Counter, clock, temperature and encoder do not depend on the seed."""
    left, right = (first_rows(1000, NOISY, turntable, seed) for seed in (1, 2))
    assert [row[:2] + row[3:] for row in left] == [row[:2] + row[3:] for row in right]


@pytest.mark.parametrize("rate_hz", [1.0, 33.3, 100.0, 1000.0, 65535.0])
def test_counter_and_clock_go_together(turntable: Profile, rate_hz: float) -> None:
    """Sample n has number n and the time n over the sample rate, to the microsecond."""
    rows = first_rows(500, Rig(base=Base(sample_rate_hz=rate_hz)), turntable, block_samples=37)
    assert [row[0] for row in rows] == list(range(500))
    assert all(abs(row[1] - row[0] * 1e6 / rate_hz) <= 0.5001 for row in rows)


def test_the_clock_does_not_wrap_here(turntable: Profile) -> None:
    """Wrapping is the wire's: the numbers of a long run go on beyond 16 and 32 bits."""
    slow = Rig(base=Base(sample_rate_hz=1.0))
    block = next(islice(measure(slow, turntable, 0, 70_000), 0, 1))
    assert (int(block.seq[-1]), int(block.t_device_us[-1])) == (69_999, 69_999_000_000)


def test_an_ideal_rig_measures_the_motion(turntable: Profile) -> None:
    """Without bias and noise, rate and encoder are the profile's in whole counts."""
    block = next(measure(IDEAL, turntable, 0, 8000))
    angle_deg, rate_dps = turntable.at(block.seq / 100.0)
    np.testing.assert_allclose(block.rate_raw * 0.00763, rate_dps, atol=0.00763 / 2 + 1e-9)
    assert block.encoder_counts.tolist() == encoder.counts(angle_deg, 36000).tolist()
    assert not block.is_clipped.any()


def test_a_rate_beyond_the_range_is_marked(turntable: Profile) -> None:
    """A gyro too fine for the profile clips in the fast turns, and only there."""
    fine = Rig(base=Base(dps_per_lsb=0.00305, noise_dps_rthz=0.0))
    block = next(measure(fine, turntable, 0, 8000))
    _, rate_dps = turntable.at(block.seq / 100.0)
    assert block.is_clipped.tolist() == (np.abs(rate_dps) > 32767.5 * 0.00305).tolist()
    assert block.is_clipped.any()


def test_a_rig_without_encoder_measures_no_angle(turntable: Profile) -> None:
    """Its counts are zeros all the way."""
    rows = first_rows(2000, Rig(base=Base(encoder_cpr=0)), turntable)
    assert {row[5] for row in rows} == {0}


def test_the_temperature_is_that_of_the_room(turntable: Profile) -> None:
    """It is given in hundredths of a degree."""
    assert {row[4] for row in first_rows(100, NOISY, turntable)} == {round(AMBIENT_C * 100)}


def test_rows_are_plain_numbers(turntable: Profile) -> None:
    """What goes to struct and to text is Python's own, in the order of the arrays."""
    row = first_rows(1, IDEAL, turntable)[0]
    assert [type(value) for value in row] == [int, int, int, bool, int, int]
