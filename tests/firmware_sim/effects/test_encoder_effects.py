"""The encoder: its errors against the true angle, which the gyro knows nothing of."""

import numpy as np
import pytest
from effects_bench import REST, effect_of, once_per_turn, phasor, profile_of, put_in, record, rig_of, sized

from firmware_sim.effects.effect import Effect
from firmware_sim.effects.encoder import Backlash, EncoderSlip
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base

TO_AND_FRO = {"kind": "steps", "rates_dps": [60.0, -60.0] * 10, "ramp_seconds": 0.1, "hold_seconds": 2.0}
ENCODER_EFFECTS = ["encoder_eccentricity", "encoder_slip", "encoder_quantization", "backlash"]


def spin(to_dps: float) -> list[dict[str, object]]:
    return [{"kind": "ramp", "seconds": 1.0, "to_dps": to_dps}, {"kind": "hold", "seconds": 1e4}]


@sized("encoder_eccentricity")
@pytest.mark.parametrize("to_dps", [-45.0, 90.0])
def test_an_eccentric_disc_errs_once_per_turn_whatever_the_speed(effect: Effect | None, to_dps: float) -> None:
    """Amplitude and phase against the true angle, to a millidegree."""
    run = record(rig_of(effect), profile_of(*spin(to_dps)), 100.0)
    result = once_per_turn(run.encoder_error_deg, run.angle_deg)
    assert result == pytest.approx(phasor(effect, "amplitude_deg"), abs=0.001)


@sized("encoder_slip")
def test_a_slipping_encoder_jumps_and_stays(effect: Effect | None) -> None:
    rig = rig_of(effect, base=Base(sample_rate_hz=1.0))
    jumps_deg = np.diff(record(rig, profile_of(*REST), 36000.0).encoder_error_deg)
    jumps_deg = jumps_deg[np.abs(jumps_deg) > 0.02]
    due = 10.0 * put_in(effect, "per_hour")
    assert abs(jumps_deg.size - due) <= 5.0 * np.sqrt(due)
    for side in (1.0, -1.0) if effect else ():
        same = jumps_deg[np.sign(jumps_deg) == side]
        assert np.median(same) == pytest.approx(side * put_in(effect, "step_deg"), abs=0.01)
        assert same.size > 0.3 * jumps_deg.size


def test_slips_come_at_any_time() -> None:
    """The gaps between them are exponential: their scatter is their mean, to 10 %."""
    rig = rig_of(EncoderSlip(step_deg=1.0, per_hour=36.0), base=Base(sample_rate_hz=1.0))
    encoder_deg = record(rig, profile_of(*REST), 36000.0).encoder_deg
    gaps_s = np.diff(np.flatnonzero(np.diff(encoder_deg)))
    assert gaps_s.mean() == pytest.approx(100.0, rel=0.2)
    assert gaps_s.std() == pytest.approx(gaps_s.mean(), rel=0.2)


@sized("encoder_quantization")
def test_a_turn_has_as_many_angles_as_the_encoder_counts(effect: Effect | None) -> None:
    """Distinct angles over one slow turn, to one; without the effect those of the rig."""
    run = record(rig_of(effect), profile_of(*spin(1.0)), 460.0)
    turn = (run.angle_deg >= 90.0) & (run.angle_deg < 450.0)
    assert len(np.unique(run.encoder_deg[turn])) == pytest.approx(put_in(effect, "cpr") or 36000, abs=1)


@sized("backlash")
def test_the_encoder_lags_by_half_the_play_on_either_side(effect: Effect | None) -> None:
    run = record(rig_of(effect), profile_of(TO_AND_FRO), 40.0)
    steady = np.abs(run.true_dps) == 60.0
    steady[1:] &= steady[:-1]
    error_deg = run.encoder_error_deg
    backward, forward = (np.median(error_deg[steady & (run.true_dps * way > 0.0)]) for way in (-1.0, 1.0))
    assert backward - forward == pytest.approx(put_in(effect, "play_deg"), abs=0.002)
    assert backward + forward == pytest.approx(0.0, abs=0.002)


def test_within_the_play_the_encoder_stands_still() -> None:
    """A table that swings by less than half the play does not move the encoder."""
    swing = {"kind": "sine", "seconds": 100.0, "amplitude_dps": 1.0, "frequency_hz": 1.0}
    run = record(rig_of(Backlash(play_deg=1.0)), profile_of(swing), 50.0)
    assert np.ptp(run.angle_deg) > 0.3
    assert np.ptp(run.encoder_deg) == 0.0


@pytest.mark.parametrize("name", ENCODER_EFFECTS)
def test_the_gyro_knows_nothing_of_the_encoder(name: str) -> None:
    """Rates are the same to the last bit with every effect of the encoder."""
    profile = load_profile("turntable")
    with_it, without = (record(rig_of(effect), profile, 70.0) for effect in (effect_of(name), None))
    assert with_it.rate_dps.tolist() == without.rate_dps.tolist()
    assert with_it.encoder_deg.tolist() != without.encoder_deg.tolist() or name == "encoder_slip"
