"""Rate errors second by second and what they depend on, of a gyro that reads 2 % high."""

from functools import cache
from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from simulate_support import candidate_of, session_of, subject_from

from firmware_sim.rig import parse_effect
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.rate_errors import (
    ResidualSeries,
    dependences_of,
    series_of,
    spectra_of,
    trend_of,
)
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
    return series_of(subject(), (named,) if is_named else (), 1)


def slope(error_dps: Floats) -> float:
    rate_dps = subject().design.regimes.block_rate_dps
    return float(np.polyfit(rate_dps, error_dps, 1)[0])


def test_the_error_of_the_recording_grows_with_the_rate_and_that_of_the_rig_does_not() -> None:
    item = series(is_named=False)
    assert slope(item.errors.real) == pytest.approx(0.02, abs=5e-4)
    assert slope(item.errors.before) == pytest.approx(0.0, abs=5e-4)
    assert slope(item.errors.unexplained) == pytest.approx(0.02, abs=5e-4)


def test_with_the_cause_the_rig_errs_as_the_recording_does() -> None:
    item = series(is_named=True)
    assert slope(item.errors.before) == pytest.approx(0.0, abs=5e-4)
    assert slope(item.errors.after) == pytest.approx(0.02, abs=5e-4)
    assert slope(item.errors.unexplained) == pytest.approx(0.0, abs=5e-4)


def test_without_causes_there_is_one_simulation() -> None:
    item = series(is_named=False)
    assert item.errors.after.tolist() == item.errors.before.tolist()


def test_every_second_has_its_middle_and_errors_have_no_level() -> None:
    """The first middle is half a second after the beginning; the bias is taken away as the median."""
    item = series(is_named=False)
    assert item.minutes[:2] * 60.0 == pytest.approx([0.5, 1.5], rel=1e-3)
    assert len(item.minutes) == len(item.errors.real) == len(item.errors.unexplained)
    assert np.median(item.errors.real) == pytest.approx(0.0, abs=1e-12)


def test_the_error_is_found_to_follow_the_rate() -> None:
    rate_dps = subject().design.regimes.block_rate_dps
    without, with_it = (
        {item.name: item for item in dependences_of([series(is_named=is_named)], [subject()])}["rate"]
        for is_named in (False, True)
    )
    expected_dps = 0.02 * float(np.std(rate_dps))
    assert 0.6 * expected_dps < without.before_dps < expected_dps
    assert 0.6 * expected_dps < without.after_dps < expected_dps
    assert with_it.after_dps < 0.1 * expected_dps
    assert (np.diff(without.x) >= 0.0).all()
    assert sorted(rate_dps) == pytest.approx(without.x.tolist())


def test_what_never_changes_is_no_dependence() -> None:
    """A session without temperatures shows none on temperature."""
    plain = session_of(HIGH)
    cold = subject_from(
        type(plain)(plain.name, plain.t_device_s, plain.rate_dps, plain.t_host_s, plain.seq, plain.encoder_deg)
    )
    names = {item.name for item in dependences_of([series_of(cold, (), 1)], [cold])}
    assert "temperature" not in names
    assert {"rate", "angle within the turn", "time since the session began"} <= names


def test_white_noise_at_rest_has_its_own_density() -> None:
    """Recording and simulation have the noise of the rig."""
    spectra = spectra_of([series(is_named=False)])
    assert spectra is not None
    noise_dps_rthz = subject().rig.base.noise_dps_rthz
    assert np.median(spectra.real) == pytest.approx(noise_dps_rthz, rel=0.2)
    assert np.median(spectra.before) == pytest.approx(noise_dps_rthz, rel=0.2)
    assert spectra.hz[-1] < 0.5 / subject().design.period_s


RNG = np.random.default_rng(2)
X = np.sort(RNG.uniform(-100.0, 100.0, 2000))


def test_a_trend_follows_a_shape() -> None:
    """Past outliers, with an error that holds."""
    y = np.abs(X) + RNG.normal(0.0, 5.0, len(X))
    y[::50] = 1e4
    trend = trend_of(X, y)
    assert len(trend.x) > 10
    assert np.abs(trend.y - np.abs(trend.x)).max() < 5.0
    assert 0.2 < np.median(trend.error) < 2.0


def test_values_that_come_often_share_a_bin() -> None:
    x = np.sort(np.concatenate([np.zeros(1000), X]))
    assert trend_of(x, np.where(x == 0.0, 3.0, 0.0)).y.max() == 3.0


def test_a_trend_is_as_high_as_it_is() -> None:
    """RMS of what follows x; noise alone has next to none, and nothing has none."""
    noise = RNG.normal(0.0, 1.0, len(X))
    assert trend_of(X, 0.02 * X + noise).rms == pytest.approx(np.std(0.02 * X), rel=0.1)
    assert trend_of(X, noise).rms < 0.1
    assert trend_of(np.zeros(0), np.zeros(0)).rms == trend_of(np.zeros(9), np.ones(9)).rms == 0.0
