"""Base values of a session found through a rig with effects: those that it was simulated with."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import BASE, MOTION, session_of

from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.calibration import is_hidden_at_rest
from gyrodrift.diagnose.simulate.recalibration import recalibrated_with
from gyrodrift.diagnose.simulate.twin import subject_of
from gyrodrift.simulation.sessions import Simulation

NOISE_DPS_RTHZ, BIAS_DPS = 0.008, -0.4


def calibrated(*effects: str, rate_hz: float = 100.0, noise: float = NOISE_DPS_RTHZ) -> Base:
    stands = tuple(map(parse_effect, effects))
    own = {"sample_rate_hz": rate_hz, "noise_dps_rthz": noise, "bias_dps": BIAS_DPS}
    truth = Rig(base=BASE.model_copy(update=own), effects=stands)
    session = Simulation(truth, MOTION, seed=1, minutes=MOTION.seconds / 60.0).whole()
    stated = {"sample_rate_hz": 1.02 * rate_hz, "noise_dps_rthz": 0.0035, "bias_dps": 0.35}
    return subject_of(recording_of(session), Rig(base=BASE.model_copy(update=stated), effects=stands)).rig.base


@pytest.mark.parametrize(
    "effects",
    [
        (),
        ("bandwidth:cutoff_hz=15",),
        ("bandwidth:cutoff_hz=40",),
        ("quantization:step_dps=0.061",),
        ("vibration_rectification",),
        ("vibration",),
        ("warmup",),
        ("scale_factor",),
        ("latency:delay_ms=20", "bandwidth:cutoff_hz=30"),
    ],
    ids=str,
)
def test_noise_and_bias_are_found_through_the_effects_of_the_rig(effects: tuple[str, ...]) -> None:
    """The noise of two minutes is known to some 3 %, and so is that of the simulation; the bias to 0.01 deg/s."""
    base = calibrated(*effects)
    assert base.noise_dps_rthz == pytest.approx(NOISE_DPS_RTHZ, rel=0.1)
    assert base.bias_dps == pytest.approx(BIAS_DPS, abs=0.012)
    assert base.sample_rate_hz == pytest.approx(100.0, rel=1e-4)


@pytest.mark.parametrize("effect", ["temp_bias:slope_dps_per_c=0.05", "g_sensitivity:amplitude_dps=0.1", "warmup"])
@pytest.mark.parametrize("noise", [NOISE_DPS_RTHZ, 0.001], ids=["noisy", "stepped"])
def test_beside_what_is_held_to_act_the_bias_is_what_is_left(effect: str, noise: float) -> None:
    own = {"noise_dps_rthz": noise, "bias_dps": BIAS_DPS, "dps_per_lsb": 0.061}
    truth = Rig(base=BASE.model_copy(update=own), effects=(parse_effect(effect),))
    session = Simulation(truth, MOTION, seed=1, minutes=MOTION.seconds / 60.0).whole()
    subject = subject_of(recording_of(session), Rig(base=truth.base, effects=()))
    assert subject.with_remaining_bias(truth.effects).rig.base.bias_dps == pytest.approx(BIAS_DPS, abs=0.03)
    assert subject.with_remaining_bias(()).rig.base == subject.rig.base


@pytest.mark.parametrize(("rate_hz", "noise"), [(50.0, 0.02), (200.0, 0.002), (400.0, 0.0035)])
def test_noise_is_a_density_whatever_the_rate(rate_hz: float, noise: float) -> None:
    base = calibrated(rate_hz=rate_hz, noise=noise)
    assert base.noise_dps_rthz == pytest.approx(noise, rel=0.08)
    assert base.sample_rate_hz == pytest.approx(rate_hz, rel=1e-4)


def test_a_low_pass_that_the_rig_does_not_know_folds_noise_down() -> None:
    result = subject_of(recording_of(session_of(parse_effect("bandwidth:cutoff_hz=40"))), Rig(base=BASE)).rig.base
    assert result.noise_dps_rthz == pytest.approx(BASE.noise_dps_rthz * np.sqrt(1.39), rel=0.08)


def test_a_session_begins_where_its_encoder_says() -> None:
    """A phase in the rig's file is that of another power-on."""
    base = BASE.model_copy(update={"encoder_phase_deg": 77.0})
    subject = subject_of(recording_of(session_of()), Rig(base=base))
    assert subject.rig.base.encoder_phase_deg == 0.0
    assert np.abs(subject.posterior.mean.angle_deg[:100]).max() < 0.02


def test_a_gyro_that_has_lost_its_noise_keeps_what_it_is_known_to_have() -> None:
    """A stream of zeros shows none, and that is a difference from the device as it was."""
    session = session_of()
    silent = recording_of(replace(session, rate_dps=np.zeros(len(session.rate_dps))))
    assert subject_of(silent, Rig(base=BASE)).rig.base.noise_dps_rthz < 0.1 * NOISE_DPS_RTHZ
    assert subject_of(silent, Rig(base=BASE), NOISE_DPS_RTHZ).rig.base.noise_dps_rthz == NOISE_DPS_RTHZ
    noisier = subject_of(recording_of(session), Rig(base=BASE), 0.5 * BASE.noise_dps_rthz).rig.base
    assert noisier.noise_dps_rthz == pytest.approx(BASE.noise_dps_rthz, rel=0.1)


