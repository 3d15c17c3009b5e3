"""The density of the differences against scipy, and against a sum over all states of an unknown effect."""

from itertools import product
from math import inf, log

import numpy as np
import pytest
from scipy.stats import multivariate_t

from gyrodrift.diagnose.inference.density import (
    BROAD_IN_GROUP,
    DEGREES_OF_FREEDOM,
    UNKNOWN_BROAD,
    UNKNOWN_COMMON,
    UNKNOWN_IN_GROUP,
    UNKNOWN_SHARES,
    UNKNOWN_WIDTHS,
    Groups,
    LogDensities,
    log_densities,
    log_no_unknown,
)
from gyrodrift.values.arrays import Floats

S = 3
COVARIANCE = np.array([[1.0, 0.3, 0.3], [0.3, 2.0, 0.3], [0.3, 0.3, 0.5]])


def student(residual: Floats, covariance: Floats) -> float:
    return float(multivariate_t.logpdf(residual, shape=covariance, df=DEGREES_OF_FREEDOM))


def densities(residual: Floats, groups: Groups, **template: Floats) -> LogDensities:
    """Log densities of one point of a template that by default changes nothing; residual is (S, F)."""
    none = np.zeros((1, *residual.shape))
    mean, scatter, form = (template.get(name, none) for name in ("mean", "scatter", "form"))
    covariance = np.tile(COVARIANCE, (residual.shape[1], 1, 1))
    return log_densities(residual[None], mean, scatter, form, covariance, groups)


def one_group(features: int) -> Groups:
    return Groups(np.zeros(features, dtype=np.int64), 1, np.ones(features, dtype=np.bool_))


def test_a_feature_has_a_multivariate_student_density() -> None:
    residual = np.array([[0.5], [-2.0], [3.0]])
    result = densities(residual, one_group(1)).without_unknown
    assert result == pytest.approx([student(residual[:, 0], COVARIANCE)])


def test_form_and_scatter_join_the_covariance() -> None:
    residual = np.array([[0.5], [-2.0], [3.0]])
    form, scatter = np.array([[[0.7], [-0.2], [0.4]]]), np.array([[[0.1], [0.2], [0.3]]])
    result = densities(residual, one_group(1), mean=np.sign(form), scatter=scatter, form=form).without_unknown
    column = form[0, :, 0]
    covariance = COVARIANCE + 0.5 * np.outer(column, column) + np.diag(0.5 * np.square(column) + scatter[0, :, 0])
    assert result == pytest.approx([student(residual[:, 0], covariance)])


def test_a_feature_that_no_session_compares_does_not_count() -> None:
    residual = np.array([[0.5, 90.0], [-2.0, 90.0], [3.0, 90.0]])
    groups = Groups(np.zeros(2, dtype=np.int64), 1, np.array([True, False]))
    alone = densities(residual[:, :1], one_group(1))
    for pair, single in zip(densities(residual, groups), alone, strict=True):
        assert pair == pytest.approx(single)


def summed_by_hand(residual: Floats, of_feature: list[int], groups: int) -> float:
    """Log density, summed over all states: narrow or broad, touched groups, width, share, and each moved feature."""
    by_width = [
        [
            student(column, COVARIANCE + width**2 * (UNKNOWN_COMMON + (1.0 - UNKNOWN_COMMON) * np.eye(S)))
            for width in (0.0, *UNKNOWN_WIDTHS)
        ]
        for column in residual.T
    ]
    total = -inf
    for in_mode, in_group in ((1.0 - UNKNOWN_BROAD, UNKNOWN_IN_GROUP), (UNKNOWN_BROAD, BROAD_IN_GROUP)):
        for touched in product((False, True), repeat=groups):
            prior = log(in_mode)
            for group, is_touched in enumerate(touched):
                own = [by_width[f] for f, of in enumerate(of_feature) if of == group]
                prior += log(in_group) + _moved(own) if is_touched else log(1.0 - in_group) + sum(d[0] for d in own)
            total = float(np.logaddexp(total, prior))
    return total


def _moved(own: list[list[float]]) -> float:
    """Log density of the features of a group, mean over widths and shares, sum over the features that are moved."""
    states = [
        sum(
            log(share) + d[width] if is_moved else log(1.0 - share) + d[0]
            for d, is_moved in zip(own, moved, strict=True)
        )
        for width, share in product(range(1, len(UNKNOWN_WIDTHS) + 1), UNKNOWN_SHARES)
        for moved in product((False, True), repeat=len(own))
    ]
    return float(np.logaddexp.reduce(states)) - log(len(UNKNOWN_WIDTHS) * len(UNKNOWN_SHARES))


@pytest.mark.parametrize("scale", [0.5, 4.0, 30.0])
def test_the_sum_over_unknown_effects_is_that_of_all_its_states(scale: float) -> None:
    """Four features in two groups: by brute force, whether features deviate or not."""
    residual = scale * np.random.default_rng(1).standard_normal((S, 4))
    of_feature = [0, 0, 1, 0]
    groups = Groups(np.array(of_feature), 2, np.ones(4, dtype=np.bool_))
    assert densities(residual, groups).either == pytest.approx([summed_by_hand(residual, of_feature, 2)])


def test_nothing_unknown_is_one_of_the_states() -> None:
    residual = np.zeros((S, 2))
    result = densities(residual, one_group(2))
    assert result.either > result.without_unknown + log_no_unknown(1)
    assert np.exp(log_no_unknown(1)) == pytest.approx(0.99 * 0.995 + 0.01 * 0.7)
    assert log_no_unknown(20) < log_no_unknown(10) < 0.0


def test_points_that_leave_a_feature_alone_share_its_density() -> None:
    """The density of a point is the same whether other points come before it or not."""
    residual = np.random.default_rng(2).standard_normal((S, 2))
    mean = np.zeros((3, S, 2))
    mean[1] = 2.0
    covariance = np.tile(COVARIANCE, (2, 1, 1))
    none = np.zeros_like(mean)
    together = log_densities(residual - mean, mean, none, 0.1 * mean, covariance, one_group(2))
    for point in range(3):
        row = slice(point, point + 1)
        alone = log_densities(residual - mean[row], mean[row], none[row], 0.1 * mean[row], covariance, one_group(2))
        assert together.without_unknown[row] == pytest.approx(alone.without_unknown)
        assert together.either[row] == pytest.approx(alone.either)
