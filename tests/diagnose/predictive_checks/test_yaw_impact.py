"""Yaw errors of simulated sessions with the causes added, beside those of the recordings."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from simulate_support import session_of, subject_from

from firmware_sim.rig import parse_effect
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.yaw_impact import cost_deg, yaw_error_deg
from gyrodrift.diagnose.simulate.recalibration import corrected_recording
from gyrodrift.diagnose.simulate.twin import Subject


def error_deg(subject: Subject, text: str) -> float:
    """Mean absolute yaw error of a simulation with an effect."""
    effects = (parse_effect(text),) if text else ()
    return float(np.nanmean(np.abs(yaw_error_deg(corrected_recording(subject, effects, 1)))))


@pytest.mark.parametrize("effect", ["temp_bias:slope_dps_per_c=0.05", "warmup:amplitude_dps=0.5,time_constant_s=60"])
def test_a_corrected_session_errs_as_the_recording_does(effect: str) -> None:
    """An effect that carries a bias leaves the rig the rest of the bias and no more."""
    subject = subject_from(session_of(parse_effect(effect)))
    recorded = float(np.nanmean(np.abs(yaw_error_deg(subject.cleaned.recording))))
    assert error_deg(subject, effect) == pytest.approx(recorded, rel=0.1)


def test_the_cost_of_an_effect_is_what_the_recording_shows_of_it() -> None:
    """The difference between the recording and the rig as it stands, to 20 %."""
    effect = parse_effect("temp_bias:slope_dps_per_c=0.05")
    subject = subject_from(session_of(effect))
    cause = cast("NamedCause", SimpleNamespace(in_session=lambda *_: effect))
    away_deg = yaw_error_deg(subject.cleaned.recording) - yaw_error_deg(subject.played((), 0))
    assert cost_deg([subject], [cause], cause) == pytest.approx(np.nanmean(np.abs(away_deg)), rel=0.2)
