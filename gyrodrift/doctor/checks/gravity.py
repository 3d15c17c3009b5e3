"""Checks of the accelerometer: unit, axis up, agreement with the gyro, vibration, range."""

from gyrodrift.columns.accel_axes import AGREES
from gyrodrift.columns.gravity import gravity_unit
from gyrodrift.doctor.check import Check
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, error, note, ok, warning
from gyrodrift.doctor.gravity import gravity_summary
from gyrodrift.session.checks.axes import agreement
from gyrodrift.values.constants import STANDARD_GRAVITY_MPS2

SIZE_SHARE = 0.12
"""Largest relative error of gravity in the right unit: offset and scale of cheap parts, 0.08 g and 3 % (MPU-6050 data
sheet), beside 0.5 % of gravity itself."""

OFF_SHARE = 0.02
"""Relative error from which a calibration is advised: 1.1 deg of tilt if all of it is one axis' offset."""

VIBRATION_MPS2 = 0.5
"""Scatter at rest above that of parts with a noise of 400 µg/√Hz at 200 Hz of bandwidth, 0.06 m/s², by eight times."""

CLIPPED_MIN = 3
RAIL_MPS2 = 15.0
"""Samples at the largest value, and the smallest value that may be the end of a range: 2 g is 19.6 m/s²."""


def gravity(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the accelerometer measures gravity in m/s²."""
    summary = None if evidence.session is None else gravity_summary(evidence.session)
    if summary is None:
        return None
    size = summary.size_mps2
    if abs(size / STANDARD_GRAVITY_MPS2 - 1.0) <= SIZE_SHARE:
        do = (
            ""
            if abs(size / STANDARD_GRAVITY_MPS2 - 1.0) <= OFF_SHARE
            else "gyrodrift calibrate --positions measures offset and scale."
        )
        return (note if do else ok)(f"Gravity is {size:.2f} m/s², {summary.up} is up.", do=do, value=size, unit="m/s²")
    if unit := gravity_unit(size, SIZE_SHARE):
        axes = ", ".join(f"{axis}:{unit}" for axis in ("ax", "ay", "az"))
        return error(
            f"Gravity reads {size:.5g} in place of 9.81 m/s²: the accelerations are in {unit.replace('/', ' / ')}.",
            f"Name the unit in the columns: --columns '..., {axes}'.",
            size,
        )
    return error(
        f"Gravity reads {size:.3g} in place of 9.81 m/s².",
        "Check the range of the accelerometer, and the unit of ax, ay and az in --columns.",
        size,
    )


def axes_agree(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether gravity turns as the gyro says, so that both have the same axes."""
    axes = None if evidence.session is None else agreement(evidence.session)
    if axes is None:
        return None
    if axes.residual <= AGREES:
        return ok("Gravity turns as the gyro says: both have the same axes.", axes.residual)
    if axes.best_residual <= AGREES:
        return error(
            f"Gravity turns another way than the gyro says. It fits if {axes.named}.",
            f"Name the three columns of the acceleration, in the frame of the gyro: {axes.spec}.",
            axes.residual,
        )
    return note(
        "Gravity does not turn as the gyro says, with any order or sign of the axes. Quick motion hides gravity.",
        "Tilt the device slowly by hand for 20 s. If this stays, check the units and the times of both.",
        axes.residual,
    )


def accel_vibration(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Vibration at rest, by the accelerometer."""
    summary = None if evidence.session is None else gravity_summary(evidence.session)
    if summary is None:
        return None
    noise = summary.noise_mps2
    if noise <= VIBRATION_MPS2:
        return ok(f"The acceleration scatters by {noise:.2g} m/s² at rest.", noise, "m/s²")
    return warning(
        f"The acceleration scatters by {noise:.2g} m/s² in the quietest fifth of the time: the sensor shakes.",
        "Mount it on foam, away from motors and fans.",
        noise,
        "m/s²",
    )


def accel_range(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether accelerations exceed the range or are missing."""
    summary = None if evidence.session is None else gravity_summary(evidence.session)
    if summary is None:
        return None
    if summary.largest_mps2 >= RAIL_MPS2 and summary.at_largest >= CLIPPED_MIN:
        return warning(
            f"{summary.at_largest} accelerations are exactly {summary.largest_mps2:.4g} m/s²: the range ends there.",
            "Choose a wider range; tilt suffers while the acceleration is cut off.",
            summary.largest_mps2,
            "m/s²",
        )
    if summary.missing > 0.0:
        return note(
            f"{summary.missing:.1%} of the samples have no acceleration.",
            "Yaw goes on by the gyro; send the acceleration with every sample.",
            summary.missing,
        )
    return ok(f"The largest acceleration is {summary.largest_mps2:.3g} m/s².", summary.largest_mps2, "m/s²")


CHECKS = (
    Check("gravity", "size of gravity, and the axis that points up", gravity),
    Check("axes_agree", "whether gravity turns as the gyro says", axes_agree),
    Check("accel_vibration", "vibration at rest, by the accelerometer", accel_vibration),
    Check("accel_range", "whether accelerations exceed the range or are missing", accel_range),
)
