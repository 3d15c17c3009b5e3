"""Six positions and turns about each axis: what they determine, and what is refused."""

from collections.abc import Sequence
from dataclasses import replace
from datetime import UTC, datetime
from math import nan

import numpy as np
import pytest
from laid_board import (
    BIAS_DPS,
    GYRO_GAIN,
    OFFSET_MPS2,
    RATE_HZ,
    REST_S,
    SCALE,
    SIX_SIDES,
    WITH_TURNS,
    BoardRecord,
    laid_board,
)
from support import near

from gyrodrift.calibrate.guide import GuideStep, Key
from gyrodrift.calibrate.positions.guide import PositionGuide, PositionPlan
from gyrodrift.calibrate.positions.matrix import AxisTurn, fit_matrix
from gyrodrift.calibrate.positions.measurements import over
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import CalibrationError
from gyrodrift.values.sample import Sample

NOW = datetime(2026, 5, 1, tzinfo=UTC)
CORRECTION = np.linalg.inv(GYRO_GAIN)
SIGMAS = 5.0
SIDES_ONLY, WITH_AXIS_TURNS = PositionPlan(), PositionPlan(has_turns=True)


def guided(samples: Sequence[Sample], plan: PositionPlan = SIDES_ONLY, piece: int = 7) -> PositionGuide:
    """Guide that was given all samples, as a link would read them."""
    sentences: list[str] = []
    guide = PositionGuide(plan, sentences.append)
    guide.begin()
    for start in range(0, len(samples), piece):
        guide.take(list(samples[start : start + piece]))
    return guide


def sentences_of(guide: PositionGuide) -> list[str]:
    sentences: list[str] = guide.say.__self__  # type: ignore[attr-defined] # the bound list.append of `guided`
    return sentences


def read_by_sensor(legs: tuple[str | float, ...] = SIX_SIDES, **options: float) -> list[Sample]:
    return laid_board(legs, seed=int(options.pop("seed", 1)), **options).through_sensor().samples()


@pytest.mark.parametrize("piece", [1, 50, 100000])
def test_six_sides_in_any_order_give_offset_and_scale_and_the_biases(piece: int) -> None:
    guide = guided(read_by_sensor(("-x", "+y", "+z", "+x", "-z", "-y"), askew_deg=6.0), piece=piece)
    assert guide.step is GuideStep.DONE
    result = guide.result(NOW, "bench", None)
    assert result.accel_offset_se_mps2 is not None
    offset_errors = np.array(result.accel_offset_mps2) - OFFSET_MPS2
    scale_errors = np.array(result.accel_scale) - SCALE
    assert (np.abs(offset_errors) < SIGMAS * np.array(result.accel_offset_se_mps2)).all()
    assert (np.abs(scale_errors) < SIGMAS * np.array(result.accel_scale_se)).all()
    assert max(result.accel_offset_se_mps2) < 0.01
    assert [*(result.gyro_bias_xy_dps or ()), result.bias_dps] == near(BIAS_DPS.tolist(), 0.02)
    assert result.gyro_matrix is None
    assert result.noise_dps_rthz == near(0.05 / RATE_HZ**0.5, 0.002)
    assert (result.device_id, result.temp_c) == ("bench", 25.0)


def test_turns_about_each_axis_give_scale_and_misalignment_of_the_gyro() -> None:
    """True rates come out, along the axes of the accelerometer; the mark is part of the standard errors."""
    guide = guided(read_by_sensor(WITH_TURNS, mark_deg=0.3), WITH_AXIS_TURNS)
    assert guide.step is GuideStep.DONE
    result = guide.result(NOW, "bench", 0.01)
    errors = np.array(result.gyro_matrix) - CORRECTION
    assert (np.abs(errors) < SIGMAS * np.array(result.gyro_matrix_se)).all()
    assert np.array(result.gyro_matrix_se).max() < 0.003
    assert result.mark_deg == near(0.3, 0.25)
    assert result.dps_per_lsb == 0.01
    assert sentences_of(guide)[-1].startswith("  gravity turns as the gyro says, within 0.")


def test_the_standard_errors_of_the_matrix_are_the_scatter_of_many_calibrations() -> None:
    """Simulated stops at the mark: a turn and the turn back share a stop."""
    rng = np.random.default_rng(2)
    ups = [axis for axis in np.eye(3) for _ in range(2)]
    matrices, stated = [], []
    for _ in range(400):
        turns = []
        for axis in range(3):
            stops_deg = [0.5, 360.5, 0.5] + 0.5 * rng.standard_normal(3)
            for angle_deg in np.diff(stops_deg):
                angles_deg = angle_deg * GYRO_GAIN[:, axis] + 0.1 * rng.standard_normal(3)
                turns.append(AxisTurn(axis, 1, float(angle_deg), angles_deg))
        fit = fit_matrix(turns, ups, 0.0)
        matrices.append(fit.matrix - CORRECTION)
        stated.append(fit.matrix_se)
    scatter, expected = np.std(matrices, axis=0), np.sqrt(np.mean(np.square(stated), axis=0))
    np.testing.assert_allclose(expected, scatter, rtol=0.2)
    assert np.abs(np.mean(matrices, axis=0)).max() < 4.0 * scatter.max() / 20.0


