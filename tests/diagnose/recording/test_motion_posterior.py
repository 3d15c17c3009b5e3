"""The motion behind a recording: near the true one for any encoder, still at rest, and not bent by a gyro's errors."""

from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np
import pytest
from scipy.ndimage import minimum_filter1d

from firmware_sim.motion.profile import Profile, load_profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.recording.counted_rests import CountedRests
from gyrodrift.diagnose.recording.gyro_noise import GyroModel
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.diagnose.recording.motion_posterior import MotionPosterior, motion_posterior_of
from gyrodrift.diagnose.recording.outliers import Cleaned, clean
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

ANYWHERE = CountedRests((), np.empty(0), np.empty(0))
SECONDS = 50.0
ENCODERS = [(512, 50.0), (1024, 200.0), (4096, 100.0), (36_000, 50.0), (36_000, 400.0)]
STARTS_DEG = np.linspace(0.0, 0.7, 15)
PIECES = [("identify", 60.0), ("turntable", 100.0), ("drive", 400.0)]


class Course(Protocol):
    """Angle and rate, and temperature, at any time."""

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle and rate."""

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature."""


class Piece(NamedTuple):
    """Samples of a motion from a moment on."""

    profile: Course
    first_s: float
    powered_s: float = 0.0

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle and rate."""
        return self.profile.motion_at(t_s + self.first_s)

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature."""
        return self.profile.sensor_c_at(t_s + self.first_s)


class Begun(NamedTuple):
    """A motion that begins at another angle."""

    course: Course
    first_deg: float

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle and rate."""
        angle_deg, rate_dps = self.course.motion_at(t_s)
        return angle_deg + self.first_deg, rate_dps

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature."""
        return self.course.sensor_c_at(t_s)


class Observed(NamedTuple):
    """A recording of a known motion, (n,) angle and rate."""

    recording: Recording
    angle_deg: Floats
    rate_dps: Floats

    def posterior(self, delay_s: float = 0.0) -> MotionPosterior:
        return motion_posterior_of(self.cleaned, GyroModel(Base().dps_per_lsb, delay_s))

    @property
    def cleaned(self) -> Cleaned:
        return clean(self.recording)

    def off_deg(self, motion: ReplayedMotion) -> float:
        """Root mean square of the error of the angle."""
        return float(np.sqrt(np.square(motion.angle_deg - self.angle_deg).mean()))


def observed(
    motion: Piece, cpr: int, rate_hz: float, *effects: str, seconds: float = SECONDS, **gyro: float
) -> Observed:
    base = Base(sample_rate_hz=rate_hz, encoder_cpr=cpr).model_copy(update=gyro)
    rig = Rig(base=base, effects=tuple(map(parse_effect, effects)))
    recording = recording_of(Simulation(rig, motion, 3, 0, seconds / 60.0).whole(), round(seconds * rate_hz))
    return Observed(recording, *motion.motion_at(np.arange(len(recording.rate_dps)) / rate_hz))


def piece(name: str, first_s: float) -> Piece:
    return Piece(load_profile(name), first_s)


def creeping(dps: float) -> Piece:
    """Rest for 10 s, 20 s at a rate, rest for 10 s."""
    ramps = [(0.5, dps), (20.0, dps), (0.5, 0.0)]
    rest = {"kind": "rest", "seconds": 10.0}
    segments = [rest, *({"kind": "ramp", "seconds": seconds, "to_dps": to} for seconds, to in ramps), rest]
    return Piece(Profile.model_validate({"about": "Of a test.", "segments": segments}), 0.0)


