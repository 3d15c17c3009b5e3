"""A motion that is drawn for a recording rests where that rests, by the encoder of its rig."""

from dataclasses import replace
from random import Random

import numpy as np
import pytest

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.twin import Subject, subject_of
from gyrodrift.simulation.sessions import Simulation

MINUTES, SEEDS = 1.5, 8


def table(seed: int) -> Subject:
    """A turntable whose encoder is drawn: some have fewer counts than the rig's base, which no multiple of them is."""
    dice = Random(seed)
    fine = dice.choice([512, 1024, 2048, 4096])
    fewer = f"encoder_quantization:cpr={round(fine * dice.uniform(0.25, 0.9))}"
    effects = tuple(map(parse_effect, [fewer] if seed % 2 else []))
    base = Base(
        sample_rate_hz=dice.choice([50.0, 100.0, 200.0]),
        encoder_cpr=fine,
        encoder_phase_deg=dice.uniform(0.0, 360.0),
        noise_dps_rthz=dice.uniform(0.003, 0.02),
    )
    rig = Rig(base=base, effects=effects)
    return subject_of(recording_of(Simulation(rig, load_profile("turntable"), seed, 0, MINUTES).whole()), rig)


@pytest.mark.parametrize("seed", range(6))
def test_every_motion_rests_in_the_counts_that_were_read(seed: int) -> None:
    item = table(seed)
    rests = [
        (first, end) for first, end in item.posterior.rests if (end - first) * item.cleaned.recording.period_s > 1.0
    ]
    assert rests
    for run in range(SEEDS):
        read_deg = item.replayed((), run).encoder_deg
        for first, end in rests:
            middle = (first + end) // 2
            np.testing.assert_allclose(read_deg[middle], item.cleaned.encoder_deg[middle], atol=1e-6)


def test_stamps_that_scatter_by_many_periods_need_no_counter() -> None:
    """The simulator knows the number of each sample, whatever its stamps say."""
    rig = Rig(base=Base(sample_rate_hz=1000.0, encoder_cpr=4096))
    session = Simulation(rig, load_profile("turntable"), 1, 0, 0.5).whole()
    subject = subject_of(recording_of(replace(session, seq=None, t_host_s=None)), rig)
    played = subject.played((parse_effect("timestamp_jitter:sigma_ms=100"),), 1)
    assert len(played.rate_dps) == len(subject.cleaned.rate_dps)
    assert not played.has_counter