@pytest.mark.parametrize(("noise", "bias_dps"), [(0.01, 0.05), (0.008, 0.15), (0.01, 0.25), (0.005, -0.15)])
def test_beside_a_dead_band_noise_and_bias_are_found_anew(noise: float, bias_dps: float) -> None:
    band = parse_effect("deadband:width_dps=0.2")
    own = {"noise_dps_rthz": noise, "bias_dps": bias_dps}
    truth = Rig(base=BASE.model_copy(update=own), effects=(band,))
    recording = recording_of(Simulation(truth, MOTION, seed=4, minutes=MOTION.seconds / 60.0).whole())
    without = subject_of(recording, Rig(base=BASE))
    assert without.rig.base.noise_dps_rthz != pytest.approx(noise, rel=0.25)
    for base in (
        without.recalibrated((band,)).rig.base,
        subject_of(recording, Rig(base=BASE, effects=(band,))).rig.base,
    ):
        assert base.noise_dps_rthz == pytest.approx(noise, rel=0.15)
        assert base.bias_dps == pytest.approx(bias_dps, abs=0.01)


@pytest.mark.parametrize("seed", range(4))
def test_noise_that_a_wide_dead_band_hides_at_rest_is_found_in_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    noise, cpr = float(np.exp(rng.uniform(np.log(0.002), np.log(0.01)))), int(rng.choice([512, 2048, 36_000]))
    band = parse_effect(f"deadband:width_dps={rng.uniform(0.4, 0.7):.3f}")
    base = BASE.model_copy(update={"noise_dps_rthz": noise, "bias_dps": 0.0, "encoder_cpr": cpr})
    session = Simulation(Rig(base=base, effects=(band,)), MOTION, seed, minutes=MOTION.seconds / 60.0).whole()
    result = subject_of(recording_of(session), Rig(base=base, effects=(band,)))
    assert result.posterior.sigma_dps == pytest.approx(noise * BASE.sample_rate_hz**0.5, rel=0.2)
    assert result.rig.base.noise_dps_rthz == pytest.approx(noise, rel=0.2)


@pytest.mark.parametrize("seed", range(6))
def test_noise_behind_coarse_steps_is_found_in_motion(seed: int) -> None:
    """Wherever the bias is between two of them, and whether they are tried or stand in the rig.

    To half of the variance that rounding adds: what is steady stands in one place between two steps, as at rest.
    """
    rng = np.random.default_rng(seed)
    noise, bias_dps = float(np.exp(rng.uniform(np.log(0.002), np.log(0.008)))), float(rng.uniform(-0.5, 0.5))
    step_dps = float(rng.uniform(0.15, 0.3))
    steps = parse_effect(f"quantization:step_dps={step_dps}")
    base = BASE.model_copy(update={"noise_dps_rthz": noise, "bias_dps": bias_dps})
    session = Simulation(Rig(base=base, effects=(steps,)), MOTION, seed, minutes=MOTION.seconds / 60.0).whole()
    recording = recording_of(session)
    tried = recalibrated_with(subject_of(recording, Rig(base=base)), (steps,)).rig.base
    for result in (tried, subject_of(recording, Rig(base=base, effects=(steps,))).rig.base):
        off = (result.noise_dps_rthz**2 - noise**2) * result.sample_rate_hz
        assert abs(off) < 0.5 * step_dps**2 / 12.0
        assert result.bias_dps == pytest.approx(bias_dps, abs=0.01)


@pytest.mark.parametrize("seed", range(6))
def test_noise_that_steps_of_the_rig_hide_at_rest_is_found_in_motion(seed: int) -> None:
    rng = np.random.default_rng(seed)
    noise, bias_dps = float(rng.uniform(0.0015, 0.003)), float(rng.uniform(-0.5, 0.5))
    own = {"noise_dps_rthz": noise, "bias_dps": bias_dps, "dps_per_lsb": 0.061, "sample_rate_hz": 50.0}
    rig = Rig(base=BASE.model_copy(update=own))
    session = Simulation(rig, MOTION, seed, minutes=MOTION.seconds / 60.0).whole()
    result = subject_of(recording_of(session), rig).rig.base
    assert abs(result.noise_dps_rthz**2 - noise**2) * result.sample_rate_hz < 0.5 * 0.061**2 / 12.0
    assert result.bias_dps == pytest.approx(bias_dps, abs=0.01)


