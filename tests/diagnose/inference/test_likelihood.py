"""The likelihood of features: a Student density, and a model that is known to be inexact."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import evidence, response, row
from scipy.stats import t as student

from gyrodrift.diagnose.features.vector import FEATURES, IS_LOG, LINEAR, NUMBER, STATIC
from gyrodrift.diagnose.inference.likelihood import (
    Scatter,
    combined,
    discrepancy_variance,
    log_likelihood,
    log_likelihood_of_events,
)
from gyrodrift.diagnose.simulate.candidates import KINDS

NONE = np.zeros(len(FEATURES))
LOG = FEATURES[int(np.flatnonzero(IS_LOG)[0])].name
OTHER = FEATURES[int(np.flatnonzero(~IS_LOG & ~LINEAR)[0])].name


def test_it_is_a_student_density_of_four_degrees_of_freedom() -> None:
    """Up to a constant, with the spread as its scale."""
    residual, sigma = np.linspace(-9.0, 9.0, len(FEATURES)), np.geomspace(0.1, 10.0, len(FEATURES))
    found = log_likelihood(residual, sigma**2, NONE) - log_likelihood(NONE, np.ones(len(FEATURES)), NONE)
    expected = student.logpdf(residual, 4.0, scale=sigma) - student.logpdf(NONE, 4.0)
    assert found == pytest.approx(expected.sum())


def test_a_session_with_an_event_and_one_without_are_as_likely() -> None:
    """Half of either density; what nothing rare spreads has but one."""
    ones, rare = np.ones(len(FEATURES)), row({"rate": 8.0, "abs_rate": 3.0})
    scatter = Scatter(ones + rare, ones, row({"rate": -2.0}))
    for shown in ({}, {"rate": 9.0}):
        both = [
            student.logpdf(row(shown), 4.0, middle, np.sqrt(each)).sum()
            for middle, each in ((NONE, ones + rare), (scatter.shift, ones))
        ]
        found = log_likelihood_of_events(row(shown), scatter, NONE) - log_likelihood(NONE, ones, NONE)
        expected = np.log(0.5 * np.exp(both).sum()) - student.logpdf(NONE, 4.0).sum()
        assert found == pytest.approx(expected)
    assert log_likelihood_of_events(NONE, Scatter(ones, ones, NONE), ones) == log_likelihood(NONE, ones, ones)


def test_discrepancy_excuses_what_is_off_and_costs_nothing_elsewhere() -> None:
    """Unlike spread, which is paid for even where everything fits."""
    ones = np.ones(len(FEATURES))
    assert log_likelihood(NONE, ones, 9.0 * ones) == log_likelihood(NONE, ones, NONE)
    assert log_likelihood(NONE, 10.0 * ones, NONE) < log_likelihood(NONE, ones, NONE)
    off = row({"rate": 6.0})
    assert log_likelihood(off, ones, row({"rate": 9.0})) > log_likelihood(off, ones, NONE)


def test_discrepancy_is_a_share_of_the_change_and_leaks_to_other_regressors() -> None:
    """A tenth of 5 in its own feature, 4 % of the length 5 in every regressor, none in what is no regressor."""
    variance = discrepancy_variance(row({"rate": 3.0, "abs_rate": 4.0}), row({"rate": 30.0, "abs_rate": 40.0}))
    assert variance[NUMBER["rate"]] == pytest.approx(0.3**2 + 0.2**2)
    assert variance[NUMBER["abs_rate"]] == pytest.approx(0.4**2 + 0.2**2)
    assert variance[NUMBER["rate_cubed"]] == pytest.approx(0.2**2)
    assert not variance[STATIC:].any()


def test_what_has_but_one_form_leaks_less() -> None:
    """A gain is a line, and a limit a limit: 1 % of the length 10, beside a bend whose 4 % would hide another cause."""
    line, bend = response("scale_factor", {"rate": 10.0}), response("temp_bias", {"rate": 10.0})
    exact = replace(line, candidate=replace(line.candidate, is_exact=True))
    found = evidence({"rate": 10.0}, exact, bend).discrepancies
    number = NUMBER["rate_cubed"]
    assert found[exact][0, :, number] == pytest.approx(0.1**2)
    assert found[bend][0, :, number] == pytest.approx(0.4**2)
    assert {name for name, kind in KINDS.items() if kind.is_exact} == {
        "scale_factor", "scale_asymmetry", "clock_drift", "g_sensitivity", "encoder_eccentricity", "saturation",
    }  # fmt: skip


def test_a_cause_that_is_far_too_large_excuses_no_more_than_there_is() -> None:
    """The difference bounds what may be off."""
    difference = row({"rate": 2.0})
    huge, equal = (discrepancy_variance(row({"rate": size}), difference) for size in (1e6, 2.0))
    assert huge == pytest.approx(equal)


def test_logarithms_of_variances_add_as_variances() -> None:
    """Twice and thrice the variance are four times it: 2 + 3 − 1; all else is a sum."""
    both = combined(row({LOG: np.log(2.0), "rate": 2.0, OTHER: 1.0}), row({LOG: np.log(3.0), "rate": 3.0, OTHER: 1.0}))
    assert both[NUMBER[LOG]] == pytest.approx(np.log(4.0))
    assert both[NUMBER["rate"]] == 5.0
    assert both[NUMBER[OTHER]] == 2.0


def test_a_variance_that_falls_is_added_as_it_is() -> None:
    """Only what two effects put on top of the same noise adds as variances."""
    both = combined(row({LOG: np.log(2.0)}), row({LOG: -1.0}))
    assert both[NUMBER[LOG]] == pytest.approx(np.log(2.0) - 1.0)
