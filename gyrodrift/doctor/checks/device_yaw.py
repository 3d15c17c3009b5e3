"""Check of the filter that a device runs itself: its yaw against restlevel here."""

from math import pi

from gyrodrift.doctor.check import Check
from gyrodrift.doctor.device_yaw import YawAgreement, yaw_agreement
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, error, ok, warning

MOST_SIGMAS = 3.0
"""Largest difference that counts as agreement, in standard deviations of both filters. Both see the same samples, so
their errors are nearly the same, and their difference is smaller than that of independent filters."""

SLOPE_SHARE = 0.1
LEAST_SPAN_DEG = 20.0
"""Largest relative error of a slope that shows a sign or a unit, and the turn that it needs, deg: chosen."""


def device_yaw(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the yaw of the device's own filter agrees with ours."""
    agreement = None if evidence.session is None else yaw_agreement(evidence.session)
    if agreement is None:
        return None
    name = f" ({evidence.device.device_filter})" if evidence.device.device_filter else ""
    apart = f"{abs(agreement.difference_deg):.2g} deg apart at {agreement.t_s:.1f} s"
    sigmas = f"{agreement.sigmas:.1f} times their sigma"
    if agreement.sigmas <= MOST_SIGMAS:
        return ok(
            f"The device's own yaw{name} agrees with restlevel here: at most {apart}, {sigmas}.",
            agreement.difference_deg,
            "deg",
        )
    says = f"The device's own yaw{name} and restlevel here are {apart}, {sigmas}."
    if convention := _convention(agreement):
        return error(f"{says} {convention[0]}", convention[1], agreement.difference_deg, "deg")
    return warning(
        says,
        "Compare both with an encoder: gyrodrift compare. If the device is wrong, check the scale, the time and the "
        "parameters of its filter, and whether it was reset.",
        agreement.difference_deg,
        "deg",
    )


def _convention(agreement: YawAgreement) -> tuple[str, str] | None:
    """State and advice if sign or unit explain the difference."""
    if agreement.span_deg < LEAST_SPAN_DEG:
        return None
    if abs(agreement.slope + 1.0) <= SLOPE_SHARE:
        return "It counts clockwise.", "Send the yaw counter-clockwise positive: invert the rate that its filter gets."
    if abs(agreement.slope * 180.0 / pi - 1.0) <= SLOPE_SHARE:
        return "It seems to be in radians.", "Send yaw and sigma in degrees, and the bias in deg/s."
    return None


CHECKS = (Check("device_yaw", "whether the yaw of the device's own filter agrees with restlevel here", device_yaw),)
