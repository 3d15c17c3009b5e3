"""Effects of the rig between motion and measurement: their phase in a session, and the angle without them."""

from dataclasses import replace

import numpy as np
import pytest
from simulate_support import BASE, MOTION, RATE_HZ

from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, parse_effect
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate import known_effects
from gyrodrift.diagnose.simulate.known_effects import gyro_model_of, sensor_model_of
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.simulation.sessions import Simulation

STATED_DEG = 40.0
ONCE = ["g_sensitivity:amplitude_dps=0.05", "encoder_eccentricity:amplitude_deg=0.3"]


REST = [
    "scale_asymmetry:error_percent=0.5",
    "nonlinearity:error_percent_fs=0.5",
    "latency:delay_ms=12",
    "bandwidth:cutoff_hz=15",
    "temp_bias:slope_dps_per_c=0.05",
]
"""Each errs by far more than what comes once per turn."""


def observed(
    effect: Effect,
    zeroed_deg: float = 0.0,
    *rest: Effect,
    absolute: bool = False,
    reference: bool = True,
    cpr: int = BASE.encoder_cpr,
) -> Subject:
    """A session of a rig with an effect and perhaps others, whose encoder was zeroed at an angle of the table."""
    base = BASE.model_copy(update={"encoder_phase_deg": zeroed_deg, "encoder_cpr": cpr})
    rig = Rig(base=base, effects=(effect, *rest))
    session = Simulation(rig, MOTION, seed=1, minutes=MOTION.seconds / 60.0).whole()
    assert session.encoder_deg is not None
    session = replace(session, encoder_deg=session.encoder_deg - zeroed_deg)
    stated = BASE.model_copy(update={"encoder_absolute": absolute, "encoder_cpr": cpr})
    return subject_of(recording_of(session), Rig(base=stated, effects=(effect, *rest) if reference else ()))


def once(text: str) -> Effect:
    return parse_effect(text).model_copy(update={"phase_deg": STATED_DEG})


def apart_deg(entry: float, second: float) -> float:
    return abs((entry - second + 180.0) % 360.0 - 180.0)


def off_deg(subject: Subject) -> float:
    """Root mean square of the error of the rebuilt angle."""
    true_deg = MOTION.motion_at(np.arange(subject.design.samples) / RATE_HZ)[0]
    return float(np.std(subject.posterior.mean.angle_deg - true_deg))


@pytest.mark.parametrize("zeroed_deg", [0.0, 130.0, -75.0])
@pytest.mark.parametrize("text", ONCE)
def test_a_phase_is_that_of_the_session(text: str, zeroed_deg: float) -> None:
    """sin(θ + φ) of a table that stood at θ₀ when the encoder was zeroed is sin(θ' + θ₀ + φ) by the encoder."""
    (effect,) = observed(once(text), zeroed_deg).rig.effects
    assert apart_deg(effect.model_dump()["phase_deg"], zeroed_deg + STATED_DEG) < 10.0


@pytest.mark.parametrize("second", REST)
@pytest.mark.parametrize("text", ONCE)
def test_a_phase_is_found_beside_what_else_the_rig_has(text: str, second: str) -> None:
    (effect, _) = observed(once(text), 130.0, parse_effect(second)).rig.effects
    assert apart_deg(effect.model_dump()["phase_deg"], 130.0 + STATED_DEG) < 12.0


@pytest.mark.parametrize(
    "text",
    [
        "encoder_eccentricity:amplitude_deg=0.5,phase_deg=40",
        "backlash:play_deg=0.5",
        "latency:delay_ms=15",
        "bandwidth:cutoff_hz=8",
    ],
)
def test_the_motion_is_the_one_behind_what_is_held_to_act(text: str) -> None:
    """Nearer to the table than one that takes encoder and gyro for as good as the rig says."""
    effect = parse_effect(text)
    unknown = observed(effect, absolute=True, reference=False, cpr=1024)
    kept = unknown.with_motion_under((effect,))
    assert off_deg(kept) < 0.75 * off_deg(unknown)
    assert unknown.with_motion_under((effect,)) is kept  # realisations of one size follow one another


def test_a_simulation_shows_the_angles_of_the_recording_whatever_bent_them() -> None:
    """A disc off its centre is in them already, and does not show twice."""
    effect = parse_effect("encoder_eccentricity:amplitude_deg=0.5,phase_deg=40")
    subject = observed(effect, absolute=True, reference=False)
    real_deg = subject.cleaned.recording.encoder_deg
    with_it_deg = subject.played((effect,), 0).encoder_deg
    assert np.std(with_it_deg - real_deg) < 0.5 * np.std(subject.played((), 0).encoder_deg - real_deg) + 0.02


@pytest.mark.parametrize("text", ["scale_factor:error_percent=1", "encoder_slip:step_deg=1", "clock_drift:ppm=100"])
def test_what_bends_no_motion_leaves_it(text: str) -> None:
    """A gain of the gyro goes with the motion as its bias does, and jumps are taken out as what they are."""
    subject = observed(parse_effect(text), reference=False)
    assert subject.with_motion_under((parse_effect(text),)) is subject