@pytest.mark.parametrize(("cpr", "rate_hz"), ENCODERS)
@pytest.mark.parametrize(("name", "first_s"), PIECES)
def test_the_angle_is_known_to_a_quarter_of_a_count(name: str, first_s: float, cpr: int, rate_hz: float) -> None:
    """Root mean square, and everywhere to half a count; draws are off it by about what it is off.

    A sixth where counts fall anywhere; a table that turns by half counts from sample to sample hides a quarter.
    """
    item = observed(piece(name, first_s), cpr, rate_hz)
    posterior = item.posterior()
    count_deg = 360.0 / cpr
    assert item.off_deg(posterior.mean) < 0.26 * count_deg
    assert np.abs(posterior.mean.angle_deg - item.angle_deg).max() < 0.5 * count_deg
    drawn = posterior.draw(np.random.default_rng(1), ANYWHERE)
    away_deg = float(np.sqrt(np.square(drawn.angle_deg - posterior.mean.angle_deg).mean()))
    assert 0.1 * item.off_deg(posterior.mean) < away_deg < 6.0 * item.off_deg(posterior.mean)


@pytest.mark.parametrize(("cpr", "rate_hz"), ENCODERS)
def test_at_rest_nothing_moves(cpr: int, rate_hz: float) -> None:
    item = observed(piece("turntable", 100.0), cpr, rate_hz)
    posterior = item.posterior()
    drawn = posterior.draw(np.random.default_rng(2), ANYWHERE)
    rest_s = np.count_nonzero(item.rate_dps == 0.0) / rate_hz
    for motion in (posterior.mean, drawn):
        still = motion.rate_dps == 0.0
        assert not item.rate_dps[still].any()
        assert np.count_nonzero(still) / rate_hz > rest_s - 2.0 * len(posterior.rests)
        assert not np.diff(motion.angle_deg)[still[1:] & still[:-1]].any()
    assert posterior.rests


@pytest.mark.parametrize("dps", [0.1, -0.2, 0.3])
@pytest.mark.parametrize(("cpr", "rate_hz"), ENCODERS)
def test_creeping_is_no_rest(cpr: int, rate_hz: float, dps: float) -> None:
    item = observed(creeping(dps), cpr, rate_hz, seconds=41.0)
    still = item.posterior().mean.rate_dps == 0.0
    assert not still[np.abs(item.rate_dps) > 0.5 * abs(dps)].any()
    assert still[item.rate_dps == 0.0].mean() > 0.85


@pytest.mark.parametrize("bias_dps", [-0.055, 0.0, 0.05])
@pytest.mark.parametrize(("cpr", "rate_hz"), [(512, 200.0), (4096, 100.0)])
def test_rests_are_found_through_coarse_steps(cpr: int, rate_hz: float, bias_dps: float) -> None:
    """The level between two steps is none of these."""
    step = "quantization:step_dps=0.1525"
    item = observed(creeping(2.0), cpr, rate_hz, step, seconds=41.0, bias_dps=bias_dps, noise_dps_rthz=0.008)
    still = motion_posterior_of(item.cleaned, GyroModel(0.1525)).mean.rate_dps == 0.0
    assert not still[np.abs(item.rate_dps) > 0.2].any()
    assert still[item.rate_dps == 0.0].mean() > 0.85


@pytest.mark.parametrize(("cpr", "rate_hz"), [(512, 50.0), (1024, 100.0)])
def test_a_wild_sample_ends_no_rest(cpr: int, rate_hz: float) -> None:
    """Counts too coarse for it do not show it; it is one among its neighbours."""
    item = observed(creeping(2.0), cpr, rate_hz, "spikes:height_dps=10,share_percent=1", seconds=41.0)
    assert len(item.cleaned.spikes_dps) > 0.004 * len(item.rate_dps)
    still = item.posterior().mean.rate_dps == 0.0
    assert not still[np.abs(item.rate_dps) > 0.2].any()
    assert still[item.rate_dps == 0.0].mean() > 0.85


