"""A corrected sample as a line of JSON, for stdout and for clients."""

import json
from collections.abc import Callable, Iterable
from typing import Any

from gyrodrift.values.sample import Attitude, Corrected, DeviceYaw

Value = float | tuple[float, ...]

FIELDS: dict[str, Callable[[Corrected], float]] = {
    "seq": lambda c: c.sample.seq,
    "t_s": lambda c: c.sample.t_device_s,
    "t_host_s": lambda c: c.sample.t_host_s,
    "rate_dps": lambda c: c.sample.rate_dps,
    "corrected_dps": lambda c: c.corrected_dps,
    "yaw_deg": lambda c: c.yaw_deg,
    "raw_yaw_deg": lambda c: c.raw_yaw_deg,
    "heading_deg": lambda c: c.heading_deg,
    "bias_dps": lambda c: c.bias_dps,
    "yaw_sigma_deg": lambda c: c.yaw_sigma_deg,
    "bias_sigma_dps": lambda c: c.bias_sigma_dps,
    "rest_probability": lambda c: c.rest_probability,
    "confidence": lambda c: c.confidence,
    "encoder_deg": lambda c: c.sample.encoder_deg,
    "temp_c": lambda c: c.sample.temp_c,
}
"""Numbers that any device can have, by name; NaN if unknown."""

ATTITUDE_FIELDS: dict[str, Callable[[Attitude], Value]] = {
    "q": lambda a: a[:4],
    "tilt_deg": lambda a: a.tilt_deg,
    "roll_deg": lambda a: a.roll_deg,
    "pitch_deg": lambda a: a.pitch_deg,
    "tilt_sigma_deg": lambda a: a.tilt_sigma_deg,
    "bias_xyz_dps": lambda a: a[8:],
}
"""Fields of a device with three axes; a list where there are several numbers."""

DEVICE_FIELDS: dict[str, Callable[[DeviceYaw], float]] = {
    "device_yaw_deg": lambda d: d.yaw_deg,
    "device_yaw_sigma_deg": lambda d: d.yaw_sigma_deg,
    "device_bias_dps": lambda d: d.bias_dps,
}
"""Fields of a device that runs a filter itself, as it sends them."""

NAMES = (*FIELDS, *ATTITUDE_FIELDS, *DEVICE_FIELDS)

DIGITS = {name: 5 if name.endswith("_dps") else 4 for name in NAMES} | {"t_s": 6, "t_host_s": 6, "temp_c": 2, "q": 6}
"""Digits behind the point. Device clocks count microseconds. 1e-5 deg/s is 0.036 deg/h, below the bias instability of
any such gyro. 1e-4 deg is one of 3.6 million counts, finer than encoders of turntables. Recordings keep all digits."""


def _part(*names: str) -> str:
    """Format of a part of a line; `%` on a whole part takes a third of the time of an f-string."""
    return ",".join(f'"{name}":%.{DIGITS[name]}f' for name in names)


def _numbers(name: str, count: int) -> str:
    """Format of the numbers of a list."""
    return ",".join([f"%.{DIGITS[name]}f"] * count)


MEASURED = '"seq":%d,' + _part("t_s", "rate_dps", "corrected_dps", "yaw_deg", "bias_dps")
CERTAINTY = "," + _part("yaw_sigma_deg", "confidence")
BIAS_CERTAINTY = "," + _part("bias_sigma_dps", "rest_probability")
HEADING, ENCODER, TEMPERATURE = ("," + _part(name) for name in ("heading_deg", "encoder_deg", "temp_c"))
ATTITUDE = (
    f',"q":[{_numbers("q", 4)}],{_part("tilt_deg", "roll_deg", "pitch_deg", "tilt_sigma_deg")}'
    f',"bias_xyz_dps":[{_numbers("bias_xyz_dps", 3)}]'
)
"""All fields of an `Attitude` in its order."""