@pytest.mark.promise("Clients of outputs")
def test_turns_about_one_axis_alone_tell_no_matrix() -> None:
    """Turns about one axis alone tell no matrix of the gyro; the reason names the missing turns."""
    samples = read_by_sensor(("+z", 360.0, -360.0, *SIX_SIDES[1:]))
    guide = guided(samples, WITH_AXIS_TURNS)
    assert guide.line.endswith("left: turns about x and y, there and back")
    guide.press(Key.ENOUGH)
    assert guide.step is GuideStep.DONE
    assert sentences_of(guide)[-1] == (
        "The matrix of the gyro is left out: only turns about z are complete, so scale and misalignment of the gyro "
        "stay unknown; turn the board about x and y too: with this axis up or down, a whole turn counter-clockwise and "
        "a whole turn back."
    )
    result = guide.result(NOW, "", None)
    assert result.gyro_matrix is None
    assert result.accel_scale is not None


def test_missing_sides_are_named() -> None:
    """Offset and scale need both ends of an axis."""
    guide = guided(read_by_sensor(("+z", "+x", "-z")))
    assert guide.line.startswith("at rest ")
    assert guide.line.endswith("left: -x, +y and -y up")
    guide.press(Key.ENOUGH)
    with pytest.raises(CalibrationError, match=r"3 of six sides were not measured.*with -x, \+y and -y up too"):
        guide.result(NOW, "", None)


@pytest.mark.parametrize(
    ("angle_deg", "reason"),
    [
        (300.0, "deg, not a whole turn: did it stop at the mark, and is the axis vertical?"),
        (-720.0, "deg, a factor of 2: too few or too many turns, or a scale for another range of the sensor."),
        (385.0, "deg, earlier ones 365.0 deg: did it stop at the mark?"),
    ],
)
def test_a_turn_that_is_not_whole_is_refused_and_done_again(angle_deg: float, reason: str) -> None:
    """The next turn counts from where it stopped."""
    legs = ("+z", 360.0, angle_deg, -360.0)
    guide = guided(read_by_sensor(legs, askew_deg=0.0), WITH_AXIS_TURNS)
    (refused,) = (sentence for sentence in sentences_of(guide) if sentence.startswith("Not accepted"))
    assert reason in refused
    assert refused.endswith("Stop at the mark, and turn again.")
    assert guide.line.endswith("turns about x and y, there and back")


def test_a_side_laid_down_again_is_no_turn() -> None:
    """A push on the table, or the board lifted and put back; it improves the mean."""
    guide = guided(read_by_sensor(("+z", 20.0, "+x", *SIX_SIDES[2:])), WITH_AXIS_TURNS)
    assert "  +z up once more" in sentences_of(guide)
    assert guide.line.endswith("left: turns about x, y and z, there and back")


def test_a_key_removes_the_last_turn_or_side() -> None:
    guide = guided(read_by_sensor(("+z", "+x", 360.0)), WITH_AXIS_TURNS)
    guide.press(Key.UNDO)
    guide.press(Key.UNDO)
    assert sentences_of(guide)[-2:] == [
        "Removed the last turn about x; left: -x, +y, -y and -z up; turns about x, y and z, there and back.",
        "Removed +x up; left: +x, -x, +y, -y and -z up; turns about x, y and z, there and back.",
    ]
    guide.press(Key.UNDO)
    assert sentences_of(guide)[-1].startswith("Removed +z up; left: +x, -x, +y, -y, +z and -z up; turns")
    count = len(sentences_of(guide))
    guide.press(Key.UNDO)
    assert len(sentences_of(guide)) == count


def test_a_board_at_45_degrees_lies_on_no_side() -> None:
    guide = guided(read_by_sensor(("+z", "+x"), askew_deg=45.0, seed=3))
    assert any("deg off the vertical, and 30 deg are allowed. Lay it on a side." in it for it in sentences_of(guide))


def swapped(record: BoardRecord) -> BoardRecord:
    """Reading of a device whose driver swaps two axes of the accelerometer."""
    return replace(record, accel_mps2=record.accel_mps2[:, [1, 0, 2]])


@pytest.mark.promise("Clients of outputs")
def test_axes_that_contradict_gravity_are_refused() -> None:
    """A board whose gyro and accelerometer have different axes is not calibrated."""
    with pytest.raises(CalibrationError, match=r"gravity does not turn as the gyro says: .*gyrodrift doctor tells"):
        guided(swapped(laid_board().through_sensor()).samples())


