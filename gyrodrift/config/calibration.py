"""The block `calibration:` of a config: checked, written, and put into a file without changing its other lines."""

from collections.abc import Callable
from dataclasses import fields
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_type_hints

import yaml
from pydantic import ValidationError, create_model

from firmware_sim.plain_value import Key
from gyrodrift.config.explain import describe_value, expectation, unknown_key
from gyrodrift.config.strict import Strict
from gyrodrift.values.calibration import AXES_SHAPES, Calibration, moment
from gyrodrift.values.errors import UsageError
from gyrodrift.values.vectors import determinant, numbers_of, shape_text

CALIBRATION = "calibration"
LEAST_DETERMINANT = 0.1
"""Smallest determinant of the matrix of a gyro: three axes with half the scale have 0.125."""

WIDTH = 34
"""Column of the comments of a block."""

NOTES = {
    "date": "date of the calibration, UTC",
    "device_id": "calibrated device; not applied to any other device",
    "sign": "-1: the device counts clockwise turns as positive",
    "scale_ccw": "true rate over measured rate, counter-clockwise",
    "scale_ccw_se": "its standard error, with the stops at the mark",
    "scale_cw": "true rate over measured rate, clockwise",
    "scale_cw_se": "its standard error",
    "bias_dps": "measured rate at rest, deg/s",
    "bias_se_dps": "its standard error, deg/s",
    "temp_c": "temperature of this bias, °C",
    "bias_dps_per_c": "slope of the bias over temperature, deg/s per °C",
    "bias_dps_per_c_se": "its standard error",
    "temp_low_c": "lowest temperature of the run, °C; below it the bias is constant",
    "temp_high_c": "highest, °C; above it the bias is constant",
    "noise_dps_rthz": "white noise at rest, deg/s/√Hz; not applied",
    "dps_per_lsb": "smallest step of the rate, deg/s; not applied",
    "turns": "whole turns at a time",
    "repeats": "turns measured in each direction",
    "mark_deg": "standard deviation of a stop at the mark, deg",
    "accel_offset_mps2": "measured acceleration of x, y, z without force, m/s²",
    "accel_offset_se_mps2": "its standard errors, m/s²",
    "accel_scale": "true acceleration over measured acceleration, x, y, z",
    "accel_scale_se": "its standard errors",
    "gyro_bias_xy_dps": "measured rates at rest about x and y, deg/s",
    "gyro_bias_xy_se_dps": "their standard errors, deg/s",
    "gyro_matrix": "rates along the accelerometer from measured rates, rows x, y, z",
    "gyro_matrix_se": "its standard errors",
}


@cache
def _model() -> type[Strict]:
    """A model with the fields, bounds and defaults of a calibration; the date is required."""
    hints = get_type_hints(Calibration, include_extras=True)
    defaults = {field.name: field.default for field in fields(Calibration)} | {"date": ...}
    content: dict[str, Any] = {name: (hints[name], default) for name, default in defaults.items()}
    return create_model("CalibrationBlock", __base__=Strict, **content)


def calibration_in(value: Any, report: Callable[[Key, str], None]) -> Calibration | None:
    """Calibration from the value of `calibration:`; None if it is absent, or has mistakes, which are reported."""
    if value is None:
        return None
    if not isinstance(value, dict):
        report((), f"is {describe_value(value)}; expected a block of keys, as written by gyrodrift calibrate")
        return None
    model, shaped = _model(), _with_tuples(value, report)
    if shaped is None:
        return None
    try:
        calibration = Calibration(**model.model_validate(shaped).model_dump())
    except ValidationError as error:
        for problem in error.errors(include_url=False):
            report((str(problem["loc"][0]),), _explained(model, str(problem["loc"][0]), problem["type"], value))
        return None
    return calibration if _is_sound(calibration, report) else None


def _with_tuples(value: dict[str, Any], report: Callable[[Key, str], None]) -> dict[str, Any] | None:
    """The values with vectors and matrices as tuples; None if a shape is wrong, which is reported."""
    shaped = dict(value)
    for name in [name for name in AXES_SHAPES if value.get(name) is not None]:
        try:
            shaped[name] = numbers_of(value[name], AXES_SHAPES[name], name)
        except ValueError:
            report((name,), f"is {describe_value(value[name])}; expected {shape_text(AXES_SHAPES[name])}")
            return None
    return shaped


