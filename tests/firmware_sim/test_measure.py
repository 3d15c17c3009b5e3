"""The whole bench: bias, noise, counts, range, encoder; the same from the same seed however it is cut into blocks."""

from itertools import chain, islice

import numpy as np
import pytest
from effects_bench import REST, Record, once_per_turn, profile_of, put_in, record, rig_of
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.measure import COUNTS_MAX, HALF_A_COUNT, measure
from firmware_sim.motion.profile import Profile, load_profile
from firmware_sim.rig import ENCODER_CPR_MAX, Base, Rig, parse_effect

NOISY = Rig(base=Base(noise_dps_rthz=0.02, bias_dps=0.3))
IDEAL = Rig(base=Base(noise_dps_rthz=0.0))
SAMPLES = 100_000

Row = tuple[int, int, float, int, bool, int, int, int]


@pytest.fixture(scope="module")
def turntable() -> Profile:
    return load_profile("turntable")


def first_rows(count: int, rig: Rig, profile: Profile, seed: int = 0, block_samples: int = 4096) -> list[Row]:
    blocks = measure(rig, profile, seed, block_samples=block_samples)
    return list(islice(chain.from_iterable(block.rows() for block in blocks), count))


def at_rest(base: Base) -> Record:
    """A hundred thousand samples of a table that stands still."""
    return record(rig_of(base=base), profile_of(*REST), SAMPLES / base.sample_rate_hz)


def spinning(to_dps: float) -> Profile:
    """From rest to a rate at constant acceleration within a second."""
    return profile_of({"kind": "ramp", "seconds": 1.0, "to_dps": to_dps})


def test_the_same_seed_gives_the_same_bytes(turntable: Profile) -> None:
    """Two runs of one rig, profile and seed agree in every bit of every array."""
    item, second = (list(islice(measure(NOISY, turntable, 7), 2)) for _ in range(2))
    for remaining, right in zip(item, second, strict=True):
        for name in remaining.__slots__:
            assert getattr(remaining, name).tobytes() == getattr(right, name).tobytes()


@given(st.integers(0, 2**63), st.integers(0, 2**63))
def test_a_different_seed_gives_different_rates(turntable: Profile, seed: int, peer: int) -> None:
    """Runs with unequal seeds differ, and runs with equal seeds do not."""
    remaining, right = (first_rows(50, NOISY, turntable, number, 50) for number in (seed, peer))
    assert (remaining == right) == (seed == peer)


def test_every_session_of_a_seed_has_its_own_noise(turntable: Profile) -> None:
    """The number of the session is part of the seed."""
    item, second = (next(measure(NOISY, turntable, 0, session)).rate_raw for session in (0, 1))
    assert item.tolist() != second.tolist()


@given(st.integers(1, 300))
def test_the_size_of_the_blocks_makes_no_difference(turntable: Profile, block_samples: int) -> None:
    """Blocks of one sample and of any other size hold the same measurements."""
    assert first_rows(300, NOISY, turntable, 1, block_samples) == first_rows(300, NOISY, turntable, 1)


def test_only_the_rate_is_random(turntable: Profile) -> None:
    """Counter, clock, arrival, temperature and encoder do not depend on the seed."""
    remaining, right = (first_rows(1000, NOISY, turntable, seed) for seed in (1, 2))
    assert [row[:3] + row[4:] for row in remaining] == [row[:3] + row[4:] for row in right]


@pytest.mark.parametrize("rate_hz", [1.0, 33.3, 100.0, 1000.0, 65535.0])
def test_counter_clock_and_arrival_go_together(turntable: Profile, rate_hz: float) -> None:
    """Sample n has number n and the time n over the sample rate; the host has it after its delay."""
    rows = first_rows(500, Rig(base=Base(sample_rate_hz=rate_hz, host_delay_s=0.5)), turntable, block_samples=37)
    assert [row[0] for row in rows] == list(range(500))
    assert all(abs(row[1] - row[0] * 1e6 / rate_hz) <= 0.5001 for row in rows)
    assert [row[2] for row in rows] == pytest.approx([n / rate_hz + 0.5 for n in range(500)])


def test_the_clock_does_not_wrap_here(turntable: Profile) -> None:
    """Wrapping is the wire's: the numbers of a long run go on beyond 16 and 32 bits."""
    slow = Rig(base=Base(sample_rate_hz=1.0))
    block = next(measure(slow, turntable, 0, block_samples=70_000))
    assert (int(block.seq[-1]), int(block.t_device_us[-1])) == (69_999, 69_999_000_000)


def test_an_ideal_rig_measures_the_motion(turntable: Profile) -> None:
    ideal = record(IDEAL, turntable, 80.0)
    assert np.abs(ideal.error_dps).max() <= 0.00763 / 2.0 + 1e-9
    assert np.abs(ideal.encoder_error_deg).max() <= 0.005 + 1e-9


