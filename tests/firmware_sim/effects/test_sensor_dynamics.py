"""Effects that depend on frequency: delay, low-pass and tones, by gain and phase at tones of the table."""

import numpy as np
import pytest
from effects_bench import REST, SHIPPED, effect_of, profile_of, put_in, record, rig_of, sized, tone

from firmware_sim.effects.effect import Effect, Floats, Moments
from firmware_sim.effects.sensor_dynamics import Bandwidth, Latency, Vibration
from firmware_sim.rig import Base


def response(effect: Effect | None, frequency_hz: float) -> complex:
    """Gain and phase of the gyro at a frequency of the table, with the shipped noise: 2e-5 of it for one second."""
    sine = {"kind": "sine", "seconds": 50.0, "amplitude_dps": 60.0, "frequency_hz": frequency_hz}
    run = record(rig_of(effect), profile_of(sine), 42.0)
    late = run.t_s >= 2.0
    return tone(run.rate_dps[late], run.t_s[late], frequency_hz) / tone(run.true_dps[late], run.t_s[late], frequency_hz)


def density(rate_dps: Floats, sample_rate_hz: float, low_hz: float, high_hz: float) -> float:
    """Two-sided noise density between two frequencies, deg/s/√Hz: mean of periodograms of one second each."""
    seconds = rate_dps.reshape(-1, round(sample_rate_hz))
    power = np.abs(np.fft.rfft(seconds - seconds.mean())) ** 2 / sample_rate_hz**2
    return float(np.sqrt(power[:, round(low_hz) : round(high_hz) + 1].mean()))


def strongest_line(rate_dps: Floats) -> tuple[float, float]:
    """Frequency in Hz and amplitude of the strongest tone in 100 s at 100 Hz."""
    heights = 2.0 * np.abs(np.fft.rfft(rate_dps - rate_dps.mean())) / rate_dps.size
    position = int(heights.argmax())
    return position / 100.0, float(heights[position])


@sized("bandwidth")
@pytest.mark.parametrize("part", [0.25, 1.0])
def test_gain_and_phase_are_those_of_one_pole(effect: Effect | None, part: float) -> None:
    frequency_hz = part * (put_in(effect, "cutoff_hz") or 40.0)
    inverse = 1.0 / response(effect, frequency_hz)
    assert inverse.real == pytest.approx(1.0, abs=0.005)
    assert inverse.imag == pytest.approx(part if effect else 0.0, abs=0.005)


@pytest.mark.parametrize("cutoff_hz", [10.0, 40.0])
@pytest.mark.parametrize("part", [0.25, 1.0])
def test_gain_and_phase_of_the_second_order_are_those_of_butterworth(cutoff_hz: float, part: float) -> None:
    inverse = 1.0 / response(Bandwidth(cutoff_hz=cutoff_hz, order=2), part * cutoff_hz)
    assert inverse.real == pytest.approx(1.0 - part**2, abs=0.005)
    assert inverse.imag == pytest.approx(np.sqrt(2.0) * part, abs=0.007)


@pytest.mark.parametrize("order", [1, 2])
def test_slow_changes_come_late_by_what_a_low_pass_says(order: int) -> None:
    """The phase at a fortieth of the cut-off, to a hundredth."""
    effect = Bandwidth(cutoff_hz=40.0, order=order)
    late_s = -np.angle(response(effect, 1.0)) / (2.0 * np.pi)
    assert late_s == pytest.approx(effect.delay_s(), rel=0.01)


def test_the_second_order_takes_more_of_the_noise() -> None:
    effect, base = Bandwidth(cutoff_hz=40.0, order=2), Base(sample_rate_hz=1000.0, dps_per_lsb=1e-4)
    rate_dps = record(rig_of(effect, base=base), profile_of(*REST), 120.0).rate_dps
    remaining = density(rate_dps, 1000.0, 112.0, 128.0) / base.noise_dps_rthz
    assert remaining == pytest.approx(np.sqrt(1.0 / 82.0), rel=0.08)
    assert effect.power_passed(np.array([120.0]))[0] == pytest.approx(1.0 / 82.0)


@sized("bandwidth")
def test_the_noise_falls_with_the_gain(effect: Effect | None) -> None:
    """Far below the cut-off it has its density, at three times the cut-off its tenth part in power."""
    cutoff_hz = put_in(effect, "cutoff_hz") or 40.0
    base = Base(sample_rate_hz=1000.0, dps_per_lsb=1e-4)
    rate_dps = record(rig_of(effect, base=base), profile_of(*REST), 120.0).rate_dps
    low = density(rate_dps, 1000.0, 1.0, max(2.0, cutoff_hz / 10.0))
    high = density(rate_dps, 1000.0, 2.8 * cutoff_hz, 3.2 * cutoff_hz)
    assert low == pytest.approx(base.noise_dps_rthz, rel=0.12)
    assert high == pytest.approx(base.noise_dps_rthz * np.sqrt(0.1 if effect else 1.0), rel=0.08)


