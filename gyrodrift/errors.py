"""Errors for people, under their public names."""

from gyrodrift.values.errors import (
    CalibrationError,
    ConfigError,
    DataError,
    DeviceSilentError,
    GyrodriftError,
    LinkError,
    PortBusyError,
    PortDeniedError,
    PortMissingError,
    UnitError,
    UsageError,
)

__all__ = [
    "CalibrationError",
    "ConfigError",
    "DataError",
    "DeviceSilentError",
    "GyrodriftError",
    "LinkError",
    "PortBusyError",
    "PortDeniedError",
    "PortMissingError",
    "UnitError",
    "UsageError",
]
