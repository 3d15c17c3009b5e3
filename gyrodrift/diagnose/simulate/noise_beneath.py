"""The noise beneath effects that are tried: how much there was before they took some of what a recording shows."""

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
"""Shares of the sample rate at which a low-pass is looked at."""


def with_noise_beneath(subject: Subject, effects: tuple[Effect, ...]) -> Subject:
    """The rig of a session as it is to be simulated with effects that are tried.

    Noise and bias of what hides them at rest, or scatters by itself, are found beside it; else the bias is what others
    leave of it, and all noise that is seen is behind a low-pass. Where the rig hides them at rest already, noise was
    found by what scatters from sample to sample in motion, of which a low-pass takes more than of what is slow.
    """
    before_dps, count_dps = (
        gyro_model_of(each).count_dps for each in (subject.rig, with_replaced(subject.rig, effects))
    )
    # Steps that were read off the rates are not exact.
    has_other_steps = abs(np.log(count_dps / before_dps)) > np.log(1.3)
    if has_other_steps or (any(hides_rest(one, count_dps) for one in effects) and _reads_zero(subject)):
        return subject.recalibrated(effects)
    share = _before_low_pass(subject.rig, effects)
    if share == 1.0:
        return subject.with_remaining_bias(effects)
    if is_hidden_at_rest(subject.cleaned, subject.design, subject.rig):
        return subject.recalibrated(effects)
    return subject.with_remaining_bias(effects).with_noise(share)


def corrected_session(subject: Subject, effects: tuple[Effect, ...], seed: int) -> Session:
    """The simulated session with effects added, as a host would have recorded it.

    The rig is calibrated beside the effects: the bias that a session shows is not counted a second time.
    """
    return with_noise_beneath(subject, effects).session(effects, seed)


def corrected_recording(subject: Subject, effects: tuple[Effect, ...], seed: int) -> Recording:
    """The same, with what the recording holds and no more."""
    return with_noise_beneath(subject, effects).played(effects, seed)


def _before_low_pass(rig: Rig, effects: tuple[Effect, ...]) -> float:
    """How many times the noise was before effects let the same through that a calibrated rig lets through."""
    passed = [_passed(each) for each in (rig, with_replaced(rig, effects))]
    return float(np.sqrt(passed[0] / passed[1]))


def _passed(rig: Rig) -> float:
    """Power of white noise behind the low-passes of a rig, where it is measured."""
    rate_hz = rig.base.sample_rate_hz
    return float(np.exp(np.log(gyro_model_of(rig).power_passed(rate_hz * BAND, rate_hz)).mean()))


def _reads_zero(subject: Subject) -> bool:
    """Whether the gyro says exactly zero at rest so often that something may hide there."""
    rest_dps = subject.cleaned.rate_dps[subject.design.regimes.at_rest]
    return len(rest_dps) == 0 or float(np.mean(rest_dps == 0.0)) > 0.02  # with fewer zeros nothing is hidden
