"""Axes of an accelerometer that are not those of the gyro are told while the device runs."""

from typing import Any

import numpy as np
import pytest
from hand_motion import BIAS_DPS, HandMotion, hand_motion

from gyrodrift.columns.accel_axes import AccelerationAxesCheck
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.session.session import Session
from gyrodrift.values.sample import Inertial, Sample


@pytest.fixture(scope="module")
def motion() -> HandMotion:
    return hand_motion(60.0, tilt_deg=15.0, yaw_deg=20.0, bias_dps=BIAS_DPS)


def told_of(motion: HandMotion, order: tuple[int, int, int], signs: tuple[float, float, float]) -> list[dict[str, Any]]:
    """Fields of the events of a stream of batches whose accelerations have these axes."""
    check, accel_mps2 = AccelerationAxesCheck("text"), motion.accel_mps2[:, order] * signs
    samples = [
        Sample(index, t_s, 0.0, gyro_dps[2], inertial=Inertial(*gyro_dps, *force_mps2))
        for index, (t_s, gyro_dps, force_mps2) in enumerate(
            zip(motion.t_s.tolist(), motion.gyro_dps.tolist(), accel_mps2.tolist(), strict=True)
        )
    ]
    events = [check.take(samples[index : index + 7]) for index in range(0, len(samples), 7)]
    return [fields for fields in events if fields is not None]


def test_the_axes_of_the_gyro_are_right(motion: HandMotion) -> None:
    assert told_of(motion, (0, 1, 2), (1.0, 1.0, 1.0)) == []


@pytest.mark.parametrize(
    ("order", "signs", "spec"),
    [
        ((1, 0, 2), (1.0, 1.0, 1.0), "ay, ax, az"),
        ((0, 1, 2), (1.0, -1.0, 1.0), "ax, ay:-, az"),
        ((1, 0, 2), (-1.0, 1.0, 1.0), "ay:-, ax, az"),
        ((1, 2, 0), (1.0, 1.0, 1.0), "ay, az, ax"),
    ],
)
def test_other_axes_are_told_once_with_the_columns_that_mend_them(
    motion: HandMotion, order: tuple[int, int, int], signs: tuple[float, float, float], spec: str
) -> None:
    (fields,) = told_of(motion, order, signs)
    assert (
        fields["hint"] == f"in --columns, name the three columns of the acceleration, in the frame of the gyro: {spec}"
    )
    session = Session(
        "hand",
        motion.t_s,
        motion.gyro_dps[:, 2],
        gyro_dps=motion.gyro_dps,
        accel_mps2=motion.accel_mps2[:, order] * signs,
    )
    recorded = SessionFacts(session).axes_agreement
    assert recorded is not None
    assert recorded.spec == spec


def test_an_accelerometer_that_says_nothing_gives_no_judgment(motion: HandMotion) -> None:
    assert told_of(motion, (0, 1, 2), (np.nan, np.nan, np.nan)) == []
    assert told_of(motion, (0, 1, 2), (0.0, 0.0, 0.0)) == []
