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


@pytest.mark.skipif(importlib.util.find_spec("rclpy") is not None, reason="ROS 2 is there: the node would run")
def test_without_ros_2_it_says_what_is_missing() -> None:
    done = subprocess.run([sys.executable, str(NODE)], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "ROS 2" in done.stderr
    assert "Traceback" not in done.stderr
