"""The encoder angle beside yaw: aligned at the first sample and at each zero, and unwrapped."""

from math import isnan, nan

import pytest

from gyrodrift.service.reference import EncoderReference


def test_an_encoder_is_aligned_at_its_first_sample_and_at_each_zero() -> None:
    encoder = EncoderReference()
    assert isnan(encoder.angle_deg(nan, 1.0))
    assert encoder.angle_deg(202.0, 3.0) == 3.0
    assert encoder.angle_deg(212.0, 12.5) == 13.0
    encoder.align()
    assert encoder.angle_deg(222.0, 0.0) == 0.0
    assert encoder.angle_deg(220.0, -1.0) == -2.0


def test_an_encoder_that_wraps_is_unwrapped() -> None:
    """Four turns either way, from 0 to 360 and from -180 to 180."""
    for low_deg in (0.0, -180.0):
        for way in (1.0, -1.0):
            encoder = EncoderReference()
            true_deg = [way * 7.0 * n for n in range(206)]
            angles = [encoder.angle_deg((150.0 + deg - low_deg) % 360.0 + low_deg, deg) for deg in true_deg]
            assert angles == pytest.approx(true_deg)


def test_an_encoder_that_counts_turns_is_taken_as_it_is() -> None:
    """A step of more than half a turn is then a gap in the samples."""
    encoder = EncoderReference()
    assert [encoder.angle_deg(deg, deg) for deg in (0.0, 170.0, 340.0, 500.0, 900.0)] == [
        0.0,
        170.0,
        340.0,
        500.0,
        900.0,
    ]
