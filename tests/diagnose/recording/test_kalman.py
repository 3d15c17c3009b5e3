"""Filter and backward sampler, against the posterior of all states at once by plain linear algebra."""

from functools import cache
from typing import NamedTuple

import numpy as np
import pytest

from gyrodrift.diagnose.recording.kalman import NOT_MEASURED, STATES, filter_forward, sample_backward
from gyrodrift.values.arrays import Floats

COUNT, PERIOD_S = 40, 0.05
START_VARIANCES = np.array([1.0, 1e4, 1e6, 1.0])
"""Variances of angle, rate, acceleration and bias before the first sample."""

DRAWS = 4000


class Case(NamedTuple):
    """Input of the filter."""

    angles: tuple[Floats, Floats]
    edges: tuple[Floats, Floats]
    rates: tuple[Floats, Floats]
    rest_variance: Floats
    drives: tuple[Floats, Floats]


@cache
def case() -> Case:
    """Numbers at random; some samples lack their angle, most have no edge, and at the end it rests."""
    dice = np.random.default_rng(5)
    angle_deg = np.cumsum(dice.normal(2.0, 1.0, COUNT))
    sample = np.arange(COUNT)
    return Case(
        (angle_deg, np.where(sample % 7 == 3, NOT_MEASURED, dice.uniform(0.01, 0.1, COUNT))),
        (angle_deg - 0.5, np.where(sample % 5 == 2, 0.02, NOT_MEASURED)),
        (dice.normal(40.0, 5.0, COUNT), np.where(sample % 11 == 4, NOT_MEASURED, 0.3)),
        np.where(sample > 35, 1e-2, NOT_MEASURED),
        (dice.uniform(50.0, 5000.0, COUNT), dice.uniform(0.01, 1.0, COUNT)),
    )


@cache
def dense() -> tuple[Floats, Floats]:
    """(n, 2) mean and (2n, 2n) covariance of angles and rates, by least squares over all states of all samples."""
    angles, edges, rates, rest_variance, drives = case()
    t = PERIOD_S
    step = np.array([[1.0, t, 0.5 * t * t, 0.0], [0.0, 1.0, t, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]])
    rows: list[Floats] = []
    values: list[float] = []

    def say(weights: Floats, value: float, sigma: float) -> None:
        rows.append(weights / sigma)
        values.append(value / sigma)

    def of(sample: int, weights: list[float]) -> Floats:
        row = np.zeros((COUNT, STATES))
        row[sample] = weights
        return row.reshape(-1)

    for state in range(STATES):
        start = [0.0] * STATES
        start[state] = 1.0
        say(of(0, start), angles[0][0] if state == 0 else 0.0, float(np.sqrt(START_VARIANCES[state])))
    for sample in range(1, COUNT):
        # What white jerk does to acceleration, rate and angle within t: integrals of the products of 1, s and s²/2.
        driven = np.array([[t**5 / 20, t**4 / 8, t**3 / 6], [t**4 / 8, t**3 / 3, t**2 / 2], [t**3 / 6, t**2 / 2, t]])
        noise = np.zeros((STATES, STATES))
        noise[:3, :3], noise[3, 3] = drives[0][sample] * driven, drives[1][sample] * t
        whitened = np.linalg.inv(np.linalg.cholesky(noise))
        row = np.zeros((STATES, COUNT, STATES))
        row[:, sample], row[:, sample - 1] = whitened, -whitened @ step
        for item in row.reshape(STATES, -1):
            say(item, 0.0, 1.0)
    for (measured, variance), weights in (
        (angles, [1.0, 0.0, 0.0, 0.0]),
        (edges, [1.0, -0.5 * t, 0.0, 0.0]),
        (rates, [0.0, 1.0, 0.0, 1.0]),
        ((np.zeros(COUNT), rest_variance), [0.0, 1.0, 0.0, 0.0]),
    ):
        for index in np.flatnonzero(variance > 0.0).tolist():
            say(of(index, weights), float(measured[index]), float(np.sqrt(variance[index])))
    q, r = np.linalg.qr(np.array(rows))
    mean = np.linalg.solve(r, q.T @ np.array(values)).reshape(COUNT, STATES)[:, :2]
    inverse = np.linalg.inv(r)
    covariance = (inverse @ inverse.T).reshape(COUNT, STATES, COUNT, STATES)[:, :2, :, :2]
    return mean, covariance.reshape(2 * COUNT, 2 * COUNT)


def test_the_mean_is_that_of_all_measurements_at_once() -> None:
    """Angle and rate at each sample, whatever is missing where."""
    path = sample_backward(PERIOD_S, filter_forward(PERIOD_S, *case()), np.zeros((1, STATES)), False)
    assert path == pytest.approx(dense()[0], abs=1e-6)


def test_draws_scatter_as_the_posterior_does() -> None:
    states, dice = filter_forward(PERIOD_S, *case()), np.random.default_rng(6)
    mean, covariance = dense()
    drawn = np.array(
        [
            sample_backward(PERIOD_S, states, dice.standard_normal((COUNT, STATES)), True).reshape(-1)
            for _ in range(DRAWS)
        ]
    )
    sigma = np.sqrt(np.diag(covariance))
    away = (drawn - mean.reshape(-1)) / sigma
    # The standard error is 1/√4000 of a mean, 1/√8000 of a standard deviation, 1/√4000 and less of a correlation.
    assert np.abs(away.mean(axis=0)).max() < 4.5 / np.sqrt(DRAWS)
    assert np.abs(away.std(axis=0) - 1.0).max() < 4.5 / np.sqrt(2.0 * DRAWS)
    assert np.abs(away.T @ away / DRAWS - covariance / np.outer(sigma, sigma)).max() < 6.0 / np.sqrt(DRAWS)


def test_what_is_measured_exactly_is_kept() -> None:
    """Angles of a straight line without noise are the path, and their slope its rate."""
    line_deg: Floats = 3.0 + 20.0 * PERIOD_S * np.arange(COUNT, dtype=np.float64)
    none = (np.zeros(COUNT), np.full(COUNT, NOT_MEASURED))
    drives = np.full(COUNT, 1e-6), np.full(COUNT, 1e-6)
    states = filter_forward(PERIOD_S, (line_deg, np.full(COUNT, 1e-8)), none, none, none[1], drives)
    path = sample_backward(PERIOD_S, states, np.zeros((1, STATES)), False)
    assert path[:, 0] == pytest.approx(line_deg, abs=1e-4)
    assert path[:, 1] == pytest.approx(20.0, abs=1e-3)
