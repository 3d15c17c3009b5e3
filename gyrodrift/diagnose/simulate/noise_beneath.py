"""The noise beneath candidates: how much there was before they took some of what a recording shows."""

from collections.abc import Sequence

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.known_effects import hides_rest
from gyrodrift.diagnose.simulate.twin import Subject

ZERO_SHARE = 0.02
"""Of the samples at rest that read zero; with fewer nothing is hidden."""


def with_noise_beneath(subject: Subject, tried: Sequence[Candidate], effects: tuple[Effect, ...]) -> Subject:
    """The rig of a session as it is to be simulated with candidates, whose effects those are.

    Noise and bias of what hides them at rest are found beside it; else the bias is what others leave of it. So much
    noise is tried as a candidate says.
    """
    is_hidden = any(map(hides_rest, effects)) and _reads_zero(subject)
    subject = subject.recalibrated(effects) if is_hidden else subject.beside(effects)
    share = float(np.prod([one.noise_share for one in tried]))
    return subject if share == 1.0 else subject.with_noise(share)


def _reads_zero(subject: Subject) -> bool:
    """Whether the gyro says exactly zero at rest so often that something may hide there."""
    rest_dps = subject.seen.rate_dps[subject.design.regimes.at_rest]
    return len(rest_dps) == 0 or float(np.mean(rest_dps == 0.0)) > ZERO_SHARE
