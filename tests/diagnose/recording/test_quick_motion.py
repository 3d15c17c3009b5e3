"""Motion above the noise of a gyro: on a robot that trembles all of it is kept, elsewhere nothing is made up."""

from typing import NamedTuple

import numpy as np
import pytest

from firmware_sim.rig import Base, Rig
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.quick_motion import QuickMotion, quick_motion_of
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.recording.smoothing import gaussian
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats, Mask

PERIOD_S, SAMPLES, NOISE_DPS = 0.01, 12_000, 0.035
GYRO = GyroModel(0.0)
IN_MOTION: Mask = np.arange(SAMPLES) >= SAMPLES // 4


def falling(rng: np.random.Generator, size_dps: float, corner_hz: float = 4.0, power: float = 4.0) -> Floats:
    """A random rate whose power falls beyond a corner, up to eight times half the sample rate."""
    frequency_hz = np.fft.rfftfreq(8 * SAMPLES, PERIOD_S / 8.0)
    shape = np.sqrt(1.0 / (1.0 + (frequency_hz / corner_hz) ** power)) * (frequency_hz > 0.3)
    waves = shape * (rng.standard_normal(len(shape)) + 1j * rng.standard_normal(len(shape)))
    rate_dps: Floats = np.fft.irfft(waves, 8 * SAMPLES)[::8]
    scaled_dps: Floats = size_dps * rate_dps / rate_dps.std()
    return scaled_dps


def power_between(rate_dps: Floats, low_hz: float, high_hz: float) -> float:
    """Mean power of the samples in motion between two frequencies."""
    moving_dps = rate_dps[IN_MOTION]
    frequency_hz = np.fft.rfftfreq(len(moving_dps), PERIOD_S)
    inside = (frequency_hz > low_hz) & (frequency_hz < high_hz)
    return float(np.square(np.abs(np.fft.rfft(moving_dps * np.hanning(len(moving_dps))))[inside]).mean())


def quick_motion(rate_dps: Floats) -> QuickMotion:
    """Spectrum of rates that rest in the first quarter."""
    return quick_motion_of(rate_dps, ~IN_MOTION, IN_MOTION, PERIOD_S, GYRO)


@pytest.mark.parametrize("corner_hz", [4.0, 12.0])
@pytest.mark.parametrize(("low_hz", "high_hz"), [(4.0, 8.0), (8.0, 16.0), (16.0, 25.0)])
def test_a_drawn_path_has_the_power_of_the_motion(corner_hz: float, low_hz: float, high_hz: float) -> None:
    """A path through a Gaussian has lost most of it above 4 Hz."""
    rng = np.random.default_rng(1)
    motion_dps = np.where(IN_MOTION, falling(rng, 1.8, corner_hz), 0.0)
    rate_dps = motion_dps + NOISE_DPS * rng.standard_normal(SAMPLES)
    smooth_dps = gaussian(motion_dps, 5.0)
    quick = quick_motion(rate_dps)
    path, lacking = quick.completed(np.column_stack([np.zeros(SAMPLES), smooth_dps]), rate_dps)
    drawn_dps = (path + quick.drawn(rng, lacking))[:, 1]
    true_power = power_between(motion_dps, low_hz, high_hz)
    assert power_between(smooth_dps, low_hz, high_hz) < 0.6 * true_power
    assert power_between(drawn_dps, low_hz, high_hz) == pytest.approx(true_power, rel=0.1)


@pytest.mark.parametrize("louder", [1.0, 1.5, 4.0])
def test_white_noise_is_no_motion_at_any_level(louder: float) -> None:
    """The path is left alone, and nothing is drawn."""
    noise_dps = NOISE_DPS * np.random.default_rng(2).standard_normal(SAMPLES) * np.where(IN_MOTION, louder, 1.0)
    path = np.zeros((SAMPLES, 2))
    completed, lacking = quick_motion(noise_dps).completed(path, noise_dps)
    assert completed is path
    assert not lacking.any()


def test_a_tone_at_rest_and_in_motion_is_no_motion() -> None:
    """A fan makes one; what a device does at rest, too, moves no robot."""
    tone_dps = 0.2 * np.sin(2.0 * np.pi * 6.0 * PERIOD_S * np.arange(SAMPLES))
    rate_dps = tone_dps + NOISE_DPS * np.random.default_rng(3).standard_normal(SAMPLES)
    assert not quick_motion(rate_dps).motion.any()


@pytest.mark.parametrize("size_dps", [0.0, 0.5, 1.0])
def test_noise_is_known_without_a_rest(size_dps: float) -> None:
    rng = np.random.default_rng(4)
    rate_dps = falling(rng, size_dps, 2.0) + NOISE_DPS * rng.standard_normal(SAMPLES)
    nowhere = np.zeros(SAMPLES, bool)
    quick = quick_motion_of(rate_dps, nowhere, ~nowhere, PERIOD_S, GYRO)
    assert not quick.has_rest_spectrum
    assert quick.white_dps == pytest.approx(NOISE_DPS, rel=0.1)


