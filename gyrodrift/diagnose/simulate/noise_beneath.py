"""The noise beneath candidates: how much there was before they took some of what a recording shows."""

from collections.abc import Sequence

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.effects.sensor_dynamics import Bandwidth
from firmware_sim.rig import Rig, with_replaced
from gyrodrift.diagnose.features.spectral_line import WHITE_BAND
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.known_effects import hides_rest
from gyrodrift.diagnose.simulate.twin import Subject

BAND_POINTS, FOLDS = 64, 20
"""Frequencies at which a low-pass is looked at, and multiples of the sample rate, on either side, that fold down."""

ZERO_SHARE = 0.02
"""Of the samples at rest that read zero; with fewer nothing is hidden."""


def with_noise_beneath(subject: Subject, tried: Sequence[Candidate], effects: tuple[Effect, ...]) -> Subject:
    """The rig of a session as it is to be simulated with candidates, whose effects those are.

    Noise and bias of what hides them at rest are found beside it; else the bias is what others leave of it, and all
    noise that is seen is behind a low-pass. So much of it is tried as a candidate says.
    """
    is_hidden = any(map(hides_rest, effects)) and _reads_zero(subject)
    subject = subject.recalibrated(effects) if is_hidden else subject.beside(effects)
    share = float(np.prod([one.noise_share for one in tried]))
    if any(isinstance(effect, Bandwidth) for effect in effects):
        share *= _before_low_pass(subject.rig, effects)
    return subject if share == 1.0 else subject.with_noise(share)


def _before_low_pass(rig: Rig, effects: tuple[Effect, ...]) -> float:
    """How many times the noise was before effects let the same through that a calibrated rig lets through."""
    passed = [_passed(each.effects, rig.base.sample_rate_hz) for each in (rig, with_replaced(rig, effects))]
    return float(np.sqrt(passed[0] / passed[1]))


def _passed(effects: Sequence[Effect], sample_rate_hz: float) -> float:
    """Power of white noise behind low-passes where it is measured: what they leave, and what folds down to it."""
    low_passes = [effect for effect in effects if isinstance(effect, Bandwidth)]
    if not low_passes:
        return 1.0
    frequencies_hz = sample_rate_hz * (np.linspace(*WHITE_BAND, BAND_POINTS) + np.arange(-FOLDS, FOLDS + 1)[:, None])
    left = np.prod([each.power_passed(frequencies_hz) for each in low_passes], axis=0).sum(axis=0)
    return float(np.exp(np.log(left).mean()))


def _reads_zero(subject: Subject) -> bool:
    """Whether the gyro says exactly zero at rest so often that something may hide there."""
    rest_dps = subject.seen.rate_dps[subject.design.regimes.at_rest]
    return len(rest_dps) == 0 or float(np.mean(rest_dps == 0.0)) > ZERO_SHARE
