"""Factors of random effects: the dense Gaussian density, and how far few realisations are believed."""

import numpy as np
import pytest
from scipy.stats import multivariate_normal

from gyrodrift.diagnose.inference.factors import MOST_FACTORS, covariance_of, explained, shrinkage
from gyrodrift.values.arrays import Floats

GAUSSIAN = 1e9
"""Degrees of freedom of a Student density that is a Gaussian one."""

F = 6


def log_normal(residual: Floats, variance: Floats) -> float:
    return float(multivariate_normal.logpdf(residual, cov=variance))


def test_explained_residual_and_its_cost_are_the_dense_gaussian_density() -> None:
    """Equation (5), for own factors and those of effects that are placed already, in each session."""
    rng = np.random.default_rng(1)
    residual, own, placed = (
        rng.standard_normal((2, 3, F)),
        rng.standard_normal((2, 3, 2, F)),
        rng.standard_normal((3, 1, F)),
    )
    variance = rng.uniform(0.5, 2.0, (2, 3, F))
    remaining, cost = explained(residual, own, placed, variance, GAUSSIAN)
    for point in range(2):
        dense, sparse = 0.0, float(cost[point])
        for session in range(3):
            factors = np.concatenate([own[point, session], placed[session]])
            diagonal = np.diag(variance[point, session])
            dense += log_normal(residual[point, session], diagonal + factors.T @ factors)
            sparse += log_normal(remaining[point, session], diagonal)
        assert sparse == pytest.approx(dense, abs=1e-5)


def test_features_that_no_factor_moves_keep_their_residual() -> None:
    residual = np.ones((1, 1, F))
    own = np.zeros((1, 1, 1, F))
    remaining, cost = explained(residual, own, np.zeros((1, 0, F)), np.ones((1, 1, F)), GAUSSIAN)
    assert np.array_equal(remaining, residual)
    assert cost.tolist() == [0.0]
    own[..., 0] = 3.0
    remaining, cost = explained(residual, own, np.zeros((1, 0, F)), np.ones((1, 1, F)), GAUSSIAN)
    assert np.array_equal(remaining[..., 1:], residual[..., 1:])
    assert remaining[0, 0, 0] == pytest.approx(0.1)
    assert cost[0] == pytest.approx(-0.5 * 0.3**2 - 0.5 * np.log(10.0))


def test_an_outlier_pulls_a_factor_less_under_a_student_density() -> None:
    """Three features that agree, and one that does not."""
    residual, own = np.array([[[3.0, 3.0, 3.0, -20.0]]]), np.ones((1, 1, 1, 4))
    remainders = [
        explained(residual, own, np.zeros((1, 0, 4)), np.ones((1, 1, 4)), nu)[0][0, 0] for nu in (GAUSSIAN, 4.0)
    ]
    gaussian, student = (3.0 - remaining[0] for remaining in remainders)
    assert gaussian < 0.0
    assert student > 1.0


@pytest.mark.parametrize(("count", "most"), [(8, 0.3), (32, 0.1)])
def test_shrinkage_is_near_1_for_independent_noise_and_near_0_for_a_common_factor(count: int, most: float) -> None:
    """Fewer realisations are shrunk more. Their mean is taken off."""
    rng = np.random.default_rng(3)
    independent, common = rng.standard_normal((count, 40)), np.tile(rng.standard_normal((count, 1)), (1, 40))
    common = common + 0.05 * rng.standard_normal((count, 40))
    alone, together = (shrinkage(values - values.mean(axis=0)) for values in (independent, common))
    assert alone > 0.8
    assert together < most


def test_a_covariance_keeps_the_variance_of_each_feature() -> None:
    """Scatter and factors together; a feature that stays where it is has neither."""
    realized = np.random.default_rng(4).standard_normal((16, F)) * np.array([3.0, 1.0, 0.5, 2.0, 1.0, 0.0])
    realized = realized - realized.mean(axis=0)
    result = covariance_of(realized)
    assert result.scatter + np.square(result.factors).sum(axis=0) == pytest.approx(np.square(realized).mean(axis=0))
    assert (result.scatter >= -1e-12).all()
    assert len(result.factors) <= MOST_FACTORS
    assert not result.factors[:, 5].any()


def test_a_common_factor_is_found_with_its_signs() -> None:
    """A disturbance that raises one feature and lowers another twice as much."""
    along = np.array([1.0, -2.0, 0.0])
    amounts = np.random.default_rng(5).standard_normal((64, 1))
    amounts -= amounts.mean()
    result = covariance_of(amounts * along)
    assert result.factors.T @ result.factors == pytest.approx(
        np.outer(along, along) * np.square(amounts).mean(), rel=0.05, abs=1e-9
    )


def test_two_realisations_have_no_factors() -> None:
    result = covariance_of(np.array([[1.0, 1.0], [-1.0, -1.0]]))
    assert result.factors.shape == (0, 2)
    assert result.scatter.tolist() == [1.0, 1.0]
