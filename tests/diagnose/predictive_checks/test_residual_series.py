"""Rate errors second by second and what they depend on, of a gyro that reads 2 % high."""

from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from simulate_support import candidate_of, session_of, subject_from

from firmware_sim.rig import parse_effect
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.residual_checks import dependences_of
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries, residual_series_of
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.values.arrays import Floats

HIGH = parse_effect("scale_factor:error_percent=2")


@cache
def subject() -> Subject:
    return subject_from(session_of(HIGH))


@cache
def series(*, is_named: bool) -> ResidualSeries:
    cause = SimpleNamespace(is_random=False, candidate=candidate_of("scale_factor"))
    named = cast("NamedCause", SimpleNamespace(cause=cause, in_session=lambda *_: HIGH))
    return residual_series_of(subject(), (named,) if is_named else (), 1)


def slope(error_dps: Floats) -> float:
    rate_dps = subject().design.regimes.block_rate_dps
    return float(np.polyfit(rate_dps, error_dps, 1)[0])


def test_the_error_of_the_recording_grows_with_the_rate_and_that_of_the_rig_does_not() -> None:
    item = series(is_named=False)
    assert slope(item.real_dps) == pytest.approx(0.02, abs=5e-4)
    assert slope(item.before_dps) == pytest.approx(0.0, abs=5e-4)
    assert slope(item.unexplained_dps) == pytest.approx(0.02, abs=5e-4)


def test_with_the_cause_the_rig_errs_as_the_recording_does() -> None:
    item = series(is_named=True)
    assert slope(item.before_dps) == pytest.approx(0.0, abs=5e-4)
    assert slope(item.after_dps) == pytest.approx(0.02, abs=5e-4)
    assert slope(item.unexplained_dps) == pytest.approx(0.0, abs=5e-4)


def test_without_causes_there_is_one_simulation() -> None:
    item = series(is_named=False)
    assert item.after_dps.tolist() == item.before_dps.tolist()


def test_every_second_has_its_middle_and_errors_have_no_level() -> None:
    """The first middle is half a second after the beginning; the bias is taken away as the median."""
    item = series(is_named=False)
    assert item.minutes[:2] * 60.0 == pytest.approx([0.5, 1.5], rel=1e-3)
    assert len(item.minutes) == len(item.real_dps) == len(item.unexplained_dps)
    assert np.median(item.real_dps) == pytest.approx(0.0, abs=1e-12)


def test_the_error_is_found_to_follow_the_rate() -> None:
    rate_dps = subject().design.regimes.block_rate_dps
    without, with_it = (
        {item.name: item for item in dependences_of([series(is_named=is_named)], [subject()])}["rate"]
        for is_named in (False, True)
    )
    expected_dps = 0.02 * float(np.std(rate_dps))
    assert 0.6 * expected_dps < without.trend_before_dps < expected_dps
    assert 0.6 * expected_dps < without.trend_dps < expected_dps
    assert with_it.trend_dps < 0.1 * expected_dps
    assert (np.diff(without.x) >= 0.0).all()
    assert sorted(rate_dps) == pytest.approx(without.x.tolist())


def test_what_never_changes_is_no_dependence() -> None:
    """A session without temperatures shows none on temperature."""
    plain = session_of(HIGH)
    cold = subject_from(
        type(plain)(plain.name, plain.t_device_s, plain.rate_dps, plain.t_host_s, plain.seq, plain.encoder_deg)
    )
    names = {item.name for item in dependences_of([residual_series_of(cold, (), 1)], [cold])}
    assert "temperature" not in names
    assert {"rate", "angle within the turn", "time since the session began"} <= names
