"""A simulation has the scatter of a reference, too."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.recording.recording import Recording, recording_of
from gyrodrift.diagnose.recording.reference_noise import ReferenceNoise
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

RATE_HZ, MINUTES = 100.0, 1.5
RIG = Rig(base=Base(sample_rate_hz=RATE_HZ, encoder_cpr=36_000))


def coloured_deg(samples: int, seed: int) -> Floats:
    """Noise of 0.2 deg, as quick as cameras are."""
    noise = gaussian_filter1d(np.random.default_rng(seed).standard_normal(samples), 5.0)
    return np.asarray(0.2 * noise / noise.std())


def recorded(*effects: str, noise_seed: int | None = None) -> Recording:
    rig = RIG.model_copy(update={"effects": tuple(map(parse_effect, effects))})
    session = Simulation(rig, load_profile("identify"), 3, 0, MINUTES).whole()
    assert session.encoder_deg is not None
    if noise_seed is not None:
        session = replace(session, encoder_deg=session.encoder_deg + coloured_deg(len(session.rate_dps), noise_seed))
    return recording_of(session)


def off_dps(subject: Subject) -> float:
    observed = subject.cleaned
    away_deg = observed.encoder_deg - np.cumsum(observed.rate_dps) * observed.recording.period_s
    return float(np.std(away_deg[20:] - away_deg[:-20]) / (20 * observed.recording.period_s))


@pytest.mark.parametrize(
    "effects",
    [
        (),
        ("backlash:play_deg=0.3",),
        ("backlash:play_deg=2",),
        ("encoder_slip",),
        ("encoder_eccentricity:amplitude_deg=0.5",),
        ("latency:delay_ms=60",),
        ("timestamp_jitter:sigma_ms=3",),
        ("scale_factor:error_percent=5",),
        ("vibration",),
    ],
    ids=lambda effects: "".join(effects) or "none",
)
def test_counts_of_an_encoder_are_no_noise(effects: tuple[str, ...]) -> None:
    """Nor is what an encoder does wrong now and then."""
    assert subject_of(recorded(*effects), RIG).reference is None


@pytest.mark.parametrize("effect", ["encoder_eccentricity:amplitude_deg=0.3", "backlash:play_deg=0.3"])
def test_what_the_rig_says_that_the_encoder_errs_by_is_no_noise(effect: str) -> None:
    rig = RIG.model_copy(update={"effects": (parse_effect(effect),)})
    assert subject_of(recorded(effect), rig).reference is None


def test_a_simulation_is_as_noisy_as_the_reference() -> None:
    subject = subject_of(recorded(noise_seed=1), RIG)
    assert subject.reference is not None
    first, second = (subject_of(subject.played((), seed), RIG) for seed in (1, 2))
    for item in (first, second):
        assert off_dps(item) == pytest.approx(off_dps(subject), rel=0.3)
    apart = first.cleaned.encoder_deg - second.cleaned.encoder_deg
    assert np.std(np.diff(apart)) > 0.5 * np.std(np.diff(subject.reference.deviation_deg))
    again = subject.played((), 1)
    assert np.array_equal(again.encoder_deg, first.cleaned.recording.encoder_deg, equal_nan=True)


def test_noise_that_is_drawn_is_as_large_at_every_moment_and_has_forgotten_its_sign() -> None:
    seen_deg = np.linspace(0.0, 1.0, 2000)
    noise = ReferenceNoise(seen_deg, 1.0 / RATE_HZ)
    drawn = np.array([noise.drawn(np.random.default_rng(seed)) for seed in range(400)])
    assert np.abs(drawn.mean(axis=0)).max() < 0.2
    assert np.sqrt(np.square(drawn).mean(axis=0))[100:-100] == pytest.approx(seen_deg[100:-100], rel=0.25)