@pytest.mark.parametrize(
    ("factor", "reason"),
    [
        (1.0 / 9.80665, "the acceleration at rest is 1.03 m/s², and gravity is 9.81: it is in g"),
        (4.0, "the acceleration at rest is 40.5 m/s², and gravity is 9.81: check the unit and the range"),
    ],
)
def test_another_unit_of_the_acceleration_is_refused(factor: float, reason: str) -> None:
    record = laid_board(askew_deg=0.0).through_sensor()
    with pytest.raises(CalibrationError, match=reason):
        guided(replace(record, accel_mps2=record.accel_mps2 * factor).samples())


def test_a_device_without_an_accelerometer_is_refused() -> None:
    """A device of one axis, and three axes that send no acceleration."""
    one_axis = [Sample(i, i / RATE_HZ, i / RATE_HZ, 0.1) for i in range(100)]
    silent = replace(laid_board(), accel_mps2=np.full_like(laid_board().accel_mps2, nan)).samples()
    for samples in (one_axis, silent):
        with pytest.raises(CalibrationError, match="does not send three rates and three accelerations"):
            guided(samples)


def test_an_accelerometer_slower_than_the_gyro_is_enough() -> None:
    """Every fourth sample has an acceleration."""
    record = laid_board().through_sensor()
    accel = record.accel_mps2.copy()
    accel[np.arange(len(accel)) % 4 != 0] = nan
    guide = guided(replace(record, accel_mps2=accel).samples())
    assert guide.step is GuideStep.DONE
    assert guide.result(NOW, "", None).accel_scale == near(SCALE.tolist(), 0.003)


def test_a_turn_with_lost_samples_is_refused() -> None:
    samples = read_by_sensor(("+z", 360.0))
    start = round((REST_S + 2.0) * RATE_HZ)
    guide = guided([*samples[:start], *samples[start + 20 :]], WITH_AXIS_TURNS)
    assert sentences_of(guide)[-1].startswith("Not accepted: samples were lost, or out of the range of the device")


@pytest.mark.promise("Clients of outputs")
def test_a_turn_out_of_the_range_of_the_device_is_refused() -> None:
    """A turn that is not whole, lost samples or left the range of the device is not used."""
    samples = read_by_sensor(("+z", 360.0, -360.0))
    guide = guided(samples[:400], WITH_AXIS_TURNS)
    guide.take(samples[400:500], clipped=3)
    guide.take(samples[500:1300])
    assert sentences_of(guide)[-1].startswith("Not accepted: samples were lost, or out of the range of the device")
    guide.take(samples[1300:])
    assert sentences_of(guide)[-1].startswith("  turn about z reads -36")


def test_without_a_user_the_calibration_ends_when_nothing_new_comes() -> None:
    record = laid_board(("+z",)).through_sensor()
    resting = [sample for i in range(32) for sample in replace(record, t_s=record.t_s + i * REST_S).samples()]
    with pytest.raises(CalibrationError, match=r"nothing new was measured within 120 s; left: \+x, -x"):
        guided(resting, PositionPlan(is_by_hand=False))


@pytest.mark.promise("Clients of outputs")
def test_six_positions_keep_the_values_of_one_axis_of_the_same_device() -> None:
    """Six positions keep the scale and the temperature run of one axis."""
    old = Calibration("2026-01-01", device_id="bench", sign=-1, scale_ccw=0.98, bias_dps_per_c=0.01, bias_dps=3.0)
    new = Calibration("2026-05-01", device_id="bench", bias_dps=0.5, accel_scale=(1.0, 1.01, 1.02), temp_c=22.0)
    kept = over(new, old)
    assert kept == replace(old, date=new.date, bias_dps=0.5, accel_scale=new.accel_scale, temp_c=22.0)
    identity = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
    with_matrix = over(replace(new, gyro_matrix=identity), old)
    assert (with_matrix.sign, with_matrix.scale_ccw, with_matrix.bias_dps_per_c) == (1, 1.0, 0.01)
    assert over(new, replace(old, device_id="other")) == new
    assert over(new, None) == new


def test_a_coarse_accelerometer_has_larger_standard_errors() -> None:
    record = laid_board().through_sensor(noise_mps2=0.002)
    coarse = replace(record, accel_mps2=np.round(record.accel_mps2 / 0.2) * 0.2)
    result = guided(coarse.samples()).result(NOW, "", None)
    assert result.accel_offset_se_mps2 is not None
    assert min(result.accel_offset_se_mps2) > 0.02
    assert result.accel_offset_mps2 == near(OFFSET_MPS2.tolist(), 0.2)
