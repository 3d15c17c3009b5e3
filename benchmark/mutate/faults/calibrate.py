"""Faults of the calibration of three axes."""

from mutate.fault import Fault

POSITIONS = "gyrodrift/calibrate/positions"
GUIDE_TESTS = ("tests/calibrate/test_positions.py",)
APPLIED_TESTS = ("tests/calibrate/test_applied.py",)

FAULTS = (
    Fault(
        "calibrate/offset-after-scale",
        "gyrodrift/session/calibrated.py",
        "accel_mps2 if calibration.accel_scale is None else accel_mps2 * np.array(calibration.accel_scale)",
        "measured_mps2 if calibration.accel_scale is None else measured_mps2 * np.array(calibration.accel_scale)",
        "A session loses the offset of its accelerometer.",
        APPLIED_TESTS,
    ),
    Fault(
        "calibrate/matrix-transposed",
        "gyrodrift/values/vectors.py",
        "(a, b, c), (d, e, f), (g, h, i) = matrix\n",
        "(a, d, g), (b, e, h), (c, f, i) = matrix\n",
        "The misalignment is applied with the wrong sign.",
        APPLIED_TESTS,
    ),
    Fault(
        "calibrate/biases-of-level-axes-lost",
        "gyrodrift/values/calibration.py",
        "shifted = x_dps + before[0] - after[0], y_dps + before[1] - after[1]",
        "shifted = x_dps, y_dps",
        "A new calibration shifts the biases that a filter has learnt.",
        APPLIED_TESTS,
    ),
    Fault(
        "calibrate/scale-of-one-axis-for-three",
        "gyrodrift/session/calibrated.py",
        "(applied.scale_sigma, applied.axes_scale_sigma)",
        "(applied.scale_sigma, applied.scale_sigma)",
        "The scales of x and y count as known.",
        APPLIED_TESTS,
    ),
    Fault(
        "calibrate/shared-stop-ignored",
        f"{POSITIONS}/matrix.py",
        "(4.0 * counts - 2.0) / counts**2",
        "1.0 / counts",
        "The standard errors of the matrix are too small.",
        GUIDE_TESTS,
    ),
    Fault(
        "calibrate/turn-without-bias",
        f"{POSITIONS}/measurements.py",
        "(rates_dps - bias_dps)[is_inside]",
        "rates_dps[is_inside]",
        "The bias counts as a part of a turn.",
        GUIDE_TESTS,
    ),
    Fault(
        "calibrate/swapped-axes-accepted",
        f"{POSITIONS}/guide.py",
        "            self._so_far.check_gravity()\n",
        "",
        "A swapped accelerometer is calibrated.",
        GUIDE_TESTS,
    ),
    Fault(
        "calibrate/clipped-turn-accepted",
        f"{POSITIONS}/rests.py",
        "not self._clipped and not _has_hole(move)",
        "not _has_hole(move)",
        "A turn out of the range of the gyro gives its scale.",
        GUIDE_TESTS,
    ),
    Fault(
        "calibrate/rounding-ignored",
        f"{POSITIONS}/block.py",
        "step / sqrt(12.0) * np.exp",
        "0.0 * np.exp",
        "A coarse accelerometer states errors that are too small.",
        GUIDE_TESTS,
    ),
    Fault(
        "calibrate/temperature-run-lost",
        f"{POSITIONS}/measurements.py",
        "    return replace(old, **{",
        "    return replace(new, **{",
        "Six positions drop the values of one axis.",
        GUIDE_TESTS,
    ),
)
