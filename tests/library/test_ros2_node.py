"""The ROS 2 node of the docs: what it publishes, without rclpy."""

import importlib.util
import math
import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from gyrodrift import Estimate
from gyrodrift.values.sample import Inertial, Sample

NODE = Path(__file__).parents[2] / "docs" / "ros2_node.py"


@pytest.fixture(scope="module")
def node() -> Any:
    spec = importlib.util.spec_from_file_location("ros2_node", NODE)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def message() -> SimpleNamespace:
    return SimpleNamespace(orientation=SimpleNamespace(), angular_velocity=SimpleNamespace())


def test_a_quarter_turn_to_the_left(node: Any) -> None:
    estimate = Estimate(90.0, 2.0, 0.5, 0.1, 1.0, 1.0, is_accepted=True)
    filled = node.fill(message(), node.fields_of(estimate, 10.5))
    assert (filled.orientation.z, filled.orientation.w) == pytest.approx((math.sqrt(0.5), math.sqrt(0.5)))
    assert filled.angular_velocity.z == pytest.approx(math.radians(10.0))
    assert filled.orientation_covariance[8] == pytest.approx(math.radians(2.0) ** 2)
    assert filled.angular_velocity_covariance[8] == pytest.approx(math.radians(0.1) ** 2)
    assert filled.linear_acceleration_covariance[0] == -1.0


def test_a_filter_that_states_no_certainty_has_a_large_variance(node: Any) -> None:
    estimate = Estimate(0.0, math.nan, 0.0, math.nan, math.nan, math.nan, is_accepted=True)
    assert node.fields_of(estimate, 0.0).orientation_covariance[8] == node.UNKNOWN


def test_a_device_with_three_axes_has_an_attitude_and_accelerations(node: Any) -> None:
    """The node goes over to three axes with the first accelerations, and stays there while they are missing."""
    corrector, imu = node.Corrector(), message()
    imu.linear_acceleration = SimpleNamespace()
    lean = math.radians(20.0)
    forces = (0.0, 9.81 * math.sin(lean), 9.81 * math.cos(lean))
    for seq in range(300):
        inertial = Inertial(0.1, 0.2, 0.3, *forces)
        fields = corrector.take(Sample(seq, seq / 100.0, 0.0, 0.3, inertial=inertial))
    node.fill(imu, fields)
    assert 2.0 * math.atan2(imu.orientation.x, imu.orientation.w) == pytest.approx(lean, abs=0.02)
    assert imu.linear_acceleration.y == forces[1]
    assert abs(imu.angular_velocity.y) < math.radians(0.05)
    assert 0.0 < fields.orientation_covariance[0] < 0.01
    assert fields.acceleration_covariance[0] == 0.0
    rates = Inertial(0.1, 0.2, 0.3)
    later = corrector.take(Sample(300, 3.0, 0.0, 0.3, inertial=rates))
    assert later.accelerations_mps2 is None
    assert later.acceleration_covariance[0] == -1.0
    assert later.orientation[0] == pytest.approx(imu.orientation.x, abs=0.01)


def test_a_device_with_one_axis_is_level(node: Any) -> None:
    corrector = node.Corrector()
    fields = corrector.take(Sample(0, 0.0, 0.0, 0.3, inertial=Inertial(1.0, 1.0, 0.3)))
    assert fields.orientation == (0.0, 0.0, 0.0, 1.0)
    assert fields.orientation_covariance[0] == node.UNKNOWN
    assert corrector.take(Sample(1, -1.0, 0.0, 0.3)) is None


@pytest.mark.skipif(importlib.util.find_spec("rclpy") is not None, reason="ROS 2 is there: the node would run")
def test_without_ros_2_it_says_what_is_missing() -> None:
    done = subprocess.run([sys.executable, str(NODE)], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ROS 2" in done.stderr
    assert "Traceback" not in done.stderr
