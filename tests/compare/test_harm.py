"""Restlevel at its defaults against plain integration and start calibration; most recordings begin in motion."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pytest
from recordings_support import Recordings

pytest.importorskip("numba", reason="comparing needs the workstation extra")
from gyrodrift.compare.methods.registry import by_key
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.evaluation.score import score_of

pytestmark = [pytest.mark.xdist_group("restlevel_kernel"), pytest.mark.timeout(1800)]

METHODS = ("euler", "start", "restlevel")
HARM, FLOOR_DEG = 1.5, 0.5
"""A recording is harmed if E is above HARM times the better of both baselines, or FLOOR_DEG if that is larger."""

BY_KEY = by_key()


def errors_deg(paths: Sequence[Path]) -> dict[str, list[float]]:
    """Mean |yaw error| of each recording, by method."""
    e_deg: dict[str, list[float]] = {key: [] for key in METHODS}
    for path in paths:
        loaded = load_with_reference(Source(path))
        for key in METHODS:
            yaw_deg = BY_KEY[key].run(loaded.t_s, loaded.reference.rate_dps, BY_KEY[key].defaults)
            e_deg[key].append(score_of(loaded.reference, yaw_deg).e_deg)
    return e_deg


@pytest.mark.parametrize(
    ("pattern", "harm_most", "allowance"), [("benchy_*", 0.1, 1.05), ("rasteiro_*", 0.1, 1.0), ("smartloc_*", 0.0, 1.0)]
)
def test_it_seldom_harms(pattern: str, harm_most: float, allowance: float, recordings: Recordings) -> None:
    """Sets: a hovering bench whose sensor subtracts its own bias, parts on a robot, and a car.

    The allowance of the bench covers its mean errors: 1.45 deg with the filter, 1.42 deg with plain integration.
    """
    assert_harm_is_rare(pattern, recordings.further(pattern), harm_most, allowance)


def test_it_harms_at_most_one_of_six_parts_that_a_robot_carries(recordings: Recordings) -> None:
    """Recordings in tests/data; with six recordings the mean error may be 5 % above plain integration."""
    assert_harm_is_rare("rasteiro_*", recordings.packed("rasteiro_*"), harm_most=1 / 6, allowance=1.05)


def assert_harm_is_rare(pattern: str, paths: Sequence[Path], harm_most: float, allowance: float = 1.0) -> None:
    """Assert a largest share of harmed recordings, and a largest mean error relative to plain integration."""
    e_deg = errors_deg(paths)
    own, plain, start = (np.array(e_deg[key]) for key in ("restlevel", "euler", "start"))
    harmed = own > HARM * np.maximum(np.minimum(plain, start), FLOOR_DEG)
    figures = "  ".join(
        f"{key} {np.median(errors):.2f} / {np.mean(errors):.2f} / {max(errors):.1f}" for key, errors in e_deg.items()
    )
    print(f"\n{pattern}: {len(own)} recordings, harm {harmed.mean():.2f}; median / mean / worst in deg: {figures}")
    assert harmed.mean() <= harm_most
    assert own.mean() <= allowance * plain.mean()
