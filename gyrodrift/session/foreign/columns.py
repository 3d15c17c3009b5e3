"""Samples from messages with the column names of a session, such as JSON objects; every value is checked."""

import json
import math
import reprlib
from collections.abc import Callable, Mapping
from typing import Any

from gyrodrift.session.aids import COLUMN, aid_of
from gyrodrift.session.csv import REQUIRED
from gyrodrift.session.session import DEVICE_COLUMNS
from gyrodrift.values.aid import Aid
from gyrodrift.values.constants import NS_PER_S
from gyrodrift.values.sample import DeviceYaw, Inertial, Sample

Decode = Callable[[bytes, int], Sample]
"""Makes a sample from the bytes of a message and its log time in ns."""


class WrongValueError(Exception):
    """A whole message is no sample."""


def json_sample(payload: bytes, log_ns: int) -> Sample:
    """Sample from a JSON object; other keys are ignored."""
    try:
        fields = json.loads(payload)
    except (ValueError, RecursionError) as error:
        raise WrongValueError("is not JSON") from error
    if not isinstance(fields, dict):
        raise WrongValueError(f"is {reprlib.repr(fields)}, expected an object with {' and '.join(REQUIRED)}")
    return sample_of(fields, log_ns)


def sample_of(fields: Mapping[str, Any], log_ns: int) -> Sample:
    """Sample from columns by name; None is a missing value.

    Raises
    ------
    WrongValueError
        A required column is missing, or a value is invalid.
    """
    for name in REQUIRED:
        if name not in fields:
            raise WrongValueError(f"has no {name}, which is required")
    seq = fields.get("seq")
    return Sample(
        seq=-1 if seq is None else whole("seq", seq),
        t_device_s=number("t_device_s", fields["t_device_s"]),
        t_host_s=number("t_host_s", fields.get("t_host_s", log_ns / NS_PER_S)),
        rate_dps=number("rate_dps", fields["rate_dps"]),
        encoder_deg=number("encoder_deg", fields.get("encoder_deg")),
        temp_c=number("temp_c", fields.get("temp_c")),
        still=number("still", fields.get("still")),
        inertial=_inertial(fields),
        device_yaw=_device_yaw(fields),
        aids=_aids(fields),
    )


def _aids(fields: Mapping[str, Any]) -> tuple[Aid, ...]:
    try:
        return tuple(map(aid_of, fields.get(COLUMN) or ()))
    except (TypeError, ValueError) as error:
        raise WrongValueError(f"has {COLUMN} that {error}") from error


def _inertial(fields: Mapping[str, Any]) -> Inertial | None:
    if fields.get("gyro_x_dps") is None:
        return None
    return Inertial._make(number(name, fields.get(name)) for name in Inertial._fields)


def _device_yaw(fields: Mapping[str, Any]) -> DeviceYaw | None:
    if fields.get("device_yaw_deg") is None:
        return None
    return DeviceYaw._make(number(name, fields.get(name)) for name in DEVICE_COLUMNS)


def number(name: str, value: Any) -> float:
    """A value as a float; NaN if it is missing."""
    if value is None:
        return math.nan
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise WrongValueError(f"has {reprlib.repr(value)} as {name}, expected a number")
    try:
        return float(value)
    except OverflowError:
        raise WrongValueError(f"has a number as {name} that is too large for a float") from None


def whole(name: str, value: Any) -> int:
    """A value as a 64-bit integer; -1 if it is missing."""
    as_float = number(name, value)
    if math.isnan(as_float):
        return -1
    if not as_float.is_integer() or not -(2**63) <= int(value) < 2**63:
        raise WrongValueError(f"has {reprlib.repr(value)} as {name}, expected a 64-bit integer")
    return int(value)