def test_an_effect_that_is_no_candidate_may_stand_in_the_rig(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(known_effects, "KINDS", {})
    (effect, _) = observed(once(ONCE[0]), 130.0, parse_effect("scale_factor:error_percent=0.5")).rig.effects
    assert apart_deg(effect.model_dump()["phase_deg"], 130.0 + STATED_DEG) < 10.0


@pytest.mark.parametrize("text", ONCE)
def test_an_absolute_encoder_keeps_the_phase_of_the_rig(text: str) -> None:
    (effect,) = observed(once(text), 130.0, absolute=True).rig.effects
    assert effect == once(text)


def test_the_angle_is_rebuilt_without_the_eccentricity_of_the_rig() -> None:
    assert off_deg(observed(once(ONCE[1]), 130.0)) < 0.01
    assert off_deg(observed(once(ONCE[1]), 130.0, reference=False)) > 0.15


def test_the_angle_is_rebuilt_without_the_backlash_of_the_rig() -> None:
    play = parse_effect("backlash:play_deg=0.5")
    assert off_deg(observed(play)) < 0.3 * off_deg(observed(play, reference=False))


@pytest.mark.parametrize(("order", "cutoff_hz"), [(1, 3.0), (1, 8.0), (2, 4.0), (2, 10.0)])
def test_behind_a_low_pass_of_the_rig_noise_is_no_motion_and_motion_is_whole(order: int, cutoff_hz: float) -> None:
    """Slow noise looks like motion, and quick motion is weakened: neither where the rig knows of it."""
    effect = parse_effect(f"bandwidth:cutoff_hz={cutoff_hz},order={order}")
    base = BASE.model_copy(update={"encoder_cpr": 512, "noise_dps_rthz": 0.01})
    session = Simulation(Rig(base=base, effects=(effect,)), MOTION, seed=2, minutes=MOTION.seconds / 60.0).whole()
    expected, unknown = (subject_of(recording_of(session), Rig(base=base, effects=has)) for has in ((effect,), ()))
    true_dps = MOTION.motion_at(np.arange(expected.design.samples) / RATE_HZ)[1]
    at_rest = true_dps == 0.0
    off_dps = [item.posterior.mean.rate_dps - true_dps for item in (expected, unknown)]
    for regime, share in ((at_rest, 0.5), (~at_rest, 0.95)):
        assert np.std(off_dps[0][regime]) < share * np.std(off_dps[1][regime])
    assert 0.06 < expected.posterior.sigma_dps < 0.2  # 0.1, of noise that would be as dense, and some of the motion


@pytest.mark.parametrize(("rate_hz", "cutoff_hz", "order"), [(50.0, 45.0, 1), (100.0, 45.0, 2), (400.0, 45.0, 1)])
def test_noise_that_folds_down_behind_a_low_pass_is_as_large_as_it_is(
    rate_hz: float, cutoff_hz: float, order: int
) -> None:
    effect = parse_effect(f"bandwidth:cutoff_hz={cutoff_hz},order={order}")
    base = BASE.model_copy(update={"sample_rate_hz": rate_hz, "noise_dps_rthz": 0.01})
    rig = Rig(base=base, effects=(effect,))
    result = subject_of(recording_of(Simulation(rig, MOTION, seed=3, minutes=MOTION.seconds / 60.0).whole()), rig)
    folded = np.arange(-40, 41) * rate_hz / cutoff_hz
    density = np.sum(1.0 / (1.0 + folded ** (2 * order)))
    assert result.posterior.sigma_dps == pytest.approx(0.01 * np.sqrt(density * rate_hz), rel=0.2)


def test_a_gyro_is_as_late_as_its_rig_says() -> None:
    """A delay of 12 ms, and a low-pass of 20 Hz whose time constant is 7.96 ms; √2 times that in second order."""
    rig = Rig(base=BASE, effects=(parse_effect("latency:delay_ms=12"), parse_effect("bandwidth:cutoff_hz=20")))
    assert gyro_model_of(rig).delay_s == pytest.approx(0.012 + 0.0079577, abs=1e-6)
    assert gyro_model_of(Rig(base=BASE, effects=(parse_effect("bandwidth:cutoff_hz=20,order=2"),))).delay_s == (
        pytest.approx(0.011254, abs=1e-6)
    )
    assert gyro_model_of(rig).count_dps == BASE.dps_per_lsb
    assert gyro_model_of(Rig(base=BASE)).delay_s == 0.0


def test_jumps_are_no_known_error_of_the_encoder() -> None:
    assert not sensor_model_of(
        Rig(effects=(parse_effect("encoder_slip"), parse_effect("scale_factor")))
    ).distorts_motion
    assert sensor_model_of(Rig(effects=(parse_effect("backlash"),))).distorts_motion
