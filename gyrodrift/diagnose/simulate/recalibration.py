"""Calibration of a session's rig with effects that are tried: its noise and bias are adjusted to them."""

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.rig import Rig, with_replaced
from gyrodrift.diagnose.features.spectral_line import WHITE_BAND
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.simulate.calibration import is_hidden_at_rest
from gyrodrift.diagnose.simulate.known_effects import gyro_model_of, hides_rest
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.session.session import Session

BAND = np.linspace(*WHITE_BAND, 64)
"""Frequencies, as shares of the sample rate, at which the gain of low-passes is computed. Chosen: gains of low-passes
hardly change from one to the next."""


def recalibrated_with(subject: Subject, effects: tuple[Effect, ...]) -> Subject:
    """The subject with noise and bias calibrated for a simulation with effects that are tried.

    The rig is calibrated again by simulation if the effects change the steps, or hide noise and bias at rest. The same
    holds for a low-pass if the noise was measured in motion: that measurement uses higher frequencies, which a low-pass
    attenuates more. In all other cases the bias is reduced by the mean error of the effects, and the noise is divided
    by the gain of their low-passes.
    """
    before_dps, count_dps = (gyro_model_of(rig).count_dps for rig in (subject.rig, with_replaced(subject.rig, effects)))
    # A step that was estimated from rates is not exact, so a ratio below 1.3 is no difference.
    has_other_steps = abs(np.log(count_dps / before_dps)) > np.log(1.3)
    if has_other_steps or (any(hides_rest(effect, count_dps) for effect in effects) and _reads_zero(subject)):
        return subject.recalibrated(effects)
    noise_ratio = _noise_before_low_passes(subject.rig, effects)
    if noise_ratio == 1.0:
        return subject.with_remaining_bias(effects)
    if is_hidden_at_rest(subject.cleaned, subject.design, subject.rig):
        return subject.recalibrated(effects)
    return subject.with_remaining_bias(effects).with_noise(noise_ratio)


def corrected_session(subject: Subject, effects: tuple[Effect, ...], seed: int) -> Session:
    """Simulated session with effects added, as a host would have recorded it.

    The rig is calibrated with the effects, so that the bias of the recording is not counted twice.
    """
    return recalibrated_with(subject, effects).session(effects, seed)


def corrected_recording(subject: Subject, effects: tuple[Effect, ...], seed: int) -> Recording:
    """Recording of the simulated session with effects added; it has only the columns of the real recording."""
    return recalibrated_with(subject, effects).played(effects, seed)


def _noise_before_low_passes(rig: Rig, effects: tuple[Effect, ...]) -> float:
    """Factor of the noise density at which the low-passes of the effects leave the measured noise unchanged."""
    passed = [_passed(candidate_rig) for candidate_rig in (rig, with_replaced(rig, effects))]
    return float(np.sqrt(passed[0] / passed[1]))


def _passed(rig: Rig) -> float:
    """Share of the power of white noise that passes the low-passes of a rig, in the band of BAND."""
    rate_hz = rig.base.sample_rate_hz
    return float(np.exp(np.log(gyro_model_of(rig).power_passed(rate_hz * BAND, rate_hz)).mean()))


def _reads_zero(subject: Subject) -> bool:
    """Whether the gyro reports exactly zero at rest often enough for a dead band; True without a rest."""
    rest_dps = subject.cleaned.rate_dps[subject.design.regimes.at_rest]
    return len(rest_dps) == 0 or float(np.mean(rest_dps == 0.0)) > 0.02  # with fewer zeros no dead band acts
