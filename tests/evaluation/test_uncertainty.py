"""Coverage and CRPS of a stated uncertainty by their definitions."""

from math import inf, nan
from statistics import NormalDist

import numpy as np
import pytest

pytest.importorskip("scipy", reason="comparing needs the workstation extra")
from gyrodrift.evaluation.reference import Reference
from gyrodrift.evaluation.score import Uncertainty, mean_uncertainty, normal_crps, uncertainty_of


def reference(reference_deg: list[float]) -> Reference:
    count = len(reference_deg)
    return Reference("x", np.ones(count), np.zeros(count), np.array(reference_deg), 1.0)


@pytest.mark.parametrize(("error", "sigma"), [(0.0, 1.0), (1.0, 0.5), (-3.0, 2.0), (0.1, 10.0)])
def test_crps_is_the_area_between_two_distributions(error: float, sigma: float) -> None:
    """Numerical integral over x of (Φ((x − error)/σ) − [x ≥ 0])²."""
    x = np.linspace(-120.0, 120.0, 24_001)
    stated = np.array([NormalDist(error, sigma).cdf(value) for value in x.tolist()])
    area = float(np.sum(np.square(stated - (x >= 0.0))) * (x[1] - x[0]))
    assert normal_crps(np.array([error]), np.array([sigma]))[0] == pytest.approx(area, rel=0.01)


def test_crps_without_uncertainty_is_the_absolute_error() -> None:
    errors = np.array([-2.0, 0.0, 0.5])
    np.testing.assert_allclose(normal_crps(errors, np.zeros(3)), np.abs(errors))
    np.testing.assert_allclose(normal_crps(errors, np.full(3, 1e-9)), np.abs(errors), atol=1e-8)


def test_coverage_counts_errors_within_two_sigma() -> None:
    """The bound is included; samples without a reference are ignored."""
    angle = reference([0.0, 0.0, 0.0, 0.0, nan])
    yaw_deg, sigma_deg = np.array([0.0, 2.0, 2.1, -0.5, 99.0]), np.array([0.0, 1.0, 1.0, 1.0, 1.0])
    result = uncertainty_of(angle, yaw_deg, sigma_deg)
    assert result is not None
    assert result.coverage == 0.75


@pytest.mark.parametrize("sigma", [nan, inf])
def test_a_sigma_that_is_not_finite_is_no_uncertainty(sigma: float) -> None:
    """A filter without an uncertainty gives NaN."""
    assert uncertainty_of(reference([0.0, 0.0]), np.zeros(2), np.array([1.0, sigma])) is None


def test_a_correct_uncertainty_covers_95_percent() -> None:
    dice = np.random.default_rng(5)
    sigma_deg = dice.uniform(0.5, 2.0, 100_000)
    result = uncertainty_of(reference([0.0] * 100_000), dice.normal(0.0, sigma_deg), sigma_deg)
    assert result is not None
    assert result.coverage == pytest.approx(0.954, abs=0.003)
    assert result.crps_deg == pytest.approx(sigma_deg.mean() / np.sqrt(np.pi), rel=0.01)


def test_a_mean_needs_every_session() -> None:
    first, second = Uncertainty(0.9, 1.0), Uncertainty(1.0, 3.0)
    assert mean_uncertainty([first, second]) == Uncertainty(0.95, 2.0)
    assert mean_uncertainty([first, None]) is None
    assert mean_uncertainty([]) is None
