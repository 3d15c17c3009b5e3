"""The config of `serve`: YAML in, a checked and frozen value out, or every mistake at once with its line."""

from collections.abc import Iterable, Mapping
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

SAMPLE_RATE = "sample_rate_hz"


@dataclass(frozen=True, slots=True)
class Config:
    """What `serve` runs with.

    filter
        Name of the filter.
    blocks
        Parameters by the name of their filter, of those that the file gives.
    sample_rate_hz
        The rate the parameters were tuned at, Hz; None where the file does not say.
    completed
        One `key: value` for each that the file leaves to its default, of the filter and of blocks that are begun; a
        block says which filter is meant.
    """

    filter: str = DEFAULT.name
    blocks: Mapping[str, FilterParams] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    completed: tuple[str, ...] = ()

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
            (SAMPLE_RATE, old.sample_rate_hz, self.sample_rate_hz),
        ]
        for name, known in FILTERS.items():
            before, after = old.params_of(known), self.params_of(known)
            pairs += [(f"{name}.{key}", getattr(before, key), getattr(after, key)) for key in known.names]
        return [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]


class _Strict(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False)


@cache
def _block_of(known: Filter) -> type[_Strict]:
    """A model with the fields, bounds and defaults of a filter's parameters."""
    hints, defaults = get_type_hints(known.params, include_extras=True), known.params()
    content: dict[str, Any] = {name: (hints[name], getattr(defaults, name)) for name in known.names}
    return create_model(known.params.__name__, __base__=_Strict, **content)


def _file() -> type[_Strict]:
    """The model of a file: every key may be left out, and a block may be empty."""
    content: dict[str, Any] = {"filter": (Literal[tuple(FILTERS)], DEFAULT.name)}
    content |= {name: (_block_of(known) | None, None) for name, known in FILTERS.items()}
    content |= {
        SAMPLE_RATE: (Annotated[float, Gt(0.0), Le(1e6)] | None, None),
        "provenance": (dict[str, Any] | None, None),
    }
    return create_model("File", __base__=_Strict, **content)


def load_config(path: Path) -> Config:
    """Read and check a config file.

    A file without `filter` means that of its blocks which stands first in FILTERS, or the default.

    Raises
    ------
    ConfigError
        With every mistake, one line each: `file:line:column key: what is wrong and what is expected`.
    """
    read = read_yaml(path)
    named = " or ".join(f"filter: {name}" for name in FILTERS)
    if read.value is None and not read.problems:
        read.report((), f"is empty; expected at least {named}")
    elif read.value is not None and not isinstance(read.value, dict):
        read.report((), f"holds {_said(read.value)}; expected keys such as {named}")
    file = _check(read) if isinstance(read.value, dict) else None
    if file is None or read.problems:
        raise ConfigError(read.problems)
    return _config(file, read.value)


def _config(file: _Strict, given: Mapping[str, Any]) -> Config:
    content = file.model_dump()
    begun = [name for name in FILTERS if name in given]
    chosen = content["filter"] if "filter" in given else (begun or [DEFAULT.name])[0]
    completed = [] if "filter" in given or begun else [f"filter: {chosen}"]
    blocks = {}
    for name, known in FILTERS.items():
        values = content[name] or {}
        if name in begun:
            blocks[name] = known.params(**values)
        if name in begun or name == chosen:
            left = [key for key in known.names if key not in (given.get(name) or {})]
            completed += [f"{name}.{key}: {getattr(known.params(**values), key):g}" for key in left]
    return Config(chosen, blocks, content[SAMPLE_RATE], tuple(completed))


def _check(read: YamlFile) -> _Strict | None:
    model = _file()
    try:
        return model.model_validate(read.value)
    except ValidationError as error:
        for number, problem in enumerate(error.errors(include_url=False)):
            key: Key = problem["loc"]
            is_told = number < MOST_PROBLEMS
            read.report(key, _explain(model, key, problem["type"], problem["input"]) if is_told else "is wrong too")
        return None


def _explain(file: type[_Strict], key: Key, kind: str, given: Any) -> str:
    block, name = (FILTERS.get(str(key[0])) if len(key) > 1 else None), str(key[-1])
    known = (_block_of(block) if block else file).model_fields
    if kind == "extra_forbidden":
        return f"is not a key of this file; {_meant(name, known) or 'expected ' + ', '.join(known)}"
    meant = _meant(given, FILTERS) if name == "filter" and isinstance(given, str) else ""
    return f"is {_said(given)}; {meant or 'expected ' + _expectation(block, name, known)}"


def _meant(word: str, known: Iterable[str]) -> str:
    """The nearest of what is known, in whichever case it was written; empty where nothing is near."""
    names = {name.lower(): name for name in known}
    nearest = get_close_matches(word.lower(), names, n=1)
    return f"did you mean {names[nearest[0]]}?" if nearest else ""


def _expectation(block: Filter | None, name: str, known: Mapping[str, FieldInfo]) -> str:
    if name not in known:
        return "another value"
    if name in FILTERS:
        return f"a block with {', '.join(FILTERS[name].names)}"
    if name == "filter":
        return " or ".join(FILTERS)
    if name == "provenance":
        return "a block of keys"
    unit = block.parameter(name).unit if block else "Hz"
    low = high = ""
    for bound in _bounds(known[name]):
        match bound:
            case Ge(ge):
                low = f"from {ge:g}"
            case Gt(gt):
                low = f"above {gt:g}"
            case Le(le):
                high = f"{'to' if low.startswith('from') else 'up to'} {le:g}"
            case Lt(lt):
                high = f"below {lt:g}" if not low else f"to below {lt:g}"
    return f"a number {low} {high} {unit}".rstrip()


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