def test_where_all_of_a_spectrum_may_be_motion_the_noise_is_what_the_rig_states() -> None:
    """A tail that is far above the noise up to half the sample rate hides it."""
    rate_dps = falling(np.random.default_rng(5), 3.0, 1.0, 2.0)
    nowhere = np.zeros(SAMPLES, bool)
    quick = quick_motion_of(rate_dps, nowhere, ~nowhere, PERIOD_S, GyroModel(0.0, stated_noise_dps=NOISE_DPS))
    assert quick.white_dps == pytest.approx(NOISE_DPS, rel=0.01)


def test_calm_stretches_are_told_from_trembling_ones() -> None:
    """A table that shakes for most of its motion is left alone where it turns calmly."""
    rng = np.random.default_rng(6)
    is_calm = np.arange(SAMPLES) >= 9_000
    motion_dps = np.where(is_calm | ~IN_MOTION, 0.0, falling(rng, 1.8))
    quick = quick_motion(motion_dps + NOISE_DPS * rng.standard_normal(SAMPLES))
    assert quick.tremble_probability[is_calm][100:].max() < 0.01
    assert quick.tremble_probability[IN_MOTION & ~is_calm][100:-100].min() > 0.99
    assert not quick.tremble_probability[~IN_MOTION].any()


class Trembling(NamedTuple):
    """A slow swing beneath tones whose amplitudes fall with their frequency."""

    frequency_hz: Floats
    amplitude_dps: Floats
    phase: Floats

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle and rate."""
        omega = 2.0 * np.pi * self.frequency_hz
        turns = np.outer(t_s, omega) + self.phase
        return -np.cos(turns) @ (self.amplitude_dps / omega), np.sin(turns) @ self.amplitude_dps

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature."""
        return np.full(len(t_s), 25.0)

    @property
    def powered_s(self) -> float:
        """At the first sample."""
        return 0.0


def trembling_subject(rng: np.random.Generator, cpr: int) -> Subject:
    """A minute of a robot that never rests, 1.8 deg/s in all, with the rig that made it."""
    frequency_hz = np.geomspace(0.3, 48.0, 150)
    amplitude_dps = np.sqrt(frequency_hz / (1.0 + (frequency_hz / 4.0) ** 4.0))
    amplitude_dps *= 1.8 * np.sqrt(2.0 / np.square(amplitude_dps).sum())
    tones = np.concatenate([[0.05], frequency_hz]), np.concatenate([[20.0], amplitude_dps])
    motion = Trembling(*tones, rng.uniform(0.0, 2.0 * np.pi, len(tones[0])))
    rig = Rig(base=Base(sample_rate_hz=100.0, encoder_cpr=cpr))
    return subject_of(recording_of(Simulation(rig, motion, 3, 0, 1.0).whole()), rig)


@pytest.mark.parametrize("cpr", [4096, 65_536])
def test_a_replay_of_a_trembling_robot_scatters_as_its_recording_does(cpr: int) -> None:
    subject = trembling_subject(np.random.default_rng(7), cpr)
    replayed = subject.replayed((), 0)
    for points in (1, 2, 4):
        powers = []
        for rate_dps in (subject.cleaned.rate_dps, replayed.rate_dps):
            means = rate_dps[: len(rate_dps) // 4 * 4].reshape(-1, points).mean(axis=1)
            powers.append(float(np.square(np.diff(means, 3)).mean()))
        assert powers[1] == pytest.approx(powers[0], rel=0.08)
    assert subject.rig.base.noise_dps_rthz == pytest.approx(Base().noise_dps_rthz, rel=0.25)


def test_a_recording_of_two_samples_a_second_lacks_no_motion() -> None:
    """A window has too few samples for a spectrum; the path stays as it is."""
    rng = np.random.default_rng(1)
    rate_dps = np.where(IN_MOTION, falling(rng, 1.8), 0.0)
    quick = quick_motion_of(rate_dps, ~IN_MOTION, IN_MOTION, 0.5, GYRO)
    smooth = np.column_stack([np.zeros(SAMPLES), rate_dps])
    path, lacking = quick.completed(smooth, rate_dps)
    assert np.array_equal(path, smooth)
    assert not quick.drawn(rng, lacking).any()


def test_a_rate_without_noise_has_a_spectrum() -> None:
    """2000 samples of 10 ms: the least powers give columns of very different sizes."""
    moves = np.ones(2000, dtype=np.bool_)
    quick = quick_motion_of(np.zeros(2000), ~moves, moves, 0.01, GyroModel(0.001, stated_noise_dps=0.01))
    assert not quick.drawn(np.random.default_rng(1), np.zeros(2000)).any()
