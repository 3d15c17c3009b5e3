"""Parameters and calibration of a gyro for its microcontroller: `my_gyro.h`, and `my_gyro.py` for MicroPython."""

import re
import textwrap
from dataclasses import asdict, dataclass
from pathlib import Path

from gyrodrift import __version__
from gyrodrift.config.model import Config
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.firmware.parameters import WIDTH, initializer
from gyrodrift.values.calibration import NO_CALIBRATION, Calibration
from gyrodrift.values.errors import UsageError, visible
from gyrodrift.values.mount import Mount

NO_LIMIT_C = 1000.0
"""End of a temperature run that has none, °C; no gyro works there."""

IDENTITY = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))

ONE_AXIS = ("sign", "scale_ccw", "scale_cw", "bias_dps", "bias_dps_per_c", "temp_c", "temp_low_c", "temp_high_c")
"""First members of `gd_calibration`."""

Numbers = tuple["float | Numbers", ...]


@dataclass(frozen=True, slots=True)
class TunedGyro:
    """Parameters and calibration of a config, as `serve` uses them.

    config
        Name of the config file.
    filter
        Filter of the config, `hdr` or `restlevel`.
    hdr, restlevel, attitude
        Parameters of HDR, and of restlevel on one and on three axes: `scale_percent` is at most the standard error of
        the calibrated scale.
    sample_rate_hz
        Sample rate of the tuning, Hz; None if unknown.
    calibration, mount
        Calibration of the device, `NO_CALIBRATION` without one, and the mount of the sensor.
    """

    config: str
    filter: str
    hdr: FilterParams
    restlevel: FilterParams
    attitude: FilterParams
    sample_rate_hz: float | None
    calibration: Calibration
    mount: Mount

    @classmethod
    def of_config(cls, config: Config, name: str) -> "TunedGyro":
        """Take the values of a config.

        Raises
        ------
        UsageError
            The filter of the config does not exist in C.
        """
        kinds = {kind.name: kind for kind in (HDR, RESTLEVEL)}
        if config.filter not in kinds:
            raise UsageError(f"{name}: filter {config.filter} runs in Python only; expected {' or '.join(kinds)}")
        calibration = config.calibration or NO_CALIBRATION
        restlevel = config.params_of(RESTLEVEL)
        return cls(
            name,
            config.filter,
            config.params_of(HDR),
            RESTLEVEL.scaled(restlevel, calibration.scale_sigma),
            RESTLEVEL.scaled(restlevel, calibration.axes_scale_sigma),
            config.sample_rate_hz,
            calibration,
            config.mount,
        )

    @property
    def about(self) -> list[str]:
        """Sentences on the origin of the values."""
        calibration = self.calibration
        device = f" of {_harmless(calibration.device_id)}" if calibration.device_id else ""
        lines = [f"Calibration{device}: {_harmless(calibration.date)}." if calibration.date else "No calibration."]
        lines.append(f"Filter of the config: {self.filter}.")
        if self.sample_rate_hz:
            lines.append(f"The parameters of HDR hold at {self.sample_rate_hz:g} Hz.")
        return lines


def my_gyro_h(gyro: TunedGyro, file_name: str) -> str:
    """Text of a header with the values; the names in it begin with the name of the file in capitals."""
    prefix = prefix_of(file_name)
    structs = (
        ("gd_hdr_params", "HDR", initializer(gyro.hdr), _names(HDR)),
        ("gd_restlevel_params", "RESTLEVEL", initializer(gyro.restlevel), _names(RESTLEVEL)),
        ("gd_restlevel_params", "ATTITUDE", initializer(gyro.attitude), "restlevel on three axes"),
        ("gd_calibration", "CALIBRATION", _braces(calibration_numbers(gyro)), "in the order of gd_calibration"),
    )
    constants = [_constant(kind, f"{prefix}_{name}", text, note) for kind, name, text, note in structs]
    return "\n".join([_head(gyro, prefix), *constants, "#endif\n"])


def _constant(kind: str, name: str, value: str, note: str) -> str:
    lines = textwrap.wrap(value, WIDTH - 4, break_long_words=False)
    return f"/* {note} */\nstatic const {kind} {name} =\n    " + "\n    ".join(lines) + ";\n"


