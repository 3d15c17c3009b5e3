"""How well an encoder knows each block: badly where its rounding does not average out."""

import numpy as np
import pytest

from gyrodrift.diagnose.features.block_means import slopes
from gyrodrift.diagnose.features.design_matrix import KNOWN_DPS, root_weights_of
from gyrodrift.diagnose.recording.motion import ReplayedMotion
from gyrodrift.values.arrays import Floats

RATE_HZ, BLOCK = 50.0, 50
COARSE_DEG, FINE_DEG = 360.0 / 512.0, 360.0 / 36_000.0
PARTS = {"rest": 0.0, "creep": 0.3, "turn": 57.0, "whole_counts": COARSE_DEG * RATE_HZ * 1.013}
PART_S = 40.0


def motion() -> ReplayedMotion:
    """Each of PARTS for PART_S."""
    rate_dps: Floats = np.repeat(list(PARTS.values()), round(PART_S * RATE_HZ)).astype(np.float64)
    angle_deg = 0.1 + np.cumsum(rate_dps) / RATE_HZ
    return ReplayedMotion(1.0 / RATE_HZ, angle_deg, rate_dps, np.full(len(rate_dps), 20.0), 0.0)


def of_parts(values: Floats) -> dict[str, Floats]:
    """Blocks of each part, but for the first and the last ones."""
    return {name: part[3:-3] for name, part in zip(PARTS, np.split(values, len(PARTS)), strict=True)}


def test_coarse_counts_are_believed_where_their_rounding_averages_out() -> None:
    roots = of_parts(root_weights_of(motion(), COARSE_DEG, BLOCK, 0.05))
    assert (roots["rest"] == 1.0).all()
    assert roots["turn"].min() > 0.4
    assert roots["creep"].max() < 0.2
    assert np.median(roots["whole_counts"]) < 0.2


def test_fine_counts_are_believed_everywhere() -> None:
    assert root_weights_of(motion(), FINE_DEG, BLOCK, 0.0).min() > 0.9
    assert (root_weights_of(motion(), 0.0, BLOCK, 0.0) == 1.0).all()


def test_a_noisy_gyro_makes_all_blocks_alike() -> None:
    quiet, noisy = (root_weights_of(motion(), COARSE_DEG, BLOCK, sigma_dps) for sigma_dps in (0.0, 5.0))
    assert (noisy > quiet - 1e-9).all()
    assert noisy.min() > 0.7


@pytest.mark.parametrize("part", ["creep", "whole_counts"])
def test_a_block_is_believed_as_its_rounding_says(part: str) -> None:
    """Weights of known over known and rounding, on average, whose size is found here by phases drawn at random."""
    moved, rng = motion(), np.random.default_rng(4)
    squares = []
    for first_deg in rng.uniform(0.0, COARSE_DEG, 200):
        angle_deg = moved.angle_deg + first_deg
        off_deg = angle_deg - COARSE_DEG * np.rint(angle_deg / COARSE_DEG)
        squares.append(np.square(of_parts(slopes(off_deg, moved.period_s, BLOCK))[part]).mean())
    weight = np.square(of_parts(root_weights_of(moved, COARSE_DEG, BLOCK, 0.0))[part])
    assert 1.0 / np.mean(1.0 / weight) == pytest.approx(KNOWN_DPS**2 / np.mean(squares), rel=0.5)
