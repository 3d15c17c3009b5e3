"""The config of `serve`: YAML in, a checked and frozen value out, or every mistake at once with its line."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Ge, Gt, Le, Lt
from pydantic import BaseModel, ConfigDict, ValidationError, create_model
from pydantic.fields import FieldInfo

from gyrodrift.config.yaml import MOST_PROBLEMS, Key, YamlFile, read_yaml
from gyrodrift.errors import ConfigError
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import DEFAULT, FILTERS

UNITS = {"_dps": " deg/s", "_s": " s", "_hz": " Hz", "_deg": " deg"}


@dataclass(frozen=True, slots=True)
class Config:
    """What `serve` runs with.

    filter
        Name of the filter.
    blocks
        Parameters by the name of their filter, of those that the file gives.
    sample_rate_hz
        The rate the parameters were tuned at, Hz; None where the file does not say.
    """

    filter: str = DEFAULT.name
    blocks: Mapping[str, FilterParams] = field(default_factory=dict)
    sample_rate_hz: float | None = None

    @property
    def chosen(self) -> Filter:
        """The filter that is named."""
        return FILTERS[self.filter]

    @property
    def params(self) -> FilterParams:
        """Its parameters."""
        return self.params_of(self.chosen)

    def params_of(self, known: Filter) -> FilterParams:
        """Parameters of a filter; its defaults where the file gives none."""
        given = self.blocks.get(known.name)
        default: FilterParams = known.params()
        return default if given is None else given

    def changes_from(self, old: "Config") -> list[str]:
        """One `key: old → new` for each value that differs."""
        pairs: list[tuple[str, object, object]] = [
            ("filter", old.filter, self.filter),
            ("sample_rate_hz", old.sample_rate_hz, self.sample_rate_hz),
        ]
        for name, known in FILTERS.items():
            before, after = old.params_of(known), self.params_of(known)
            pairs += [(f"{name}.{key}", getattr(before, key), getattr(after, key)) for key in known.names]
        return [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


@cache
def _block_of(known: Filter) -> type[_Strict]:
    """A model with the fields and bounds of a filter's parameters, each of which has to be given."""
    hints = get_type_hints(known.params, include_extras=True)
    required: dict[str, Any] = {name: (hints[name], ...) for name in known.names}
    return create_model(known.params.__name__, __base__=_Strict, **required)


def _file_of(named: Filter) -> type[_Strict]:
    """The model of a file that names this filter: its block has to be there, those of the others may."""
    blocks = {name: _block_of(known) for name, known in FILTERS.items()}
    content: dict[str, Any] = {"filter": (Literal[tuple(FILTERS)], DEFAULT.name)}
    content |= {name: (block | None, None) for name, block in blocks.items()}
    content |= {
        "sample_rate_hz": (Annotated[float, Gt(0.0), Le(1e6)] | None, None),
        "provenance": (dict[str, Any] | None, None),
        named.name: (blocks[named.name], ...),
    }
    return create_model("File", __base__=_Strict, **content)


def load_config(path: Path) -> Config:
    """Read and check a config file.

    Raises
    ------
    ConfigError
        With every mistake, one line each: `file:line:column key: what is wrong and what is expected`.
    """
    read = read_yaml(path)
    if read.value is None and not read.problems:
        read.report((), f"is empty; expected a block {DEFAULT.name}: with {', '.join(DEFAULT.names)}")
    elif read.value is not None and not isinstance(read.value, dict):
        read.report((), f"holds {_said(read.value)}; expected keys such as {DEFAULT.name}:")
    file = _check(read) if isinstance(read.value, dict) else None
    if file is None or read.problems:
        raise ConfigError(read.problems)
    content = file.model_dump()
    blocks = {name: known.params(**content[name]) for name, known in FILTERS.items() if content[name] is not None}
    return Config(content["filter"], blocks, content["sample_rate_hz"])


def _check(read: YamlFile) -> _Strict | None:
    named = read.value.get("filter")
    model = _file_of(FILTERS[named] if isinstance(named, str) and named in FILTERS else DEFAULT)
    try:
        return model.model_validate(read.value)
    except ValidationError as error:
        for number, problem in enumerate(error.errors(include_url=False)):
            key: Key = problem["loc"]
            is_told = number < MOST_PROBLEMS
            read.report(key, _explain(model, key, problem["type"], problem["input"]) if is_told else "is wrong too")
        return None


def _explain(file: type[_Strict], key: Key, kind: str, given: Any) -> str:
    model, name = (_block_of(FILTERS[str(key[0])]), key[-1]) if len(key) > 1 else (file, key[-1])
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
    if name in FILTERS:
        return f"a block with {', '.join(FILTERS[name].names)}"
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
