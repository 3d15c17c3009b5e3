"""The attitude filter as an object: the bits of the service, by single samples and by arrays."""

import math
from typing import Any

import numpy as np
import pytest
from hand_motion import hand_motion

import gyrodrift
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.values.errors import UsageError
from gyrodrift.values.sample import Inertial


def test_a_batch_has_the_bits_of_the_service_also_in_parts() -> None:
    motion = hand_motion(20.0)
    temp_c = 20.0 + motion.t_s / 10.0
    run, expected = FilterRun(RESTLEVEL, RESTLEVEL.params(), "3"), []
    columns = (motion.t_s, motion.gyro_dps, motion.accel_mps2, temp_c)
    for t_s, gyro, accel, warm_c in zip(*(column.tolist() for column in columns), strict=True):
        run.step(t_s, gyro[2], Inertial(*gyro, *accel), temp_c=warm_c)
        expected.append(run.state.yaw_deg)
    whole, parts = gyrodrift.AttitudeFilter(), gyrodrift.AttitudeFilter()
    estimates = whole.update_batch(motion.gyro_dps, motion.accel_mps2, motion.t_s, temp_c)
    cut = [
        parts.update_batch(motion.gyro_dps[part], motion.accel_mps2[part], motion.t_s[part], temp_c[part])
        for part in (slice(0, 777), slice(777, None))
    ]
    assert estimates.yaw_deg.tolist() == expected
    assert np.concatenate([part.yaw_deg for part in cut]).tolist() == expected
    assert estimates.is_accepted.all()


def test_an_estimate_has_heading_tilt_and_biases_and_a_table() -> None:
    motion = hand_motion(20.0, bias_dps=(0.3, -0.2, 0.5))
    estimates = gyrodrift.AttitudeFilter().update_batch(motion.gyro_dps, motion.accel_mps2, motion.t_s)
    assert estimates.bias_z_dps[-1] == pytest.approx(0.5, abs=0.1)
    assert abs(estimates.yaw_deg[-1] - motion.heading_deg[-1]) < 3.0
    assert set(estimates.columns()) == set(gyrodrift.AttitudeEstimate._fields)


def test_a_sample_without_acceleration_is_taken_and_one_without_a_rate_is_not() -> None:
    attitude = gyrodrift.AttitudeFilter()
    assert attitude.update_at((0.0, 0.0, 1.0), t_s=0.0).is_accepted
    assert not attitude.update_at((math.nan, 0.0, 1.0), (0.0, 0.0, 9.81), t_s=0.1).is_accepted


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ({"up": "+z", "forward": "-z"}, "expected two different axes"),
        ({"windows": 1.0}, "did you mean window_s"),
        ({"window_s": -1.0}, "window_s"),
    ],
)
def test_a_wrong_parameter_is_told(words: dict[str, Any], message: str) -> None:
    with pytest.raises(UsageError, match=message.replace("?", r"\?")):
        gyrodrift.AttitudeFilter(**words)


@pytest.mark.parametrize(
    ("gyro", "accel", "times", "message"),
    [
        ([[1.0, 2.0]], [[0.0, 0.0, 9.8]], [0.0], r"gyro_dps has the shape \(1, 2\); expected \(n, 3\)"),
        ([[1.0, 2.0, 3.0]], [[0.0, 0.0, 9.8]], [0.0, 1.0], "2 times, 1 rates and 1 accelerations"),
        ([["a", 2.0, 3.0]], [[0.0, 0.0, 9.8]], [0.0], "gyro_dps is no array of numbers"),
    ],
)
def test_arrays_of_another_shape_are_refused(gyro: Any, accel: Any, times: Any, message: str) -> None:
    with pytest.raises(UsageError, match=message):
        gyrodrift.AttitudeFilter().update_batch(gyro, accel, times)
