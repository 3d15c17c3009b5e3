"""The config of `serve`: YAML in, a checked and frozen value out, or every mistake at once with its line."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Gt, Le
from pydantic import ValidationError, create_model
from pydantic.fields import FieldInfo

from gyrodrift.config.explain import Strict, expectation, said, unknown_key
from gyrodrift.config.outputs import outputs_in
from gyrodrift.config.yaml import MOST_PROBLEMS, Key, YamlFile, read_yaml
from gyrodrift.errors import ConfigError
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import DEFAULT, FILTERS
from gyrodrift.outputs.options import OutputSpec


@dataclass(frozen=True, slots=True)
class Config:
    """What `serve` runs with.

    filter
        Name of the filter.
    blocks
        Parameters by the name of their filter, of those that the file gives.
    sample_rate_hz
        The rate the parameters were tuned at, Hz; None where the file does not say.
    outputs
        Where corrected samples go beside stdout.
    """

    filter: str = DEFAULT.name
    blocks: Mapping[str, FilterParams] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    outputs: tuple[OutputSpec, ...] = ()

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
        changed = [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]
        gone = [f"outputs: {spec} is closed" for spec in old.outputs if spec not in self.outputs]
        new = [f"outputs: {spec} is opened" for spec in self.outputs if spec not in old.outputs]
        return [*changed, *gone, *new]


@cache
def _block_of(known: Filter) -> type[Strict]:
    """A model with the fields and bounds of a filter's parameters, each of which has to be given."""
    hints = get_type_hints(known.params, include_extras=True)
    required: dict[str, Any] = {name: (hints[name], ...) for name in known.names}
    return create_model(known.params.__name__, __base__=Strict, **required)


def _file_of(named: Filter) -> type[Strict]:
    """The model of a file that names this filter: its block has to be there, those of the others may."""
    blocks = {name: _block_of(known) for name, known in FILTERS.items()}
    content: dict[str, Any] = {"filter": (Literal[tuple(FILTERS)], DEFAULT.name)}
    content |= {name: (block | None, None) for name, block in blocks.items()}
    content |= {
        "sample_rate_hz": (Annotated[float, Gt(0.0), Le(1e6)] | None, None),
        "provenance": (dict[str, Any] | None, None),
        "outputs": (Any, None),
        named.name: (blocks[named.name], ...),
    }
    return create_model("File", __base__=Strict, **content)


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
        read.report((), f"holds {said(read.value)}; expected keys such as {DEFAULT.name}:")
    file = _check(read) if isinstance(read.value, dict) else None
    outputs = outputs_in(read.value.get("outputs"), _in_outputs(read)) if isinstance(read.value, dict) else ()
    if file is None or read.problems:
        raise ConfigError(read.problems)
    content = file.model_dump()
    blocks = {name: known.params(**content[name]) for name, known in FILTERS.items() if content[name] is not None}
    return Config(content["filter"], blocks, content["sample_rate_hz"], outputs)


def _in_outputs(read: YamlFile) -> Callable[[Key, str], None]:
    return lambda key, what: read.report(("outputs", *key), what)


def _check(read: YamlFile) -> Strict | None:
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


def _explain(file: type[Strict], key: Key, kind: str, given: Any) -> str:
    model, name = (_block_of(FILTERS[str(key[0])]), key[-1]) if len(key) > 1 else (file, key[-1])
    known = model.model_fields
    if kind == "extra_forbidden":
        return unknown_key(str(name), list(known), "a key of this file")
    expected = _expectation(str(name), known[str(name)]) if str(name) in known else "another value"
    if kind == "missing":
        return f"is missing; expected {expected}"
    return f"is {said(given)}; expected {expected}"


def _expectation(name: str, info: FieldInfo) -> str:
    if name in FILTERS:
        return f"a block with {', '.join(FILTERS[name].names)}"
    if name == "filter":
        return " or ".join(FILTERS)
    if name == "provenance":
        return "a block of keys"
    return expectation(name, info)
