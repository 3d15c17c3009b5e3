"""Cost of candidates: the same bits for any number of threads, in memory and from a file."""

import math
import os
from dataclasses import replace
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest

from gyrodrift.evaluation.cost import BLOCK, Cost, Scores
from gyrodrift.evaluation.kernels import hdr as kernel
from gyrodrift.evaluation.reference import Reference
from gyrodrift.evaluation.score import Score
from gyrodrift.values.arrays import Floats

PLAIN = (0.0, 0.0, 1.0, 0.0, 0.0)
"""No bias and no low-pass: yaw is the sum of rate times step."""


def reference(name: str, samples: int) -> Reference:
    """A noisy rest with a reference at most samples."""
    dice = np.random.default_rng(samples)
    dt_s = np.r_[0.0, dice.uniform(0.009, 0.011, samples - 1)]
    reference_deg = np.where(dice.random(samples) < 0.2, nan, 0.0)
    reference_deg[0] = 0.0
    return Reference(name, dt_s, dice.normal(0.1, 0.2, samples), reference_deg, float(np.sum(dt_s)) / 60.0)


def candidates(count: int) -> Floats:
    dice = np.random.default_rng(count)
    return np.column_stack([10.0 ** dice.uniform(-6, -1, count), *dice.uniform(0.05, 2.0, (4, count))])


@pytest.fixture
def references() -> list[Reference]:
    return [reference("short", 300), reference("long", 2000), reference("middle", 900)]


def test_scores_are_kernel_sums_over_the_number_of_samples(references: list[Reference]) -> None:
    params = candidates(11)
    with Cost(references) as cost:
        scores = cost.cost(params)
    for row, session in enumerate(references):
        squares, absolutes, worst, count = kernel.sums(session.dt_s, session.rate_dps, session.reference_deg, params)
        np.testing.assert_array_equal(scores.mean_squares[row], squares / count)
        np.testing.assert_array_equal(scores.mean_absolutes[row], absolutes / count)
        np.testing.assert_array_equal(scores.worst[row], worst)


def test_scores_computed_by_hand() -> None:
    """Yaw at 1 deg/s for 3 s against a reference of 0 with a missing value."""
    plain = Reference("hand", np.array([0.0, 1.0, 1.0, 1.0]), np.ones(4), np.array([0.0, 0.0, nan, 0.0]), 0.05)
    with Cost([plain, replace(plain, reference_deg=np.array([0.0, 1.0, 2.0, 3.0]))]) as cost:
        scores = cost.cost(np.array([PLAIN]))
    assert scores.mean_squares.tolist() == [[10.0 / 3.0], [0.0]]
    assert scores.mean_absolutes.tolist() == [[4.0 / 3.0], [0.0]]
    assert scores.worst.tolist() == [[3.0], [0.0]]
    assert scores.pi.tolist() == [5.0 / 3.0]


@pytest.mark.parametrize("threads", [2, 5])
def test_the_number_of_threads_changes_no_bit(references: list[Reference], threads: int) -> None:
    """The order and the grouping of the candidates change no bit either."""
    params = candidates(BLOCK + 37)
    with Cost(references, threads=1) as single, Cost(references, threads=threads) as several:
        expected = single.pi(params)
        np.testing.assert_array_equal(several.pi(params), expected)
        np.testing.assert_array_equal(several.pi(params[::-1])[::-1], expected)
        np.testing.assert_array_equal([several.pi(row[np.newaxis])[0] for row in params[:9]], expected[:9])


def test_a_candidate_alone_has_the_same_cost_as_in_a_group() -> None:
    """Sums over sessions keep their order."""
    params = candidates(16)
    with Cost([reference("short", 40 + samples) for samples in range(23)]) as cost:
        np.testing.assert_array_equal([cost.pi(row[np.newaxis])[0] for row in params], cost.pi(params))


def test_references_beyond_the_memory_limit_are_read_from_a_file(references: list[Reference]) -> None:
    params = candidates(9)
    with Cost(references) as in_memory, Cost(references, memory_bytes=1000) as in_file:
        for ours, given in zip(in_file.references, references, strict=True):
            for name in ("dt_s", "rate_dps", "reference_deg"):
                np.testing.assert_array_equal(getattr(ours, name), getattr(given, name))
                assert not getattr(ours, name).flags.writeable
        assert in_memory.references == tuple(references)
        np.testing.assert_array_equal(in_file.pi(params), in_memory.pi(params))


def test_the_file_has_no_name(references: list[Reference], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A killed run leaves nothing behind."""
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    with Cost(references, memory_bytes=0):
        assert not list(tmp_path.iterdir())
        assert str(tmp_path) in Path("/proc/self/maps").read_text()


def test_evaluations_count_candidates(references: list[Reference]) -> None:
    """Sessions and calls do not count."""
    with Cost(references) as cost:
        cost.cost(candidates(10))
        cost.pi(candidates(3))
        cost.pi(np.empty((0, 5)))
        assert cost.evaluations == 13


def test_a_candidate_that_overflows_costs_inf() -> None:
    """Scores of other sessions stay finite."""
    overflowing = Reference("overflow", np.array([0.0, 1.0, 1e10]), np.array([0.0, 1.0, 1e300]), np.zeros(3), 1.0)
    with Cost([overflowing, reference("short", 50)]) as cost:
        scores = cost.cost(np.array([PLAIN, PLAIN]))
    assert scores.pi.tolist() == [inf, inf]
    assert math.isfinite(scores.mean_squares[1, 0])


def test_a_mean_that_overflows_is_inf() -> None:
    """The scores of the sessions are finite, and no warning is given."""
    far = Reference("far", np.array([0.0, 1.0]), np.array([0.0, 1.3e154]), np.zeros(2), 1.0)
    with Cost([far] * 3) as cost:
        scores = cost.cost(np.array([PLAIN]))
    assert np.isfinite(scores.mean_squares).all()
    assert scores.pi.tolist() == [inf]


def test_there_are_as_many_threads_as_processors(references: list[Reference]) -> None:
    with Cost(references) as cost:
        assert cost.threads == len(os.sched_getaffinity(0))


def test_an_error_in_a_thread_is_raised_by_the_call(references: list[Reference]) -> None:
    with Cost([replace(references[0], dt_s=np.zeros(2))]) as cost, pytest.raises(ValueError, match="one length"):
        cost.cost(candidates(3))


def test_an_absurd_sigma_costs_more_than_its_error() -> None:
    """The cost is PI where sigma fits the errors or is not stated, and grows with a sigma that is far too large."""
    errors = np.array([[4.0, 4.0, 4.0]])
    loss = Scores(errors, np.sqrt(errors), errors, np.array([[np.nan, 1.1, 300.0]])).loss
    assert loss.tolist() == [4.0, 4.0, pytest.approx(np.pi * 9e4)]


def test_a_score_is_read_from_the_table() -> None:
    squares, absolutes, worst = np.array([[1.0, 4.0], [9.0, 16.0]]), np.array([[1.0, 2.0], [3.0, 4.0]]), np.ones((2, 2))
    scores = Scores(squares, absolutes, worst, np.full((2, 2), np.nan))
    assert scores.score(1, 0, 12.0) == Score(e_deg=3.0, ne=0.25, pi_deg2=9.0, worst_deg=1.0)
    assert scores.pi.tolist() == [5.0, 10.0]
