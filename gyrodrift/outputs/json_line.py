"""A corrected sample as a line of JSON, for stdout and for clients."""

import json
from collections.abc import Callable, Iterable
from typing import Any

from gyrodrift.sample import Corrected

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
"""Fields by name."""

DIGITS = {name: 5 if name.endswith("_dps") else 4 for name in FIELDS} | {"t_s": 6, "t_host_s": 6, "temp_c": 2}
"""Digits behind the point. Device clocks count microseconds. 1e-5 deg/s is 0.036 deg/h, below the bias instability of
any such gyro. 1e-4 deg is one of 3.6 million counts, finer than encoders of turntables. Recordings keep all digits."""


def _part(*names: str) -> str:
    """Format of a part of a line; `%` on a whole part takes a third of the time of an f-string."""
    return ",".join(f'"{name}":%.{DIGITS[name]}f' for name in names)


MEASURED = '"seq":%d,' + _part("t_s", "rate_dps", "corrected_dps", "yaw_deg", "bias_dps")
CERTAINTY = "," + _part("yaw_sigma_deg", "confidence")
BIAS_CERTAINTY = "," + _part("bias_sigma_dps", "rest_probability")
HEADING, ENCODER, TEMPERATURE = ("," + _part(name) for name in ("heading_deg", "encoder_deg", "temp_c"))


def json_line(corrected: Corrected, opening: str = "{") -> str:
    """Line for one sample with significant digits, without unknown values.

    `opening` is the beginning of the object, for a field that all lines have.
    """
    (
        (seq, t_s, _, rate_dps, encoder_deg, temp_c, _, _),
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
    return line + "}\n"


def present_fields(corrected: Corrected, names: Iterable[str] = tuple(FIELDS)) -> dict[str, float]:
    """Fields with significant digits, in this order, without unknown values."""
    values = {name: FIELDS[name](corrected) for name in names}
    return {name: round(value, DIGITS[name]) for name, value in values.items() if value == value}  # noqa: PLR0124


def chosen_line(corrected: Corrected, names: Iterable[str], **fixed: Any) -> str:
    """A line with only these fields, in this order, without unknown values."""
    return json.dumps(fixed | present_fields(corrected, names)) + "\n"
