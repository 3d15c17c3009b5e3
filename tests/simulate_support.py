"""Helpers for tests of simulated responses: a short turntable session of a rig."""

from dataclasses import replace
from functools import cache

import numpy as np

from firmware_sim.effects.effect import Effect
from firmware_sim.motion.profile import Profile
from firmware_sim.rig import Base, Rig
from gyrodrift.diagnose.features.vector import NUMBER
from gyrodrift.diagnose.recording.recording import recording_of
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidate_kind import Hints
from gyrodrift.diagnose.simulate.candidates import candidates
from gyrodrift.diagnose.simulate.responses import response
from gyrodrift.diagnose.simulate.twin import BaseRun, Subject, subject_of
from gyrodrift.session.session import Session
from gyrodrift.simulation.sessions import Simulation
from gyrodrift.values.arrays import Floats

BASE = Base()
RATE_HZ = BASE.sample_rate_hz

MOTION = Profile.model_validate(
    {
        "about": "Of a test: rest, a slow start, both directions at several speeds, and swings.",
        "segments": [
            {"kind": "rest", "seconds": 20.0},
            {"kind": "ramp", "seconds": 8.0, "to_dps": 2.0},
            {"kind": "ramp", "seconds": 2.0, "to_dps": 0.0},
            {"kind": "steps", "rates_dps": [20.0, -20.0, 90.0, -90.0, 45.0], "ramp_seconds": 4.0, "hold_seconds": 6.0},
            {"kind": "chirp", "seconds": 20.0, "amplitude_dps": 30.0, "from_hz": 0.2, "to_hz": 1.0},
            {"kind": "rest", "seconds": 20.0},
        ],
    }
)

HINTS = Hints(
    line_hz=20.0,
    spike_dps=20.0,
    slip_deg=0.5,
    rate_step_dps=0.25,
    angle_step_deg=0.5,
    least_dps=0.5,
    largest_dps=60.0,
    sample_period_s=0.01,
    bunch_s=0.0,
    dps_per_lsb=0.0076,
)


def session_of(*effects: Effect, minutes: float = MOTION.seconds / 60.0) -> Session:
    """A session of the shipped rig with these effects."""
    return Simulation(Rig(base=BASE, effects=effects), MOTION, seed=1, minutes=minutes).whole()


def subject_from(session: Session) -> Subject:
    return subject_of(recording_of(session), Rig(base=BASE))


@cache
def plain() -> Subject:
    """A session of the rig without any effect."""
    return subject_from(session_of())


@cache
def base_run(seed: int) -> BaseRun:
    return plain().base_run(seed)


def candidate_of(name: str) -> Candidate:
    """The first candidate of an effect or out-of-catalogue model."""
    return next(item for item in candidates(HINTS) if item.name == name)


def response_at(candidate: Candidate, *sizes: float) -> Floats:
    """(sizes, realisations, F) what these sizes change in the plain session."""
    base = [base_run(seed) for seed in range(candidate.realisations)]
    return response(plain(), replace(candidate, grid_points=np.array(sizes)), base)


def feature(values: Floats, name: str) -> Floats:
    """One of the features of an array (…, F)."""
    result: Floats = values[..., NUMBER[name]]
    return result