def prefix_of(file_name: str) -> str:
    """Beginning of the names in a header, from the name of its file: `MY_GYRO` for `my_gyro.h`."""
    words = re.sub(r"[^A-Za-z0-9]+", "_", Path(file_name).stem).strip("_").upper()
    return words if re.match(r"[A-Z]", words) else f"GYRO_{words}".rstrip("_")


def _head(gyro: TunedGyro, prefix: str) -> str:
    about = "\n   ".join(gyro.about)
    return f"""\
/* Filter parameters and calibration of a gyro. Written by gyrodrift {__version__} from {_harmless(gyro.config)}.

   {about}

       gd_restlevel r;
       gd_restlevel_init(&r, &{prefix}_RESTLEVEL);
       gd_restlevel_update_us(&r, t_us, gd_calibrated_dps(&{prefix}_CALIBRATION, rate_dps, temp_c));

   With three axes, gd_calibrate_axes corrects rates and accelerations in place; {prefix}_ATTITUDE is for
   gd_attitude_init.
   A temperature that is unknown is NAN.
*/
#ifndef {prefix}_H
#define {prefix}_H

#include "gyrodrift.h"
"""


def _names(kind: Filter) -> str:
    return ", ".join(kind.names)


def _harmless(text: str) -> str:
    """Text that cannot end or nest a comment of C or a docstring."""
    return visible(text).replace("*/", "* /").replace("/*", "/ *").replace("\\", "/").replace('"""', "'''")


def calibration_numbers(gyro: TunedGyro) -> Numbers:
    """Values of `gd_calibration` in its order; a value that was not measured is the one that changes nothing."""
    c = gyro.calibration
    slope, temp_c = (0.0, 0.0) if c.temp_c is None else (c.bias_dps_per_c, c.temp_c)
    low_c = -NO_LIMIT_C if c.temp_low_c is None else c.temp_low_c
    high_c = NO_LIMIT_C if c.temp_high_c is None else c.temp_high_c
    return (
        *(float(c.sign), c.scale_ccw, c.scale_cw, c.bias_dps, slope, temp_c, low_c, high_c),
        c.gyro_bias_xy_dps or (0.0, 0.0),
        c.gyro_matrix or IDENTITY,
        c.accel_offset_mps2 or (0.0, 0.0, 0.0),
        c.accel_scale or (1.0, 1.0, 1.0),
        gyro.mount.axes,
    )


def _braces(value: "float | Numbers") -> str:
    if isinstance(value, tuple):
        return "{" + ", ".join(map(_braces, value)) + "}"
    return f"GD_R({float(value)!r})"


def my_gyro_py(gyro: TunedGyro) -> str:
    """Text of a module for MicroPython with the values."""
    numbers = zip(ONE_AXIS, calibration_numbers(gyro), strict=False)
    constants = "\n".join(f"{name.upper()} = {value!r}" for name, value in numbers)
    return PYTHON.format(
        version=__version__,
        config=_harmless(gyro.config),
        about="\n".join(gyro.about),
        hdr=asdict(gyro.hdr),
        restlevel=asdict(gyro.restlevel),
        constants=constants,
    )


PYTHON = '''\
"""Filter parameters and calibration of a gyro. Written by gyrodrift {version} from {config}.

{about}

    hdr = Hdr(**my_gyro.HDR)
    hdr.update_us(time.ticks_us(), my_gyro.calibrated_dps(rate_dps, temp_c))
"""

HDR = {hdr}
RESTLEVEL = {restlevel}

{constants}


def calibrated_dps(rate_dps, temp_c=None):
    """True rate for a measured rate, deg/s, at a temperature in C (None: unknown)."""
    bias_dps = BIAS_DPS
    if BIAS_DPS_PER_C != 0.0 and temp_c is not None:
        bias_dps += BIAS_DPS_PER_C * (min(max(temp_c, TEMP_LOW_C), TEMP_HIGH_C) - TEMP_C)
    rate_dps = SIGN * (rate_dps - bias_dps)
    return rate_dps * (SCALE_CCW if rate_dps >= 0.0 else SCALE_CW)
'''
"""Module for MicroPython; braces hold the values."""
