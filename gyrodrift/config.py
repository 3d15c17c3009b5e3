"""The config of `serve`: YAML in, a checked and frozen value out, or every mistake at once with its line."""

from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Ge, Gt, Le
from pydantic import BaseModel, ConfigDict, ValidationError, create_model
from pydantic.fields import FieldInfo

from gyrodrift.errors import ConfigError
from gyrodrift.filter import HdrParams
from gyrodrift.yaml_file import Key, YamlFile, read_yaml

UNITS = {"_dps": " deg/s", "_s": " s", "_hz": " Hz", "_deg": " deg"}


@dataclass(frozen=True, slots=True)
class Config:
    """What `serve` runs with.

    filter
        Name of the filter; `hdr` is the one there is.
    hdr
        Its parameters.
    sample_rate_hz
        The rate the parameters were tuned at, Hz; None where the file does not say.
    """

    filter: str = "hdr"
    hdr: HdrParams = field(default_factory=HdrParams)
    sample_rate_hz: float | None = None

    def changes_from(self, old: "Config") -> list[str]:
        """One `key: old → new` for each value that differs."""
        pairs = [
            ("filter", old.filter, self.filter),
            ("sample_rate_hz", old.sample_rate_hz, self.sample_rate_hz),
        ]
        pairs += [(f"hdr.{f.name}", getattr(old.hdr, f.name), getattr(self.hdr, f.name)) for f in fields(HdrParams)]
        return [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


def _required(params: type) -> type[_Strict]:
    """A model with the fields and bounds of a parameter record, each of which has to be given."""
    hints = get_type_hints(params, include_extras=True)
    required: dict[str, Any] = {f.name: (hints[f.name], ...) for f in fields(params)}
    return create_model(params.__name__, __base__=_Strict, **required)


_Hdr = _required(HdrParams)


class _File(_Strict):
    filter: Literal["hdr"] = "hdr"
    hdr: _Hdr  # type: ignore[valid-type]  # a model made from the parameter record at import
    sample_rate_hz: Annotated[float, Gt(0.0), Le(1e6)] | None = None
    provenance: dict[str, Any] | None = None


def load_config(path: Path) -> Config:
    """Read and check a config file.

    Raises
    ------
    ConfigError
        With every mistake, one line each: `file:line:column key: what is wrong and what is expected`.
    """
    read = read_yaml(path)
    if read.value is None and not read.problems:
        read.report((), "is empty; expected a block hdr: with " + ", ".join(f.name for f in fields(HdrParams)))
    elif read.value is not None and not isinstance(read.value, dict):
        read.report((), f"holds {_said(read.value)}; expected keys such as hdr:")
    file = _check(read) if isinstance(read.value, dict) else None
    if file is None or read.problems:
        raise ConfigError(read.problems)
    return Config(file.filter, HdrParams(**file.hdr.model_dump()), file.sample_rate_hz)  # type: ignore[attr-defined]


def _check(read: YamlFile) -> _File | None:
    try:
        return _File.model_validate(read.value)
    except ValidationError as error:
        for problem in error.errors(include_url=False):
            key: Key = problem["loc"]
            read.report(key, _explain(key, problem["type"], problem["input"]))
        return None


def _explain(key: Key, kind: str, given: Any) -> str:
    model, name = (_Hdr, key[-1]) if len(key) > 1 else (_File, key[-1])
    known = model.model_fields
    if kind == "extra_forbidden":
        nearest = get_close_matches(str(name), known, n=1)
        meant = f"did you mean {nearest[0]}?" if nearest else f"expected {', '.join(known)}"
        return f"is not a key of this file; {meant}"
    expected = _expectation(str(name), known[str(name)]) if str(name) in known else "another value"
    if kind == "missing":
        return f"is missing; expected {expected}"
    return f"is {_said(given)}; expected {expected}"


def _expectation(name: str, info: FieldInfo) -> str:
    if name == "hdr":
        return "a block with " + ", ".join(_Hdr.model_fields)
    if name == "filter":
        return "hdr"
    if name == "provenance":
        return "a block of keys"
    unit = next((unit for suffix, unit in UNITS.items() if name.endswith(suffix)), "")
    low = high = ""
    for bound in _bounds(info):
        match bound:
            case Ge(ge):
                low = f"from {ge:g}"
            case Gt(gt):
                low = f"above {gt:g}"
            case Le(le):
                high = f"{'to' if low.startswith('from') else 'up to'} {le:g}"
    return f"a number {low} {high}{unit}"


def _bounds(info: FieldInfo) -> list[Any]:
    """The bounds of a field; for an optional one they stand inside the union."""
    inner = [
        bound for option in getattr(info.annotation, "__args__", ()) for bound in getattr(option, "__metadata__", ())
    ]
    return [*info.metadata, *inner]


def _said(value: Any) -> str:
    match value:
        case None:
            return "empty"
        case bool():
            return f"{str(value).lower()} (a truth value)"
        case str():
            return f"{value!r} (text)"
        case dict():
            return "a block of keys"
        case list():
            return "a list"
        case _:
            return f"{value:g}"
