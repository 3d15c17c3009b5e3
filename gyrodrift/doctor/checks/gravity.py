"""Checks of the accelerometer: unit, axis up, agreement with the gyro, vibration, range."""

from gyrodrift.columns.accel_axes import AGREES, Agreement
from gyrodrift.columns.sizes import gravity_unit
from gyrodrift.doctor.evidence import DeviceEvidence, checks_of
from gyrodrift.doctor.finding import DeviceFinding, error, note, ok, warning
from gyrodrift.facts.gravity import GravitySummary
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


def _gravity(evidence: DeviceEvidence) -> GravitySummary | None:
    return None if evidence.facts is None else evidence.facts.gravity


def _agreement(evidence: DeviceEvidence) -> Agreement | None:
    return None if evidence.facts is None else evidence.facts.axes_agreement


def gravity(_evidence: DeviceEvidence, summary: GravitySummary) -> DeviceFinding | None:
    """Size of gravity, and the axis that points up."""
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


def axes_agree(_evidence: DeviceEvidence, axes: Agreement) -> DeviceFinding | None:
    """Whether gravity turns as the gyro says."""
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


def accel_vibration(_evidence: DeviceEvidence, summary: GravitySummary) -> DeviceFinding | None:
    """Vibration at rest, by the accelerometer."""
    noise = summary.noise_mps2
    if noise <= VIBRATION_MPS2:
        return ok(f"The acceleration scatters by {noise:.2g} m/s² at rest.", noise, "m/s²")
    return warning(
        f"The acceleration scatters by {noise:.2g} m/s² in the quietest fifth of the time: the sensor shakes.",
        "Mount it on foam, away from motors and fans.",
        noise,
        "m/s²",
    )


def accel_range(_evidence: DeviceEvidence, summary: GravitySummary) -> DeviceFinding | None:
    """Whether accelerations exceed the range or are missing."""
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
    *checks_of(_gravity, gravity),
    *checks_of(_agreement, axes_agree),
    *checks_of(_gravity, accel_vibration, accel_range),
)