@pytest.mark.parametrize("bias_dps", [-2.0, 0.0, 0.35])
def test_the_mean_at_rest_is_the_bias(bias_dps: float) -> None:
    """Standing still, a noisy gyro gives its bias, to within five times the error of the mean."""
    still = at_rest(Base(dps_per_lsb=1e-3, bias_dps=bias_dps))
    assert abs(float(still.rate_dps.mean()) - bias_dps) < 5.0 * 0.005 * np.sqrt(100.0 / SAMPLES)


@pytest.mark.parametrize("rate_hz", [10.0, 100.0, 1000.0])
@pytest.mark.parametrize("noise_dps_rthz", [0.005, 0.02])
def test_the_noise_has_the_density_of_the_rig(rate_hz: float, noise_dps_rthz: float) -> None:
    """A sample scatters by density times the root of the sample rate; five standard errors are 1.1 %."""
    still = at_rest(Base(sample_rate_hz=rate_hz, dps_per_lsb=1e-4, noise_dps_rthz=noise_dps_rthz))
    assert float(still.rate_dps.std()) == pytest.approx(noise_dps_rthz * np.sqrt(rate_hz), rel=0.011)


def test_the_noise_is_white() -> None:
    """A sample knows nothing of the one before it."""
    rate_dps = at_rest(Base(dps_per_lsb=1e-4)).rate_dps
    assert abs(np.corrcoef(rate_dps[:-1], rate_dps[1:])[0, 1]) < 5.0 / np.sqrt(SAMPLES)


@given(st.floats(-4000.0, 4000.0), st.floats(-50.0, 50.0))
def test_without_noise_a_rate_becomes_the_nearest_count(to_dps: float, bias_dps: float) -> None:
    """The count times the step is within half a step of rate plus bias."""
    base = Base(dps_per_lsb=0.5, noise_dps_rthz=0.0, bias_dps=bias_dps)
    climb = record(rig_of(base=base), spinning(to_dps), 1.0)
    assert (np.abs(climb.error_dps - bias_dps) <= 0.25 * (1.0 + 1e-9)).all()


def test_a_slowly_rising_rate_climbs_in_steps_of_one_count() -> None:
    """The output of a fine ramp is a staircase of even steps."""
    base = Base(sample_rate_hz=1000.0, dps_per_lsb=0.1, noise_dps_rthz=0.0)
    steps, lengths = np.unique(np.rint(record(rig_of(base=base), spinning(1.0), 1.0).rate_dps * 10), return_counts=True)
    assert steps.tolist() == list(range(11))
    assert set(lengths[1:-1].tolist()) <= {99, 100, 101}


@pytest.mark.parametrize("sign", [1, -1])
def test_a_rate_out_of_range_is_clipped_and_says_so(sign: int) -> None:
    base = Base(sample_rate_hz=1.0, dps_per_lsb=1e-3, noise_dps_rthz=0.0)
    steps = [COUNTS_MAX - 1, COUNTS_MAX, COUNTS_MAX + 1, 10 * COUNTS_MAX]
    motion = {"kind": "steps", "rates_dps": [sign * count * 1e-3 for count in steps]}
    profile = profile_of(motion | {"ramp_seconds": 1.0, "hold_seconds": 1.0})
    block = next(measure(rig_of(base=base), profile, 0, block_samples=8))
    assert block.rate_raw[1::2].tolist() == [sign * min(count, COUNTS_MAX) for count in steps]
    assert block.is_clipped[1::2].tolist() == [False, False, True, True]


@given(st.floats(-4000.0, 4000.0), st.integers(1, ENCODER_CPR_MAX))
def test_a_count_of_the_encoder_is_never_more_than_half_a_count_off(to_dps: float, cpr: int) -> None:
    """Counts times 360 over the counts of a turn is the angle, to the resolution of the encoder."""
    turn = record(rig_of(base=Base(encoder_cpr=cpr)), spinning(to_dps), 10.0)
    assert np.abs(turn.encoder_error_deg).max() <= HALF_A_COUNT * 360.0 / cpr + 1e-9


def test_every_count_of_the_encoder_is_as_wide_as_the_others() -> None:
    there_and_back = {"kind": "steps", "rates_dps": [-10.0, 10.0, 10.0], "ramp_seconds": 0.1, "hold_seconds": 60.0}
    turn = record(rig_of(base=Base(encoder_cpr=360)), profile_of(there_and_back), 180.0)
    forward = turn.encoder_deg[(turn.t_s > 60.2) & (turn.t_s < 180.0)]
    _, widths = np.unique(forward, return_counts=True)
    assert set(widths[1:-1].tolist()) <= {9, 10, 11}


def test_a_rig_without_encoder_measures_no_angle(turntable: Profile) -> None:
    assert {row[6] for row in first_rows(2000, Rig(base=Base(encoder_cpr=0)), turntable)} == {0}


