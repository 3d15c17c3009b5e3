"""The config of `serve`: YAML in, a checked and frozen value out, or every mistake at once with its line."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Gt, Le
from pydantic import ValidationError, create_model
from pydantic.fields import FieldInfo

from gyrodrift.calibration import Calibration
from gyrodrift.config.calibration import CALIBRATION, calibration_in
from gyrodrift.config.explain import Strict, expectation, said, unknown_key
from gyrodrift.config.outputs import outputs_in
from gyrodrift.config.yaml import MOST_PROBLEMS, Key, YamlFile, read_yaml
from gyrodrift.errors import ConfigError
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import DEFAULT, FILTERS
from gyrodrift.nearest import did_you_mean
from gyrodrift.outputs.options import OutputSpec
from gyrodrift.public_yaml import public_yaml

SAMPLE_RATE = "sample_rate_hz"

LONGEST_COLUMNS = 4096
"""Characters, as of a line of text; columns are read once more by the service, between two samples."""


@dataclass(frozen=True, slots=True)
class Config:
    """What `serve` runs with.

    filter
        Name of the filter.
    blocks
        Parameters by the name of their filter, of those that the file gives.
    sample_rate_hz
        The rate the parameters were tuned at, Hz; None where the file does not say.
    columns
        Of the text protocol, as `--columns` takes them; None where another one is spoken.
    outputs
        Where corrected samples go beside stdout.
    send
        What a device is sent after its port was opened; empty for nothing.
    calibration
        What puts the rate right before the filter; None where the file gives none.
    completed
        One `key: value` for each that the file leaves to its default, of the filter and of blocks that are begun; a
        block says which filter is meant.
    text
        The file as it was read, without secrets.
    mode
        Who may read the file; nobody else may read what is recorded with it.
    """

    filter: str = DEFAULT.name
    blocks: Mapping[str, FilterParams] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    completed: tuple[str, ...] = ()
    outputs: tuple[OutputSpec, ...] = ()
    columns: str | None = None
    send: bytes = b""
    calibration: Calibration | None = None
    text: str = field(default="", compare=False, repr=False)
    mode: int = field(default=0o666, compare=False, repr=False)

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
            ("columns", old.columns, self.columns),
            ("send", old.send or None, self.send or None),
        ]
        for name, known in FILTERS.items():
            before, after = old.params_of(known), self.params_of(known)
            pairs += [(f"{name}.{key}", getattr(before, key), getattr(after, key)) for key in known.names]
        changed = [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]
        if self.calibration != old.calibration:
            dates = ["none" if each is None else each.date for each in (old.calibration, self.calibration)]
            changed.append(f"{CALIBRATION}: {dates[0]} → {dates[1]}")
        gone = [f"outputs: {spec} is closed" for spec in old.outputs if spec not in self.outputs]
        new = [f"outputs: {spec} is opened" for spec in self.outputs if spec not in old.outputs]
        return [*changed, *gone, *new]


@cache
def _block_of(known: Filter) -> type[Strict]:
    """A model with the fields, bounds and defaults of a filter's parameters."""
    hints, defaults = get_type_hints(known.params, include_extras=True), known.params()
    content: dict[str, Any] = {name: (hints[name], getattr(defaults, name)) for name in known.names}
    return create_model(known.params.__name__, __base__=Strict, **content)