@pytest.mark.parametrize("order", [1, 2])
def test_a_low_pass_starts_where_the_table_is(order: int) -> None:
    turning, t_s = np.full(50, 30.0), np.arange(50, dtype=np.float64) * 1e-3
    passed = Bandwidth(cutoff_hz=10.0, order=order).begin(np.random.default_rng(0), 100.0)
    moments = Moments(t_s, t_s, 30.0 * t_s, turning, turning, 1e-3)
    assert passed(turning, moments) == pytest.approx(turning)


def test_a_low_pass_starts_no_noisier_than_it_goes_on() -> None:
    """The first samples of 40 sessions scatter no more than the later ones: the noise before power-on was filtered."""
    rig = rig_of(Bandwidth(cutoff_hz=1.0), base=SHIPPED.model_copy(update={"dps_per_lsb": 1e-4}))
    runs = np.array([record(rig, profile_of(*REST), 20.0, seed).rate_dps for seed in range(40)])
    assert runs[:, 0].std() < 2.0 * runs[:, 1000:].std()


@sized("latency")
@pytest.mark.parametrize("frequency_hz", [1.0, 4.0, 9.0])
def test_the_phase_falls_with_frequency_and_the_gain_stays(effect: Effect | None, frequency_hz: float) -> None:
    """The delay is the same at every frequency, to a hundredth of a millisecond, and nothing gets smaller."""
    answer = response(effect, frequency_hz)
    delay_ms = -np.angle(answer) / (2.0 * np.pi * frequency_hz) * 1e3
    assert delay_ms == pytest.approx(put_in(effect, "delay_ms"), abs=0.01)
    assert abs(answer) == pytest.approx(1.0, abs=1e-4)


def test_a_delay_may_be_any_part_of_a_sample() -> None:
    answer = response(Latency(delay_ms=2.5), 4.0)
    assert -np.angle(answer) / (2.0 * np.pi * 4.0) == pytest.approx(2.5e-3, abs=1e-5)


def test_delays_add_up() -> None:
    """A low-pass behind a delay has the phase of both."""
    sine = {"kind": "sine", "seconds": 50.0, "amplitude_dps": 60.0, "frequency_hz": 2.0}
    run = record(rig_of(Bandwidth(cutoff_hz=10.0), Latency(delay_ms=20.0)), profile_of(sine), 42.0)
    answer = tone(run.rate_dps[200:], run.t_s[200:], 2.0) / 60.0
    assert answer == pytest.approx(np.exp(-1j * 2.0 * np.pi * 2.0 * 0.02) / (1.0 + 0.2j), abs=0.002)


@sized("vibration")
def test_the_strongest_line_is_the_tone_where_sampling_puts_it(effect: Effect | None) -> None:
    """A tone above half the sample rate stands at its alias; without one no line is over 0.004 deg/s of noise."""
    frequency_hz, amplitude_dps = strongest_line(record(rig_of(effect), profile_of(*REST), 100.0).rate_dps)
    if effect is None:
        assert amplitude_dps < 0.004
        return
    put_in_hz = put_in(effect, "frequency_hz")
    assert frequency_hz == pytest.approx(abs(put_in_hz - 100.0 * round(put_in_hz / 100.0)), abs=0.005)
    assert amplitude_dps == pytest.approx(put_in(effect, "amplitude_dps"), abs=0.003)


@pytest.mark.parametrize(("frequency_hz", "seen_hz"), [(20.0, 20.0), (73.0, 27.0), (310.0, 10.0), (1530.0, 30.0)])
@pytest.mark.parametrize("cutoff_hz", [5.0, 40.0])
def test_a_low_pass_weakens_a_tone_before_it_is_sampled(frequency_hz: float, seen_hz: float, cutoff_hz: float) -> None:
    """A tone loses what one pole takes at its true frequency, not at the one it is seen at; to 2 %."""
    tone_dps = Vibration(amplitude_dps=100.0, frequency_hz=frequency_hz)
    rig = rig_of(tone_dps, Bandwidth(cutoff_hz=cutoff_hz))
    found_hz, amplitude_dps = strongest_line(record(rig, profile_of(*REST), 100.0).rate_dps)
    assert found_hz == pytest.approx(seen_hz, abs=0.005)
    assert amplitude_dps == pytest.approx(100.0 / np.hypot(1.0, frequency_hz / cutoff_hz), rel=0.02)


def test_each_session_starts_with_another_phase_of_the_vibration() -> None:
    rig = rig_of(effect_of("vibration"))
    phases = {
        round(np.angle(tone((run := record(rig, profile_of(*REST), 10.0, seed)).rate_dps, run.t_s, 27.0)), 1)
        for seed in range(5)
    }
    assert len(phases) > 1