DEVICE_YAW, DEVICE_SIGMA, DEVICE_BIAS = ("," + _part(name) for name in DEVICE_FIELDS)


def json_line(corrected: Corrected, opening: str = "{") -> str:
    """Line for one sample with significant digits, without unknown values.

    `opening` is the beginning of the object, for a field that all lines have.
    """
    (
        (seq, t_s, _, rate_dps, encoder_deg, temp_c, _, _, device_yaw),
        corrected_dps,
        yaw_deg,
        bias_dps,
        yaw_sigma_deg,
        confidence,
        bias_sigma_dps,
        rest_probability,
        _,
        heading_deg,
        _,
        attitude,
        _,
    ) = corrected
    line = opening + MEASURED % (seq, t_s, rate_dps, corrected_dps, yaw_deg, bias_dps)
    if yaw_sigma_deg == yaw_sigma_deg:  # noqa: PLR0124 - false only for NaN; the fastest test
        line += CERTAINTY % (yaw_sigma_deg, confidence)
    if bias_sigma_dps == bias_sigma_dps:  # noqa: PLR0124
        line += BIAS_CERTAINTY % (bias_sigma_dps, rest_probability)
    if heading_deg == heading_deg:  # noqa: PLR0124
        line += HEADING % heading_deg
    if encoder_deg == encoder_deg:  # noqa: PLR0124
        line += ENCODER % encoder_deg
    if temp_c == temp_c:  # noqa: PLR0124
        line += TEMPERATURE % temp_c
    if attitude is not None:
        total = sum(attitude)  # NaN if a value is unknown
        line += ATTITUDE % attitude if total == total else _attitude_part(corrected)  # noqa: PLR0124
    return line + (_device_part(device_yaw) if device_yaw is not None else "") + "}\n"


def _device_part(device_yaw: DeviceYaw) -> str:
    """Part of a line with the result of the device's own filter."""
    yaw_deg, sigma_deg, bias_dps = device_yaw
    sigma = DEVICE_SIGMA % sigma_deg if sigma_deg == sigma_deg else ""  # noqa: PLR0124 - as above
    return DEVICE_YAW % yaw_deg + sigma + DEVICE_BIAS % bias_dps


def _attitude_part(corrected: Corrected) -> str:
    """Part of a line with the known values of an attitude."""
    return "".join(
        f',"{name}":{json.dumps(value)}' for name, value in present_fields(corrected, ATTITUDE_FIELDS).items()
    )


def present_fields(corrected: Corrected, names: Iterable[str] = NAMES) -> dict[str, Value]:
    """Fields with significant digits, in this order, without unknown values."""
    values = present_values(corrected, names).items()
    return {
        name: tuple(round(part, DIGITS[name]) for part in value)
        if isinstance(value, tuple)
        else round(value, DIGITS[name])
        for name, value in values
    }


def present_values(corrected: Corrected, names: Iterable[str] = NAMES) -> dict[str, Value]:
    """Fields with all digits, in this order, without unknown values."""
    values = dict[str, Value]()
    for name in names:
        value = _value(corrected, name)
        if value is not None and _is_known(value):
            values[name] = value
    return values


def _value(corrected: Corrected, name: str) -> Value | None:
    """Value of a field; None if the device does not have it."""
    if name in FIELDS:
        return FIELDS[name](corrected)
    if name in DEVICE_FIELDS:
        device_yaw = corrected.sample.device_yaw
        return None if device_yaw is None else DEVICE_FIELDS[name](device_yaw)
    return None if corrected.attitude is None else ATTITUDE_FIELDS[name](corrected.attitude)


def chosen_line(corrected: Corrected, names: Iterable[str], **fixed: Any) -> str:
    """A line with only these fields, in this order, without unknown values."""
    return json.dumps(fixed | present_fields(corrected, names)) + "\n"


def _is_known(value: Value) -> bool:
    total = sum(value) if isinstance(value, tuple) else value
    return total == total  # noqa: PLR0124
