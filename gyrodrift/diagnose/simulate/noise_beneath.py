"""The noise beneath candidates: how much there was before they took some of what a recording shows."""

from collections.abc import Sequence

import numpy as np

from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.twin import Subject


def with_noise_beneath(subject: Subject, tried: Sequence[Candidate], effects: tuple[Effect, ...]) -> Subject:
    """The rig of a session as it is to be simulated with candidates, whose effects those are.

    Noise and bias of what hides them at rest are found beside it; else so much noise is tried as a candidate says.
    """
    if any(one.hides_rest for one in tried):
        subject = subject.recalibrated(effects)
    share = float(np.prod([one.noise_share for one in tried]))
    return subject if share == 1.0 else subject.with_noise(share)
