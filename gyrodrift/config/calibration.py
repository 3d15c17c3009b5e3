"""The block `calibration:` of a config: checked, written, and put into a file that has other things to keep."""

from collections.abc import Callable
from dataclasses import fields
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, get_type_hints

import yaml
from pydantic import ValidationError, create_model

from gyrodrift.calibration import Calibration, moment
from gyrodrift.config.explain import Strict, expectation, said, unknown_key
from gyrodrift.config.yaml import Key
from gyrodrift.errors import UsageError

CALIBRATION = "calibration"
WIDTH = 34
"""Column at which the notes of a block begin."""

NOTES = {
    "date": "when it was made, UTC",
    "device_id": "of which device; to another one it is not applied",
    "sign": "-1: the device counts clockwise turns as positive",
    "scale_ccw": "true rate over measured rate, counter-clockwise",
    "scale_ccw_se": "its standard error, the stops at the mark included",
    "scale_cw": "true rate over measured rate, clockwise",
    "scale_cw_se": "its standard error",
    "bias_dps": "measured rate at rest, deg/s",
    "bias_se_dps": "its standard error, deg/s",
    "temp_c": "the temperature this bias belongs to, °C",
    "bias_dps_per_c": "slope of the bias over temperature, deg/s per °C",
    "bias_dps_per_c_se": "its standard error",
    "temp_low_c": "lowest temperature of the run, °C; the bias stays as it is there below it",
    "temp_high_c": "highest, °C",
    "noise_dps_rthz": "white noise at rest, deg/s/√Hz; not applied",
    "dps_per_lsb": "smallest step of the rate, deg/s; not applied",
    "turns": "whole turns at a time",
    "repeats": "times each direction was turned",
    "mark_deg": "standard deviation of a stop at the mark, deg",
}


@cache
def _model() -> type[Strict]:
    """A model with the fields, bounds and defaults of a calibration; without a date it is none."""
    hints = get_type_hints(Calibration, include_extras=True)
    defaults = {each.name: each.default for each in fields(Calibration)} | {"date": ...}
    content: dict[str, Any] = {name: (hints[name], default) for name, default in defaults.items()}
    return create_model("CalibrationBlock", __base__=Strict, **content)


def calibration_in(given: Any, report: Callable[[Key, str], None]) -> Calibration | None:
    """Of the value of `calibration:`; None where there is none, or where it has mistakes, which are reported."""
    if given is None:
        return None
    if not isinstance(given, dict):
        report((), f"is {said(given)}; expected a block of keys, as gyrodrift calibrate writes it")
        return None
    model = _model()
    try:
        found = Calibration(**model.model_validate(given).model_dump())
    except ValidationError as error:
        for problem in error.errors(include_url=False):
            report((str(problem["loc"][0]),), _explained(model, str(problem["loc"][0]), problem["type"], given))
        return None
    try:
        moment(found.date)
    except ValueError:
        report(("date",), f"is {said(found.date)}; expected a date such as 2026-05-01T12:00:00+00:00")
        return None
    return found


def _explained(model: type[Strict], name: str, kind: str, given: dict[str, Any]) -> str:
    if kind == "extra_forbidden":
        return unknown_key(name, list(model.model_fields), f"a key of {CALIBRATION}")
    if kind == "missing":
        return "is missing; expected a date such as 2026-05-01T12:00:00+00:00"
    return f"is {said(given[name])}; expected {expectation(name, model.model_fields[name])}"


def block_text(found: Calibration) -> str:
    """The block as it stands in a config, each line with what it means."""
    named = {each.name: getattr(found, each.name) for each in fields(found)}
    content = {name: _rounded(value) for name, value in named.items() if value is not None}
    lines = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=1000).splitlines()
    noted = [f"  {line:{WIDTH}} # {NOTES[line.partition(':')[0]]}\n" for line in lines]
    return f"{CALIBRATION}:\n{''.join(noted)}"


def _rounded(value: Any) -> Any:
    """Seven digits: a scale to a tenth of a millionth."""
    return float(f"{value:.7g}") if isinstance(value, float) else value


def has_block(text: str) -> bool:
    """Whether a config has a calibration."""
    return _lines_of_block(text) is not None


def with_block(text: str, block: str) -> str:
    """A config with the block in the place of its own, or behind everything else; all other lines stay as they are.

    Raises
    ------
    UsageError
        Where the file is written in a way that lines cannot be put into.
    """
    lines, place = text.splitlines(keepends=True), _lines_of_block(text)
    if place is not None:
        return "".join([*lines[: place[0]], block, *lines[place[1] :]])
    end = "" if not lines or lines[-1].endswith("\n") else "\n"
    return f"{text}{end}{block}"


def block_in(text: str) -> str:
    """The lines of the block in a config; empty where it has none."""
    place = _lines_of_block(text)
    return "" if place is None else "".join(text.splitlines(keepends=True)[place[0] : place[1]])


def _lines_of_block(text: str) -> tuple[int, int] | None:
    """First line of the block and the line behind its last; comments at the margin belong to what follows."""
    top = yaml.compose(text, Loader=yaml.SafeLoader)
    if top is None:
        return None
    if not isinstance(top, yaml.MappingNode) or top.flow_style:
        raise UsageError("its keys do not stand on lines of their own; write them so, then calibrate again")
    starts = [key.start_mark.line for key, _ in top.value]
    named = [key.start_mark.line for key, _ in top.value if key.value == CALIBRATION]
    if not named:
        return None
    lines = text.splitlines()
    end = min((start for start in starts if start > named[0]), default=len(lines))
    while end > named[0] + 1 and not lines[end - 1].startswith((" ", "\t")):
        end -= 1
    return named[0], end


def checked(text: str, path: Path, load: Callable[[Path], Any]) -> str:
    """The text of a config, seen to be one that `load` takes.

    Raises
    ------
    UsageError
        Where it is none.
    """
    with TemporaryDirectory() as folder:
        trial = Path(folder) / path.name
        trial.write_text(text, encoding="utf-8")
        load(trial)
    return text