def _file() -> type[Strict]:
    """The model of a file: every key may be left out, and a block may be empty."""
    content: dict[str, Any] = {"filter": (Literal[tuple(FILTERS)], DEFAULT.name)}
    content |= {name: (_block_of(known) | None, None) for name, known in FILTERS.items()}
    content |= {
        SAMPLE_RATE: (Annotated[float, Gt(0.0), Le(1e6)] | None, None),
        "provenance": (dict[str, Any] | None, None),
        "outputs": (Any, None),
        "columns": (Any, None),
        "send": (Any, None),
        CALIBRATION: (Any, None),
    }
    return create_model("File", __base__=Strict, **content)


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
        what = "text" if isinstance(read.value, str) else said(read.value)  # it may be a file with a password
        read.report((), f"holds {what}; expected keys such as {named}")
    file = _check(read) if isinstance(read.value, dict) else None
    given = read.value if isinstance(read.value, dict) else {}
    outputs = outputs_in(given.get("outputs"), _within(read, "outputs"))
    columns = columns_in(given.get("columns"), lambda what: read.report(("columns",), what))
    send = send_in(given.get("send"), lambda what: read.report(("send",), what))
    calibration = calibration_in(given.get(CALIBRATION), _within(read, CALIBRATION))
    if file is None or read.problems:
        raise ConfigError(read.problems)
    return replace(
        _config(file, given),
        outputs=outputs,
        columns=columns,
        send=send,
        calibration=calibration,
        text=public_yaml(read.text),
        mode=read.mode,
    )


def columns_in(given: Any, report: Callable[[str], None]) -> str | None:
    """Of the value of `columns:`, as `--columns` takes them or as a list of the entries; None where there are none."""
    if given is None:
        return None
    entries = given if isinstance(given, list) else [given]
    if not all(isinstance(entry, str) for entry in entries):
        wrong = next(entry for entry in entries if not isinstance(entry, str))
        report(f"is {said(wrong)}; expected text such as 't_ms, _, rate:lsb/131', or a list of its entries")
        return None
    from gyrodrift.columns.spec import parsed  # noqa: PLC0415 - few configs have columns

    spec = ", ".join(entries)
    if len(spec) > LONGEST_COLUMNS:
        report(f"are {len(spec)} characters; expected no more than {LONGEST_COLUMNS}")
        return None
    try:
        parsed(spec)
    except ValueError as error:
        report(str(error))
        return None
    return spec


def send_in(given: Any, report: Callable[[str], None]) -> bytes:
    """Of the value of `send:`, a text with escapes as `--send` takes it; empty where there is none."""
    if given is None:
        return b""
    if not isinstance(given, str):
        report(rf"is {said(given)}; expected text in quotes such as '\r\n'")
        return b""
    from gyrodrift.link.opening import bytes_to_send  # noqa: PLC0415 - few configs send anything

    try:
        return bytes_to_send(given)
    except ValueError as error:
        report(str(error))
        return b""


def _config(file: Strict, given: Mapping[str, Any]) -> Config:
    """Of what stands in the file itself; blocks that have modules of their own are added by the caller."""
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


def _within(read: YamlFile, block: str) -> Callable[[Key, str], None]:
    return lambda key, what: read.report((block, *key), what)


def _check(read: YamlFile) -> Strict | None:
    model = _file()
    try:
        return model.model_validate(read.value)
    except ValidationError as error:
        for number, problem in enumerate(error.errors(include_url=False)):
            key: Key = problem["loc"]
            is_told = number < MOST_PROBLEMS
            read.report(key, _explain(model, key, problem["type"], problem["input"]) if is_told else "is wrong too")
        return None


def _explain(file: type[Strict], key: Key, kind: str, given: Any) -> str:
    block, name = (FILTERS.get(str(key[0])) if len(key) > 1 else None), str(key[-1])
    known = (_block_of(block) if block else file).model_fields
    if kind == "extra_forbidden":
        return unknown_key(name, list(known), "a key of this file")
    meant = did_you_mean(given, FILTERS) if name == "filter" and isinstance(given, str) else ""
    return f"is {said(given)}; {meant or 'expected ' + _expectation(block, name, known)}"


def _expectation(block: Filter | None, name: str, known: Mapping[str, FieldInfo]) -> str:
    if name not in known:
        return "another value"
    if name in FILTERS:
        return f"a block with {', '.join(FILTERS[name].names)}"
    if name == "filter":
        return " or ".join(FILTERS)
    if name == "provenance":
        return "a block of keys"
    return expectation(name, known[name], f" {block.parameter(name).unit}".rstrip() if block else None)
