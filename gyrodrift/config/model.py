"""The config of `serve`: YAML in, a checked and frozen value out, or every mistake at once with its line."""

from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel, ConfigDict, ValidationError, create_model
from pydantic.fields import FieldInfo

from gyrodrift.config.yaml import Key, YamlFile, read_yaml
from gyrodrift.errors import ConfigError
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.registry import FILTERS, HDR, Filter, Params
from gyrodrift.filters.restlevel.model import RestlevelParams

UNITS = {"_dps": " deg/s", "_s": " s", "_hz": " Hz", "_deg": " deg"}


@dataclass(frozen=True, slots=True)
class Config:
    """What `serve` runs with.

    filter
        Name of the filter.
    hdr, restlevel
        Parameters of each filter; those of one that is not named may be the defaults.
    sample_rate_hz
        The rate the parameters were tuned at, Hz; None where the file does not say.
    """

    filter: str = HDR.name
    hdr: HdrParams = field(default_factory=HdrParams)
    sample_rate_hz: float | None = None
    restlevel: RestlevelParams = field(default_factory=RestlevelParams)

    @property
    def chosen(self) -> Filter:
        """The filter that is named."""
        return FILTERS[self.filter]

    @property
    def params(self) -> Params:
        """Its parameters."""
        return self.hdr if self.chosen is HDR else self.restlevel

    def changes_from(self, old: "Config") -> list[str]:
        """One `key: old → new` for each value that differs."""
        pairs: list[tuple[str, object, object]] = [
            ("filter", old.filter, self.filter),
            ("sample_rate_hz", old.sample_rate_hz, self.sample_rate_hz),
        ]
        for name, known in FILTERS.items():
            before, after = getattr(old, name), getattr(self, name)
            pairs += [
                (f"{name}.{f.name}", getattr(before, f.name), getattr(after, f.name)) for f in fields(known.params)
            ]
        return [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


def _required(params: type) -> type[_Strict]:
    """A model with the fields and bounds of a parameter record, each of which has to be given."""
    hints = get_type_hints(params, include_extras=True)
    required: dict[str, Any] = {f.name: (hints[f.name], ...) for f in fields(params)}
    return create_model(params.__name__, __base__=_Strict, **required)


_BLOCKS = {name: _required(known.params) for name, known in FILTERS.items()}


class _File(_Strict):
    filter: Literal["hdr", "restlevel"] = "hdr"
    hdr: _BLOCKS["hdr"] | None = None  # type: ignore[valid-type,name-defined]  # a model made at import
    restlevel: _BLOCKS["restlevel"] | None = None  # type: ignore[valid-type,name-defined]
    sample_rate_hz: Annotated[float, Gt(0.0), Le(1e6)] | None = None
    provenance: dict[str, Any] | None = None


def _naming(name: str) -> type[_File]:
    """The model of a file that names this filter: its block has to be there."""
    block: dict[str, Any] = {name: (_BLOCKS[name], ...)}
    return create_model("File", __base__=_File, **block)


_FILES = {name: _naming(name) for name in FILTERS}


def load_config(path: Path) -> Config:
    """Read and check a config file.

    Raises
    ------
    ConfigError
        With every mistake, one line each: `file:line:column key: what is wrong and what is expected`.
    """
    read = read_yaml(path)
    if read.value is None and not read.problems:
        read.report((), f"is empty; expected a block hdr: with {_names(_BLOCKS[HDR.name])}")
    elif read.value is not None and not isinstance(read.value, dict):
        read.report((), f"holds {_said(read.value)}; expected keys such as hdr:")
    file = _check(read) if isinstance(read.value, dict) else None
    if file is None or read.problems:
        raise ConfigError(read.problems)
    given = {name: getattr(file, name) for name in FILTERS}
    blocks = {name: FILTERS[name].params(**block.model_dump()) for name, block in given.items() if block is not None}
    return Config(file.filter, sample_rate_hz=file.sample_rate_hz, **blocks)


def _check(read: YamlFile) -> _File | None:
    named = read.value.get("filter")
    model = _FILES[named if isinstance(named, str) and named in FILTERS else HDR.name]
    try:
        return model.model_validate(read.value)
    except ValidationError as error:
        for problem in error.errors(include_url=False):
            key: Key = problem["loc"]
            read.report(key, _explain(key, problem["type"], problem["input"]))
        return None


def _explain(key: Key, kind: str, given: Any) -> str:
    model, name = (_BLOCKS[str(key[0])], key[-1]) if len(key) > 1 else (_File, key[-1])
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
    if name in _BLOCKS:
        return f"a block with {_names(_BLOCKS[name])}"
    if name == "filter":
        return " or ".join(FILTERS)
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
            case Lt(lt):
                high = f"below {lt:g}" if not low else f"to below {lt:g}"
    return f"a number {low} {high}{unit}"


def _names(model: type[_Strict]) -> str:
    return ", ".join(model.model_fields)


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