@pytest.mark.parametrize("share", [0.5, 0.9])
def test_a_dead_band_within_a_count_changes_no_calibration(share: float) -> None:
    base = BASE.model_copy(update={"noise_dps_rthz": 0.002, "bias_dps": 0.02, "dps_per_lsb": 0.0305})
    session = Simulation(Rig(base=base), MOTION, 3, minutes=MOTION.seconds / 60.0).whole()
    subject = subject_of(recording_of(session), Rig(base=base))
    band = parse_effect(f"deadband:width_dps={share * 0.0305}")
    assert recalibrated_with(subject, (band,)).rig.base.noise_dps_rthz == subject.rig.base.noise_dps_rthz


def test_a_short_rest_shows_that_there_is_no_more_noise_than_its_steps_hide() -> None:
    """Four seconds of one value before a motion that never turns steadily: what moves is not taken for noise."""
    turns = [{"kind": "ramp", "seconds": 0.3, "to_dps": to_dps} for to_dps in (38.0, 5.0, 30.0, 10.0)]
    segments = [{"kind": "rest", "seconds": 4.0}, *turns * 20]
    motion = Profile.model_validate({"about": "Of a test.", "segments": segments})
    own = {"sample_rate_hz": 50.0, "dps_per_lsb": 0.061, "noise_dps_rthz": 0.0016, "bias_dps": 0.183}
    rig = Rig(base=BASE.model_copy(update={**own, "encoder_cpr": 8192}))
    session = Simulation(rig, motion, seed=2, minutes=0.45).whole()
    assert subject_of(recording_of(session), rig).rig.base.noise_dps_rthz < 0.0061


@pytest.mark.parametrize(("order", "cutoff_hz"), [(1, 35.0), (1, 12.0), (1, 5.0), (2, 35.0), (2, 12.0)])
def test_noise_that_a_low_pass_took_was_there_before(order: int, cutoff_hz: float) -> None:
    act = (parse_effect(f"bandwidth:cutoff_hz={cutoff_hz},order={order}"),)
    truth = Rig(base=BASE.model_copy(update={"noise_dps_rthz": NOISE_DPS_RTHZ}), effects=act)
    session = Simulation(truth, MOTION, seed=1, minutes=MOTION.seconds / 60.0).whole()
    alone, expected = (subject_of(recording_of(session), Rig(base=BASE, effects=stands)) for stands in ((), act))
    for subject in (alone, expected):
        result = recalibrated_with(subject, act).rig.base.noise_dps_rthz
        assert result == pytest.approx(NOISE_DPS_RTHZ, rel=0.12)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize(("order", "cutoff_hz"), [(1, 20.0), (1, 30.0), (2, 25.0)])
def test_noise_that_a_low_pass_took_and_steps_hide_at_rest_was_there_before(
    order: int, cutoff_hz: float, seed: int
) -> None:
    dice = np.random.default_rng(seed)
    behind = (parse_effect(f"bandwidth:cutoff_hz={cutoff_hz},order={order}"),)
    noise = float(0.4 * 0.061 / np.sqrt(2.0 * 1.2 * cutoff_hz))
    base = BASE.model_copy(
        update={"noise_dps_rthz": noise, "dps_per_lsb": 0.061, "bias_dps": float(dice.uniform(-1.0, 1.0))}
    )
    session = Simulation(Rig(base=base, effects=behind), MOTION, seed, minutes=MOTION.seconds / 60.0).whole()
    subject = subject_of(recording_of(session), Rig(base=base))
    assert is_hidden_at_rest(subject.cleaned, subject.design, subject.rig)
    assert recalibrated_with(subject, behind).rig.base.noise_dps_rthz == pytest.approx(noise, rel=0.25)


SWAYING = Profile.model_validate({
    "about": "Of a test: never at rest.",
    "segments": [{"kind": "chirp", "seconds": 90.0, "amplitude_dps": 20.0, "from_hz": 0.1, "to_hz": 0.4}],
})  # fmt: skip


def test_vibration_is_no_white_noise() -> None:
    """Vibration of 2 deg/s averages out within a second, so only the white noise counts there."""
    base = BASE.model_copy(update={"sample_rate_hz": 25.0, "noise_dps_rthz": 0.05})
    session = Simulation(Rig(base=base), SWAYING, seed=1, minutes=SWAYING.seconds / 60.0).whole()
    lines = np.fft.rfft(np.random.default_rng(2).standard_normal(len(session.rate_dps)))
    vibration_dps = np.fft.irfft(np.where(np.arange(len(lines)) > 0.2 * len(lines), lines, 0.0), len(session.rate_dps))
    shaken = replace(session, rate_dps=session.rate_dps + 2.0 / np.std(vibration_dps) * vibration_dps)
    calm, subject = (subject_of(recording_of(item), Rig(base=base)) for item in (session, shaken))
    assert calm.vibration.variance_ratio == 0.0
    assert subject.rig.base.noise_dps_rthz == pytest.approx(0.05, rel=0.5)
    of_vibration = subject.vibration.variance_ratio**0.5 * subject.rig.base.noise_dps_rthz * 5.0
    assert of_vibration == pytest.approx(2.0, rel=0.3)
