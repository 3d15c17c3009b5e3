"""Regressors: what they are at each sample of a worked-out motion, and what their basis makes of them."""

import numpy as np
import pytest
from features_support import AT_REST, PERIOD_S, SECONDS, T_S, TRUE_DPS, TURNING, observed
from scipy.ndimage import minimum_filter1d

from gyrodrift.diagnose.features.block_means import block_means
from gyrodrift.diagnose.features.design_matrix import COLUMNS, TURN_ORDERS
from gyrodrift.diagnose.features.motion_terms import MotionTerms, motion_terms_of
from gyrodrift.diagnose.features.orthogonal import orthonormal, orthonormal_vectors
from gyrodrift.diagnose.features.regimes import lasting
from gyrodrift.diagnose.recording.motion import ReplayedMotion

A = np.tile([-1.0, -1.0, 1.0, 1.0], 4)
B = np.tile([1.0, -1.0, -1.0, 1.0], 4)


def terms() -> MotionTerms:
    """10 s at rest, 20 s at 90 deg/s, 10 s at −30 deg/s, 1 sample a second, while it warms by 1 °C in 10 s."""
    rate_dps = np.repeat([0.0, 90.0, -30.0], [10, 20, 10])
    motion = ReplayedMotion(1.0, np.cumsum(rate_dps), rate_dps, 20.0 + np.arange(40.0) / 10.0, powered_s=40.0)
    return motion_terms_of(motion, rate_dps)


def test_columns_are_taken_out_in_their_order() -> None:
    basis = orthonormal(np.column_stack([np.ones(16), A, A + B]), np.array([0.1, 0.2]), 1)
    assert basis.vectors == pytest.approx(np.column_stack([A, B]) / 4.0)


def test_thresholds_go_with_the_columns() -> None:
    """Coefficients 0.1 on a and 0.2 on a + b are 0.4 and 0.8 along a, of length 4, and 0.8 along b."""
    basis = orthonormal(np.column_stack([np.ones(16), A, A + B]), np.array([0.1, 0.2]), 1)
    assert basis.thresholds == pytest.approx([np.hypot(0.4, 0.8), 0.8])


def test_a_column_that_says_nothing_new_is_left_out() -> None:
    columns = np.column_stack([np.ones(16), A, 3.0 * A - 2.0, np.zeros(16)])
    assert np.all(orthonormal(columns, np.ones(3), 1).vectors[:, 1:] == 0.0)
    assert np.linalg.norm(orthonormal_vectors(columns), axis=0) == pytest.approx([1.0, 1.0, 0.0, 0.0])