@pytest.mark.parametrize("seconds", [60.0, 60.2, 75.0])
def test_a_long_rest_ends_where_it_ends(seconds: float) -> None:
    segments = [{"kind": "rest", "seconds": seconds}, {"kind": "ramp", "seconds": 5.0, "to_dps": 30.0}]
    motion = Piece(Profile.model_validate({"about": "Of a test.", "segments": segments}), 0.0)
    item = observed(motion, 512, 50.0, seconds=seconds + 4.5)
    ((first, end),) = item.posterior().rests
    assert first == 0
    assert seconds - 2.0 < end / 50.0 < seconds


@pytest.mark.parametrize("cpr", [512, 1024, 2048])
def test_a_motion_that_begins_gently_is_not_held_back(cpr: int) -> None:
    segments = [{"kind": "rest", "seconds": 10.0}, {"kind": "ramp", "seconds": 20.0, "to_dps": 2.0}]
    slow = Piece(Profile.model_validate({"about": "Of a test.", "segments": segments}), 0.0)
    for first_deg in STARTS_DEG:
        item = observed(Piece(Begun(slow, first_deg), 0.0), cpr, 100.0, seconds=30.0, noise_dps_rthz=0.012)
        away_deg = (item.posterior().mean.angle_deg - item.angle_deg)[:900]
        assert np.abs(away_deg).max() < 0.25 * 360.0 / cpr


@pytest.mark.parametrize(("cpr", "rate_hz"), ENCODERS)
@pytest.mark.parametrize(("name", "first_s"), PIECES)
def test_a_gain_error_does_not_bend_the_motion(name: str, first_s: float, cpr: int, rate_hz: float) -> None:
    item = observed(piece(name, first_s), cpr, rate_hz, "scale_factor:error_percent=2")
    assert item.off_deg(item.posterior().mean) < 0.26 * 360.0 / cpr


@pytest.mark.parametrize(("cpr", "rate_hz"), ENCODERS)
def test_a_delay_that_is_not_known_bends_it_by_little(cpr: int, rate_hz: float) -> None:
    item = observed(piece("turntable", 100.0), cpr, rate_hz, "latency:delay_ms=20")
    assert item.off_deg(item.posterior().mean) < 0.05 + 0.2 * 360.0 / cpr
    # One that the rig says is taken out.
    assert item.off_deg(item.posterior(0.02).mean) < 0.16 * 360.0 / cpr


@pytest.mark.parametrize(("cpr", "rate_hz"), ENCODERS)
def test_a_gyro_at_its_limit_does_not_bend_the_motion(cpr: int, rate_hz: float) -> None:
    item = observed(piece("turntable", 100.0), cpr, rate_hz, "saturation:limit_dps=60")
    assert np.abs(item.rate_dps).max() > 80.0
    assert item.off_deg(item.posterior().mean) < 0.25 * 360.0 / cpr


class Shaken(NamedTuple):
    """A device that is never still but at the beginning: three tones of a robot that balances."""

    still_s: float = 5.0

    def motion_at(self, t_s: Floats) -> tuple[Floats, Floats]:
        """Angle and rate."""
        moving_s = np.maximum(t_s - self.still_s, 0.0)
        angle_deg, rate_dps = np.zeros(len(t_s)), np.zeros(len(t_s))
        for hz, dps in ((0.7, 30.0), (1.9, 25.0), (3.1, 20.0)):
            turning = 2.0 * np.pi * hz
            angle_deg += dps / turning * (1.0 - np.cos(turning * moving_s))
            rate_dps += dps * np.sin(turning * moving_s)
        return angle_deg, rate_dps

    def sensor_c_at(self, t_s: Floats) -> Floats:
        """Temperature."""
        return np.full(len(t_s), 25.0)


def test_a_motion_that_never_ends_is_no_noise_of_the_gyro() -> None:
    """The rate is followed to a two hundredth of what it does."""
    item = observed(Piece(Shaken(), 0.0), 2048, 50.0)
    off_dps = item.posterior().mean.rate_dps - item.rate_dps
    assert np.sqrt(np.square(off_dps).mean()) < 0.005 * item.rate_dps.std()