def _is_sound(calibration: Calibration, report: Callable[[Key, str], None]) -> bool:
    """Whether the date is a date and the matrix has an inverse; mistakes are reported."""
    matrix = calibration.gyro_matrix
    if matrix is not None and abs(determinant(matrix)) < LEAST_DETERMINANT:
        measured = "a matrix as gyrodrift calibrate measures it"
        report(("gyro_matrix",), f"has rows that are nearly parallel; expected {measured}")
        return False
    try:
        moment(calibration.date)
    except ValueError:
        report(("date",), f"is {describe_value(calibration.date)}; expected a date such as 2026-05-01T12:00:00+00:00")
        return False
    return True


def _explained(model: type[Strict], name: str, kind: str, given: dict[str, Any]) -> str:
    if kind == "extra_forbidden":
        return unknown_key(name, list(model.model_fields), f"a key of {CALIBRATION}")
    if kind == "missing":
        return "is missing; expected a date such as 2026-05-01T12:00:00+00:00"
    if name in AXES_SHAPES:
        return (
            f"has a number out of range; expected {shape_text(AXES_SHAPES[name])} as gyrodrift calibrate measures them"
        )
    return f"is {describe_value(given[name])}; expected {expectation(name, model.model_fields[name])}"


def block_text(calibration: Calibration) -> str:
    """The block as text of a config, with a comment on each line."""
    content = {name: _rounded(value) for name, value in calibration.values().items() if value is not None}
    noted = [line for name, value in content.items() for line in _noted_lines(name, value)]
    return f"{CALIBRATION}:\n{''.join(noted)}"


def _noted_lines(name: str, value: Any) -> list[str]:
    """Lines of a key with its comment; a list stands in brackets, a matrix in rows below its key."""
    is_matrix = isinstance(value, list) and isinstance(value[0], list)
    lines = [f"{name}:", *(f"  - {_brackets(row)}" for row in value)] if is_matrix else [_line(name, value)]
    return [f"  {lines[0]:{WIDTH}} # {NOTES[name]}\n", *(f"  {line}\n" for line in lines[1:])]


def _line(name: str, value: Any) -> str:
    if isinstance(value, list):
        return f"{name}: {_brackets(value)}"
    text: str = yaml.safe_dump({name: value}, allow_unicode=True, width=1000)
    return text.rstrip("\n")


def _brackets(numbers: list[float]) -> str:
    text: str = yaml.safe_dump(numbers, width=1000, default_flow_style=True)
    return text.rstrip("\n")


def _rounded(value: Any) -> Any:
    """Round numbers to seven digits, which resolve a scale to 1e-7; tuples become lists."""
    if isinstance(value, tuple):
        return [_rounded(number) for number in value]
    return float(f"{value:.7g}") if isinstance(value, float) else value


def has_block(text: str) -> bool:
    """Whether a config has a calibration."""
    return _lines_of_block(text) is not None


def with_block(text: str, block: str) -> str:
    """Replace the block in a config, or append it; all other lines stay.

    Raises
    ------
    UsageError
        If the keys of the file do not stand on lines of their own.
    """
    lines, span = text.splitlines(keepends=True), _lines_of_block(text)
    if span is not None:
        return "".join([*lines[: span[0]], block, *lines[span[1] :]])
    end = "" if not lines or lines[-1].endswith("\n") else "\n"
    return f"{text}{end}{block}"


def block_in(text: str, key: str = CALIBRATION) -> str:
    """Lines of the block in a config, or of another key; empty if it has none."""
    span = _lines_of_block(text, key)
    return "" if span is None else "".join(f"{line}\n" for line in text.splitlines()[span[0] : span[1]])


def _lines_of_block(text: str, name: str = CALIBRATION) -> tuple[int, int] | None:
    """First line of the block and the line behind its last; unindented comments belong to the next block."""
    top = yaml.compose(text, Loader=yaml.SafeLoader)
    if top is None:
        return None
    if not isinstance(top, yaml.MappingNode) or top.flow_style:
        raise UsageError("its keys do not stand on lines of their own; give each its own and calibrate again")
    starts = [key.start_mark.line for key, _ in top.value]
    named = [key.start_mark.line for key, _ in top.value if key.value == name]
    if not named:
        return None
    lines = text.splitlines()
    end = min((start for start in starts if start > named[0]), default=len(lines))
    while end > named[0] + 1 and not lines[end - 1].startswith((" ", "\t")):
        end -= 1
    return named[0], end


def checked(text: str, path: Path, load: Callable[[Path], Any]) -> str:
    """The text of a config, after `load` has accepted it.

    Raises
    ------
    UsageError
        If `load` refuses it.
    """
    with TemporaryDirectory() as folder:
        trial = Path(folder) / path.name
        trial.write_text(text, encoding="utf-8")
        load(trial)
    return text
