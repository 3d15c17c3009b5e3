"""A corrected sample as a line of JSON, for stdout and for clients."""

import json
from collections.abc import Callable, Iterable, Mapping
from datetime import UTC, datetime
from itertools import chain
from typing import Any

from gyrodrift.outputs.fields import (
    CHOICES,
    OF_EVERY_DEVICE,
    OF_OWN_FILTER,
    OF_THREE_AXES,
    Field,
    Use,
    Value,
    fields_of,
)
from gyrodrift.values.aid import AidStatus
from gyrodrift.values.sample import Corrected


def _form(field: Field) -> str:
    """Format of a key with its value, behind another; `%` on several takes a third of the time of an f-string."""
    number = f"%.{field.decimals}f" if field.decimals else "%d"
    return f',"{field.name}":' + (f"[{','.join([number] * field.count)}]" if field.is_list else number)


PARTS = (
    ("seq", "t_s", "rate_dps", "corrected_dps", "yaw_deg", "bias_dps", "correction_deg", "corrections"),
    ("yaw_sigma_deg", "confidence"),
    ("bias_sigma_dps", "rest_probability"),
    ("heading_deg",),
    ("smooth_yaw_deg",),
    ("encoder_deg",),
    ("temp_c",),
)
"""Fields that a line begins with. They are written in parts, because that is fast; fields of a part are known together.
"""

FIRST, CERTAINTY, BIAS_CERTAINTY, HEADING, SMOOTH, ENCODER, TEMPERATURE = (
    "".join(_form(CHOICES[name]) for name in names) for names in PARTS
)
MEASURED = FIRST.removeprefix(",")
ATTITUDE = "".join(map(_form, OF_THREE_AXES))
"""All fields of an `Attitude` in its order."""

AGE_DECIMALS = 3
"""Digits of an age: aids come at most some hundred times a second."""

Singles = tuple[tuple[Callable[[Corrected], Value | None], str], ...]
FURTHER, OWN_FILTER = (
    tuple((field.value, _form(field)) for field in fields_of(Use.LINE, table) if field.name not in chain(*PARTS))
    for table in (OF_EVERY_DEVICE, OF_OWN_FILTER)
)
"""Value and format of the fields that follow one by one, of every device and of a device with its own filter."""


def json_line(corrected: Corrected, opening: str = "{") -> str:
    """Line for one sample with significant digits, without unknown values.

    `opening` is the beginning of the object, for a field that all lines have.
    """
    (
        (seq, t_s, _, rate_dps, encoder_deg, temp_c, _, _, device_yaw, _),
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
        correction_deg,
        corrections,
        smooth_yaw_deg,
        aids,
    ) = corrected
    line = opening + MEASURED % (seq, t_s, rate_dps, corrected_dps, yaw_deg, bias_dps, correction_deg, corrections)
    if yaw_sigma_deg == yaw_sigma_deg:  # noqa: PLR0124 - false only for NaN; the fastest test
        line += CERTAINTY % (yaw_sigma_deg, confidence)
    if bias_sigma_dps == bias_sigma_dps:  # noqa: PLR0124
        line += BIAS_CERTAINTY % (bias_sigma_dps, rest_probability)
    if heading_deg == heading_deg:  # noqa: PLR0124
        line += HEADING % heading_deg
    if smooth_yaw_deg == smooth_yaw_deg:  # noqa: PLR0124
        line += SMOOTH % smooth_yaw_deg
    if encoder_deg == encoder_deg:  # noqa: PLR0124
        line += ENCODER % encoder_deg
    if temp_c == temp_c:  # noqa: PLR0124
        line += TEMPERATURE % temp_c
    if attitude is not None:
        total = sum(attitude)  # NaN if a value is unknown
        line += ATTITUDE % attitude if total == total else _attitude_part(corrected)  # noqa: PLR0124
    if device_yaw is not None:
        line += _singly(corrected, OWN_FILTER)
    if aids:
        line += f',"aids":{json.dumps(aid_ages(aids), separators=(",", ":"))}'
    return line + (_singly(corrected, FURTHER) if FURTHER else "") + "}\n"


def aid_ages(aids: Mapping[str, AidStatus]) -> dict[str, float]:
    """Time since the last measurement of each second source, s."""
    return {name: round(status.age_s, AGE_DECIMALS) for name, status in aids.items()}


def _singly(corrected: Corrected, forms: Singles) -> str:
    """Part of a line with known values, one by one."""
    values = ((value_of(corrected), form) for value_of, form in forms)
    return "".join(form % value for value, form in values if value is not None and _is_known(value))


def _attitude_part(corrected: Corrected) -> str:
    """Part of a line with the known values of an attitude."""
    names = [field.name for field in OF_THREE_AXES]
    return "".join(f',"{name}":{json.dumps(value)}' for name, value in present_fields(corrected, names).items())


def present_fields(corrected: Corrected, names: Iterable[str] = CHOICES) -> dict[str, Value]:
    """Fields with significant digits, in this order, without unknown values."""
    return {name: _rounded(value, name) for name, value in present_values(corrected, names).items()}


def _rounded(value: Value, name: str) -> Value:
    decimals = CHOICES[name].decimals
    return tuple(round(part, decimals) for part in value) if isinstance(value, tuple) else round(value, decimals)


def present_values(corrected: Corrected, names: Iterable[str] = CHOICES) -> dict[str, Value]:
    """Fields with all digits, in this order, without unknown values."""
    values = ((name, CHOICES[name].value(corrected)) for name in names)
    return {name: value for name, value in values if value is not None and _is_known(value)}


def chosen_line(corrected: Corrected, names: Iterable[str], **fixed: Any) -> str:
    """A line with only these fields, in this order, without unknown values."""
    return json.dumps(fixed | present_fields(corrected, names)) + "\n"


def _is_known(value: Value) -> bool:
    total = sum(value) if isinstance(value, tuple) else value
    return total == total  # noqa: PLR0124


def iso_time(unix_s: float) -> str:
    """UTC, with milliseconds, as gpsd and Signal K write it."""
    return datetime.fromtimestamp(unix_s, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