@pytest.mark.parametrize("rate_hz", [50.0, 100.0, 200.0])
def test_between_quick_steps_the_noise_of_the_gyro_is_no_motion(rate_hz: float) -> None:
    """Held rates change from sample to sample by less than half of what a gyro says, in the mean and in draws."""
    steps = {"kind": "steps", "rates_dps": [110.0, -24.0, 48.0, -193.0, 5.5], "ramp_seconds": 0.3, "hold_seconds": 2.6}
    segments = [{"kind": "rest", "seconds": 10.0}, *[steps] * 3]
    profile = Profile.model_validate({"about": "Of a test.", "segments": segments})
    item = observed(Piece(profile, 0.0), 36_000, rate_hz)
    posterior = item.posterior()
    kept = (np.diff(item.rate_dps) == 0.0) & (np.abs(item.rate_dps[1:]) > 1.0)
    inner = minimum_filter1d(kept, round(0.6 * rate_hz) | 1)
    assert np.count_nonzero(inner) > 10.0 * rate_hz
    gyro_dps = np.diff(item.recording.rate_dps)[inner].std()
    for motion in (posterior.mean, posterior.draw(np.random.default_rng(3), ANYWHERE)):
        assert np.diff(motion.rate_dps)[inner].std() < 0.5 * gyro_dps


def test_samples_that_never_came_are_passed_over() -> None:
    whole = observed(piece("turntable", 100.0), 4096, 100.0)
    dice = np.random.default_rng(4)
    lost = dice.random(len(whole.rate_dps)) < 0.1
    lost[3000:3050] = True
    lost[[0, -1]] = False
    rate_dps, encoder_deg = (
        np.where(lost, np.nan, values) for values in (whole.recording.rate_dps, whole.recording.encoder_deg)
    )
    item = whole._replace(recording=replace(whole.recording, rate_dps=rate_dps, encoder_deg=encoder_deg))
    motion = item.posterior().mean
    assert np.isfinite(motion.angle_deg).all()
    assert item.off_deg(motion) < 0.16 * 360.0 / 4096
    assert np.abs(motion.angle_deg - item.angle_deg)[lost].max() < 0.5 * 360.0 / 4096


@pytest.mark.parametrize(("name", "first_s"), PIECES)
def test_a_reference_without_steps_is_averaged(name: str, first_s: float) -> None:
    """Angles that scatter by 0.05 degrees, as an optical reference has them: a third of that is left."""
    whole = observed(piece(name, first_s), 36_000, 100.0)
    noisy_deg = whole.angle_deg + np.random.default_rng(5).normal(0.0, 0.05, len(whole.angle_deg))
    item = whole._replace(recording=replace(whole.recording, encoder_deg=noisy_deg))
    posterior = item.posterior()
    assert item.off_deg(posterior.mean) < 0.05 / 3.0
    assert float(np.std(posterior.mean.rate_dps - item.rate_dps)) < 0.1


def test_a_draw_is_another_path_each_time_and_the_same_again() -> None:
    posterior = observed(piece("drive", 100.0), 1024, 100.0).posterior()
    first, again, second = (posterior.draw(np.random.default_rng(seed), ANYWHERE).angle_deg for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert np.std(first - second) > 0.0


def test_many_draws_are_about_the_mean() -> None:
    spreads = []
    for cpr in (512, 4096):
        posterior = observed(piece("drive", 100.0), cpr, 50.0).posterior()
        away = np.array([posterior.draw(np.random.default_rng(n), ANYWHERE).angle_deg for n in range(40)])
        away -= posterior.mean.angle_deg
        spreads.append(float(np.std(away)))
        assert float(np.std(away.mean(axis=0))) == pytest.approx(spreads[-1] / np.sqrt(40.0), rel=0.25)
    assert spreads[0] > 1.2 * spreads[1]
