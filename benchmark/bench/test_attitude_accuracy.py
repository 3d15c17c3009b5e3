"""Accuracy of the attitude filter on a board: what fewer hypotheses and floats cost on simulated parts and motions."""

import numpy as np
import pytest
from c_attitude_support import SIGMA, YAW, Q, samples
from c_filter_support import CFilter, CFilters
from six_axis_motions import MOTIONS
from six_axis_sensors import Recorded
from six_axis_support import heading_errors_deg, record

from bench.harness import show

pytestmark = pytest.mark.timeout(1800)

NUMBERS = (6, 4, 3, 2)
SEEDS = (11, 12, 13)
FLOAT_S = 1800.0
LEAST_DEG = 0.01
"""Errors and sigmas below it count as this."""


def mean_error_deg(library: CFilter, recorded: Recorded) -> float:
    """Mean absolute heading error."""
    rows = library.run(recorded.t_s, samples(recorded.gyro_dps, recorded.accel_mps2)).rows
    return max(LEAST_DEG, float(np.abs(heading_errors_deg(rows[:, Q], recorded.attitude)).mean()))


def test_fewer_hypotheses_of_three_axes_cost_accuracy() -> None:
    """Six are those of Python."""
    filters, rows = CFilters(), []
    recordings = [record(name, seed) for name in MOTIONS for seed in SEEDS]
    means: dict[int, float] = {}
    for number in NUMBERS:
        library = filters.get("filter_attitude.c", "float", f"-DGD_ATTITUDE_HYPOTHESES={number}")
        errors = np.array([mean_error_deg(library, recorded) for recorded in recordings])
        means[number] = float(np.exp(np.log(errors).mean()))
        sizes = f"{library.state_bytes} bytes"
        rows.append((f"{number} hypotheses", f"{means[number]:.3f} deg, worst {errors.max():.1f} deg, {sizes}"))
    show(f"geometric mean of mean absolute heading errors of {len(recordings)} recordings", rows)
    assert means[6] < 1.1 * means[2]


def test_floats_of_three_axes_cost_little() -> None:
    """Yaw in float against double, as degrees and as a share of its sigma."""
    filters = CFilters()
    single, double = (filters.get("filter_attitude.c", real) for real in ("float", "double"))
    rows, shares = [], []
    for name in MOTIONS:
        recorded = record(name, 2, FLOAT_S)
        inputs = samples(recorded.gyro_dps, recorded.accel_mps2)
        whole = double.run(recorded.t_s, inputs).rows
        off_deg = np.abs(single.run(recorded.t_s, inputs).rows[:, YAW] - whole[:, YAW])
        shares.append(float((off_deg / np.maximum(whole[:, SIGMA], 1.0)).max()))
        sigma_deg = whole[-1, SIGMA]
        rows.append((name, f"{off_deg.max():.4f} deg, {shares[-1]:.1e} of sigma, which ends at {sigma_deg:.0f} deg"))
    show(f"float against double, {FLOAT_S:.0f} s of each motion", rows)
    assert max(shares) < 0.01