@pytest.mark.parametrize("powered_s", [0.0, 240.0, 1e5])
def test_the_sensor_warms_itself_after_power_on(powered_s: float) -> None:
    ambient = [{"at_s": 0.0, "temp_c": 20.0}]
    temp_c = record(IDEAL, profile_of(*REST, powered_s=powered_s, ambient=ambient), 1.0).temp_c
    assert temp_c[0] == pytest.approx(28.0 - 8.0 * np.exp(-powered_s / 240.0), abs=0.005)


def test_the_sensor_follows_the_air() -> None:
    """A warm sensor in air that gets 10 °C warmer gets 10 °C warmer, in hundredths of a degree."""
    ambient = [{"at_s": 0.0, "temp_c": -10.0}, {"at_s": 50.0, "temp_c": 0.0}]
    warm = record(IDEAL, profile_of(*REST, powered_s=1e5, ambient=ambient), 100.0)
    assert warm.temp_c[[0, 2500, 5000, 9999]].tolist() == [-2.0, 3.0, 8.0, 8.0]


def test_a_scheduler_delays_each_sample_by_itself() -> None:
    """The delays are exponential: mean and standard deviation are the jitter, e⁻² of them more than twice that."""
    base = Base(host_delay_s=0.5, host_jitter_s=0.0004)
    late_s = at_rest(base).t_host_s - np.arange(SAMPLES) / 100.0 - 0.5
    assert late_s.min() >= -1e-9
    assert late_s.mean() == pytest.approx(0.0004, rel=0.02)
    assert late_s.std() == pytest.approx(0.0004, rel=0.03)
    assert np.mean(late_s > 0.0008) == pytest.approx(np.exp(-2.0), abs=5.0 * np.sqrt(0.117 / SAMPLES))
    assert abs(np.corrcoef(late_s[:-1], late_s[1:])[0, 1]) < 5.0 / np.sqrt(SAMPLES)


def test_no_sample_overtakes_the_one_before_it(turntable: Profile) -> None:
    rig = Rig(base=Base(host_jitter_s=0.1))
    rows = first_rows(2000, rig, turntable, 3, 37)
    arrivals_s = np.array([row[2] for row in rows])
    assert (np.diff(arrivals_s) >= 0.0).all()
    assert np.mean(np.diff(arrivals_s) == 0.0) > 0.5
    assert rows == first_rows(2000, rig, turntable, 3)


def test_jitter_touches_arrivals_alone(turntable: Profile) -> None:
    jittery = NOISY.model_copy(update={"base": NOISY.base.model_copy(update={"host_jitter_s": 0.001})})
    usual, delayed = (first_rows(500, rig, turntable, 1) for rig in (NOISY, jittery))
    assert [row[:2] + row[3:] for row in usual] == [row[:2] + row[3:] for row in delayed]
    item, second = (next(measure(jittery, turntable, 1, session)).t_host_s for session in (0, 1))
    assert not np.allclose(item, second, rtol=0.0, atol=1e-4)


@pytest.mark.parametrize(("phase_deg", "first"), [(0.0, 0), (90.0, 1024), (-123.4, -1404), (0.05, 1)])
def test_counts_begin_at_the_phase(turntable: Profile, phase_deg: float, first: int) -> None:
    """Rounded to a count of 4096, and the angle goes on from there."""
    rig = Rig(base=Base(encoder_cpr=4096, encoder_phase_deg=phase_deg))
    run = record(rig, turntable, 60.0)
    assert round(run.encoder_deg[0] * 4096 / 360.0) == first
    assert np.abs(run.encoder_error_deg - phase_deg).max() <= 180.0 / 4096 + 1e-9


@pytest.mark.parametrize("phase_deg", [0.0, 75.0, -200.0])
def test_what_happens_once_per_turn_sees_the_phase(phase_deg: float) -> None:
    """Gravity and the encoder's disc: their sines begin where the motion does."""
    base = Base(noise_dps_rthz=0.0, encoder_phase_deg=phase_deg)
    effects = parse_effect("g_sensitivity:amplitude_dps=0.5"), parse_effect("encoder_eccentricity:amplitude_deg=0.7")
    spin = record(rig_of(*effects, base=base), spinning(30.0), 120.0)
    gravity = once_per_turn(spin.error_dps, spin.angle_deg)
    disc = once_per_turn(spin.encoder_error_deg, spin.angle_deg)
    for result, amplitude, effect in zip((gravity, disc), (0.5, 0.7), effects, strict=True):
        own_deg = put_in(effect, "phase_deg")
        assert abs(result - amplitude * np.exp(1j * np.deg2rad(phase_deg + own_deg))) < 0.01


def test_whether_the_encoder_is_absolute_changes_no_measurement(turntable: Profile) -> None:
    rig = Rig(base=Base(encoder_absolute=True, encoder_phase_deg=12.0))
    second = Rig(base=Base(encoder_phase_deg=12.0))
    assert first_rows(300, rig, turntable) == first_rows(300, second, turntable)


def test_rows_are_plain_numbers(turntable: Profile) -> None:
    row = first_rows(1, IDEAL, turntable)[0]
    assert [type(value) for value in row] == [int, int, float, int, bool, int, int, int]
