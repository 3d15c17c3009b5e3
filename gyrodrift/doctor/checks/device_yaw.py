"""Check of the filter that a device runs itself: its yaw against restlevel here."""

from dataclasses import dataclass
from math import hypot, isnan, pi

import numpy as np

from gyrodrift.doctor.evidence import DeviceEvidence, checks_of
from gyrodrift.doctor.finding import DeviceFinding, error, ok, warning
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats

MOST_SIGMAS = 3.0
"""Largest difference that counts as agreement, in standard deviations of both filters. Both see the same samples, so
their errors are nearly the same, and their difference is smaller than that of independent filters."""

SLOPE_SHARE = 0.1
LEAST_SPAN_DEG = 20.0
"""Largest relative error of a slope that shows a sign or a unit, and the turn that it needs, deg: chosen."""

SAMPLES_MAX = 200_000
"""Samples at the end of a long recording that are compared."""

LEAST_SIGMA_DEG = 0.05
"""Smallest standard deviation of the difference, deg: rounding of the rate to 16 bits and of the yaw to 32 bits, and
the different arithmetic of a board. Chosen: five times the 0.01 deg an hour that the C header keeps to."""


@dataclass(frozen=True, slots=True)
class YawAgreement:
    """Largest disagreement of two yaws, counted from their first common sample.

    difference_deg, sigmas
        Difference at that sample, deg, and the same in standard deviations of both filters.
    t_s
        Time of that sample, s after the first one.
    slope
        Least-squares slope of the device's yaw over ours: 1 if both have the same sign and unit.
    span_deg
        Range of our yaw, deg.
    """

    difference_deg: float
    sigmas: float
    t_s: float
    slope: float
    span_deg: float


def yaw_agreement(session: Session) -> YawAgreement | None:
    """Largest disagreement in a session; None for a device without a filter, or with a single result."""
    if session.device_yaw_deg is None:
        return None
    part = session.part(max(0, len(session.rate_dps) - SAMPLES_MAX), len(session.rate_dps))
    rows, ours_deg, sigmas_deg = _ours(part)
    if len(rows) < 2:
        return None
    device_deg = part.filled("device_yaw_deg")[rows]
    ours_deg, device_deg = ours_deg - ours_deg[0], device_deg - device_deg[0]
    difference_deg = ours_deg - device_deg
    in_sigmas = np.abs(difference_deg) / np.maximum(sigmas_deg, LEAST_SIGMA_DEG)
    worst = int(in_sigmas.argmax())
    square = float(ours_deg @ ours_deg)
    return YawAgreement(
        difference_deg=float(difference_deg[worst]),
        sigmas=float(in_sigmas[worst]),
        t_s=float(part.t_device_s[rows[worst]] - session.t_device_s[0]),
        slope=float(ours_deg @ device_deg) / square if square else 1.0,
        span_deg=float(np.ptp(ours_deg)),
    )


def _ours(session: Session) -> tuple[list[int], Floats, Floats]:
    """Rows with a result of the device, yaw of restlevel there in deg, and the standard deviation of both filters."""
    run, rows, yaws_deg, sigmas_deg = FilterRun(RESTLEVEL, RESTLEVEL.params()), [], [], []
    device = (session.filled(name).tolist() for name in ("device_yaw_deg", "device_yaw_sigma_deg"))
    for row, (sample, device_deg, sigma_deg) in enumerate(zip(session.filter_samples(), *device, strict=True)):
        if run.step(*sample) and not isnan(device_deg):
            rows.append(row)
            yaws_deg.append(run.state.yaw_deg)
            sigmas_deg.append(hypot(run.state.yaw_sigma_deg, 0.0 if isnan(sigma_deg) else sigma_deg))
    return rows, np.array(yaws_deg), np.array(sigmas_deg)


def _agreement(evidence: DeviceEvidence) -> YawAgreement | None:
    return None if evidence.facts is None else yaw_agreement(evidence.facts.session)


def device_yaw(evidence: DeviceEvidence, agreement: YawAgreement) -> DeviceFinding | None:
    """Whether the yaw of the device's own filter agrees with restlevel here."""
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


CHECKS = checks_of(_agreement, device_yaw)