@pytest.mark.parametrize("rows", [16, 4000])
def test_a_column_that_says_nothing_new_turns_none_behind_it(rows: int) -> None:
    rng = np.random.default_rng(7)
    first, last = np.tile(A, rows // 16), rng.standard_normal(rows)
    noise = 1e-3 * rng.standard_normal((2, rows))
    item, second = (
        orthonormal(np.column_stack([np.ones(rows), first, 3.0 * first + away, last]), np.ones(3), 1).vectors
        for away in noise
    )
    assert not item[:, 1].any()
    assert item[:, 2] @ second[:, 2] == pytest.approx(1.0, abs=1e-12)
    assert item[:, 2] @ last / np.linalg.norm(last - last.mean()) > (0.7 if rows < 100 else 0.99)


def test_a_column_takes_two_rows() -> None:
    columns = np.random.default_rng(1).standard_normal((6, 5))
    basis = orthonormal(columns, np.ones(5), 0)
    assert np.linalg.norm(basis.vectors, axis=0) == pytest.approx([1.0, 1.0, 1.0, 0.0, 0.0])
    assert np.linalg.norm(orthonormal_vectors(columns), axis=0) == pytest.approx([1.0, 1.0, 1.0, 0.0, 0.0])
    assert basis.thresholds[3:].tolist() == [0.0, 0.0]


def test_regimes_are_those_of_the_motion() -> None:
    """Rest, slow at 20 and 15 deg/s, fast at 90 and 80."""
    regimes = observed(TRUE_DPS).design.regimes
    assert regimes.at_rest[AT_REST].all()
    assert not regimes.at_rest[TURNING].any()
    assert regimes.is_slow[(T_S > 52.0) & (T_S < 79.0)].all()
    assert regimes.is_fast[(T_S > 83.0) & (T_S < 109.0)].all()
    assert not (regimes.is_slow & regimes.is_fast).any()
    assert np.count_nonzero(regimes.block_at_rest) == pytest.approx(50 + 29, abs=3)


def test_block_rates_are_those_of_the_motion() -> None:
    block_rate_dps = observed(TRUE_DPS).design.regimes.block_rate_dps
    true_dps = TRUE_DPS.reshape(SECONDS, 100).mean(axis=1)
    assert np.abs(block_rate_dps - true_dps).max() < 0.05


@pytest.mark.parametrize(
    ("name", "at_15_s", "at_35_s"),
    [
        ("rate", 90.0, -30.0),
        ("abs_rate", 90.0, 30.0),
        ("rate_squared", 8100.0, 900.0),
        ("rate_cubed", 729_000.0, -27_000.0),
        ("hinge_low", 30.0, 0.0),
        ("hinge_high", 0.0, 0.0),
        ("temperature", -0.45, 1.55),
        ("temperature_squared", 0.2025, 2.4025),
        ("temperature_rate", -40.5, -46.5),
        ("decay_fast", np.exp(-55.0 / 40.0), np.exp(-75.0 / 40.0)),
        ("decay_slow", np.exp(-55.0 / 160.0), np.exp(-75.0 / 160.0)),
        ("time", 15.0 / 39.0 - 0.5, 35.0 / 39.0 - 0.5),
        ("time_squared", (15.0 / 39.0 - 0.5) ** 2, (35.0 / 39.0 - 0.5) ** 2),
        ("turn_sine", 0.0, 0.0),  # 540 and 1620 degrees
        ("turn_cosine", -1.0, -1.0),
        ("turn_cosine_rate", -90.0, 30.0),
        ("half_turn_cosine", 1.0, 1.0),
        ("half_turn_cosine_rate", 90.0, -30.0),
        ("direction", 1.0, -1.0),
        ("moving", 1.0, 1.0),
        ("after_turn", np.exp(-0.5), -np.exp(-0.5)),
        ("total_angle", 1.5, 4.5),
        ("time_rate", 90.0 * (15.0 / 39.0 - 0.5), -30.0 * (35.0 / 39.0 - 0.5)),
    ],
)
def test_a_regressor_is_what_its_name_says(name: str, at_15_s: float, at_35_s: float) -> None:
    column = next(column for column in COLUMNS if column.name == name)
    assert column.compute(terms())[[15, 35]] == pytest.approx([at_15_s, at_35_s], abs=1e-9)


def test_reversals_and_accelerations_are_at_the_change() -> None:
    columns = {column.name: column.compute(terms()) for column in COLUMNS}
    assert columns["acceleration"][[20, 29, 30, 35]] == pytest.approx([0.0, -60.0, -60.0, 0.0])
    assert columns["reversal"][[20, 29, 30, 35]] == pytest.approx([0.0, -1.0, -1.0, 0.0])


def test_turns_of_three_to_eight_parts_have_their_vectors() -> None:
    """A sine and a cosine of each of six, orthonormal."""
    vectors = observed(TRUE_DPS).design.turn_basis
    assert vectors.shape == (SECONDS, 12)
    assert vectors.T @ vectors == pytest.approx(np.eye(12), abs=1e-12)


def test_the_grid_is_that_of_the_recording() -> None:
    design = observed(TRUE_DPS).design
    assert design.period_s == pytest.approx(PERIOD_S, rel=1e-6)
    assert (design.samples, design.block) == (SECONDS * 100, 100)


@pytest.mark.parametrize("points", [1, 4, 7, 100, 900])
def test_what_lasts_is_so_all_about(points: int) -> None:
    is_such = np.random.default_rng(points).random(600) < 0.995
    assert np.array_equal(lasting(is_such, points), minimum_filter1d(is_such.astype(int), points) == 1)


def test_many_rows_make_the_same_basis_as_few() -> None:
    """Householder's, by hand: signs are those of what each column says first."""
    rng = np.random.default_rng(3)
    columns = np.cumsum(rng.normal(size=(20_000, 5)), axis=0) + 10.0
    vectors, triangle = np.linalg.qr(columns)
    basis = orthonormal(columns, np.array([0.1, 0.2, 0.3]), 2)
    assert basis.vectors == pytest.approx((vectors * np.sign(np.diag(triangle)))[:, 2:], abs=1e-12)
    amounts = np.linalg.norm(triangle[2:, 2:] * [0.1, 0.2, 0.3], axis=1)
    assert basis.thresholds == pytest.approx(amounts, rel=1e-12)


def test_many_rows_tell_what_is_next_to_nothing_new() -> None:
    """A hundredth of a column is nothing; a twentieth is still something, and has its vector."""
    t = np.linspace(0.0, 2.0 * np.pi, 20_000, endpoint=False)
    columns = np.column_stack([np.sin(t), np.sin(t) + 1e-2 * np.cos(t), np.sin(t) + 5e-2 * np.cos(2.0 * t)])
    vectors = orthonormal(columns, np.ones(3), 0).vectors
    assert np.linalg.norm(vectors, axis=0) == pytest.approx([1.0, 0.0, 1.0])
    assert vectors[:, 2] @ np.cos(2.0 * t) / 100.0 == pytest.approx(1.0)


def test_bases_of_turns_are_sines_of_multiples_of_the_angle() -> None:
    design = observed(TRUE_DPS).design
    turn, rate_dps = np.deg2rad(design.motion.angle_deg), design.motion.rate_dps
    for order in range(TURN_ORDERS[0], TURN_ORDERS[1] + 1):
        for sine in (np.sin(order * turn), np.cos(order * turn)):
            alone = block_means(sine, design.block)
            assert design.turn_basis @ (design.turn_basis.T @ alone) == pytest.approx(alone, abs=1e-10)
            next_to = block_means(sine * rate_dps, design.block)
            assert design.turn_rate_basis @ (design.turn_rate_basis.T @ next_to) == pytest.approx(next_to, abs=1e-8)


def test_a_regressor_is_had_by_its_name() -> None:
    design = observed(TRUE_DPS).design
    assert design.regressor("rate") == pytest.approx(design.motion.rate_dps)
    assert design.regressor("total_angle") == pytest.approx(design.motion.angle_deg / 360.0)
