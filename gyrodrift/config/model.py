"""The config of `serve`: YAML becomes a checked, frozen value, or a list of all mistakes with their lines."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, get_type_hints

from annotated_types import Gt, Le
from pydantic import ValidationError, create_model
from pydantic.fields import FieldInfo

from firmware_sim.plain_value import Key
from gyrodrift.config.calibration import CALIBRATION, calibration_in
from gyrodrift.config.explain import describe_value, expectation, unknown_key
from gyrodrift.config.outputs import outputs_in
from gyrodrift.config.strict import Strict
from gyrodrift.config.yaml import MOST_PROBLEMS, YamlFile, read_yaml
from gyrodrift.filters.filter import Filter, FilterParams
from gyrodrift.filters.registry import CONFIG_KEYS, DEFAULT, FILTERS
from gyrodrift.filters.run import AXES, Axes
from gyrodrift.io.plug_ins import PlugInError
from gyrodrift.io.public_yaml import public_yaml
from gyrodrift.outputs.options import OutputSpec
from gyrodrift.values.calibration import Calibration
from gyrodrift.values.errors import ConfigError
from gyrodrift.values.mount import AXES as DIRECTIONS
from gyrodrift.values.mount import LEVEL, Mount
from gyrodrift.values.words import did_you_mean, listed


def axes_in(value: Any, report: Callable[[Key, str], None]) -> Axes:
    """Axes from the value of `axes:`; auto if it is absent or wrong."""
    named = {"auto" if value is None else str(value)} & set(AXES) if not isinstance(value, bool) else set()
    if named:
        return named.pop()  # type: ignore[return-value]
    report((), f"is {describe_value(value)}; expected auto, 1 or 3")
    return "auto"


def mount_in(value: Any, report: Callable[[Key, str], None]) -> Mount:
    """Mount from the value of `mount:`; that of a level sensor if it is absent or wrong."""
    if value is None:
        return LEVEL
    if not isinstance(value, dict):
        report((), f"is {describe_value(value)}; expected a block such as {{up: +z, forward: +x}}")
        return LEVEL
    given = {"up": LEVEL.up, "forward": LEVEL.forward}
    for name, direction in value.items():
        if name not in given:
            report((str(name),), unknown_key(str(name), list(given), "a key of mount"))
        elif direction not in DIRECTIONS:
            report((name,), f"is {describe_value(direction)}; expected {listed(DIRECTIONS, 'or')}")
        else:
            given[name] = direction
    try:
        return Mount(**given)
    except ValueError as error:
        report((), str(error))
        return LEVEL


SAMPLE_RATE = "sample_rate_hz"
SLEW = "slew_dps"

SOURCES, AIDS = "sources", "aids"
LINK_KEYS = ("port", "baud", "protocol", "timeout")
"""Block of several gyros with the key of a second source of one, and the keys of each that concern its link."""

LONGEST_COLUMNS = 4096
"""Characters, as in a line of text. The service parses them between two samples."""


@dataclass(frozen=True, slots=True)
class Config:
    """Settings of `serve`.

    filter
        Name of the filter.
    blocks
        Parameters by filter name, for the filters in the file.
    sample_rate_hz
        Sample rate that the parameters were tuned at, Hz; None if the file does not say.
    columns
        Columns of the text protocol, as `--columns` takes them; None for other protocols.
    outputs
        Outputs besides stdout.
    send
        Bytes that are sent to the device after its port was opened.
    calibration
        Calibration of the rate before the filter; None without one.
    axes, mount
        Axes of the filter, and the mount of the sensor on its device.
    slew_dps
        Speed at which `smooth_yaw_deg` takes corrections in, deg/s; None for no such yaw.
    completed
        `key: value` of each default in use, of the filter and of the blocks in the file. A block without `filter:`
        chooses the filter.
    text
        Text of the file, without secrets.
    mode
        Permission bits of the file. Recordings get the same.
    """

    filter: str = DEFAULT.name
    blocks: Mapping[str, FilterParams] = field(default_factory=dict)
    sample_rate_hz: float | None = None
    completed: tuple[str, ...] = ()
    outputs: tuple[OutputSpec, ...] = ()
    columns: str | None = None
    send: bytes = b""
    calibration: Calibration | None = None
    axes: Axes = "auto"
    mount: Mount = LEVEL
    slew_dps: float | None = None
    text: str = field(default="", compare=False, repr=False)
    mode: int = field(default=0o666, compare=False, repr=False)

    @property
    def chosen(self) -> Filter:
        """The chosen filter."""
        return FILTERS[self.filter]

    @property
    def params(self) -> FilterParams:
        """Parameters of the chosen filter."""
        return self.params_of(self.chosen)

    def params_of(self, filter_kind: Filter) -> FilterParams:
        """Parameters of a filter; its defaults if the file has no block for it."""
        params = self.blocks.get(filter_kind.name)
        default: FilterParams = filter_kind.params()
        return default if params is None else params

    def changes_from(self, old: "Config") -> list[str]:
        """Differences, as `key: old → new`."""
        pairs: list[tuple[str, object, object]] = [
            ("filter", old.filter, self.filter),
            (SAMPLE_RATE, old.sample_rate_hz, self.sample_rate_hz),
            (SLEW, old.slew_dps, self.slew_dps),
            ("columns", old.columns, self.columns),
            ("send", old.send or None, self.send or None),
            ("axes", old.axes, self.axes),
            ("mount.up", old.mount.up, self.mount.up),
            ("mount.forward", old.mount.forward, self.mount.forward),
        ]
        for name, filter_kind in FILTERS.loaded.items():
            before, after = old.params_of(filter_kind), self.params_of(filter_kind)
            pairs += [(f"{name}.{key}", getattr(before, key), getattr(after, key)) for key in filter_kind.names]
        changed = [f"{key}: {before} → {after}" for key, before, after in pairs if before != after]
        if self.calibration != old.calibration:
            dates = [
                "none" if calibration is None else calibration.date
                for calibration in (old.calibration, self.calibration)
            ]
            changed.append(f"{CALIBRATION}: {dates[0]} → {dates[1]}")
        gone = [f"outputs: {spec} is closed" for spec in old.outputs if spec not in self.outputs]
        new = [f"outputs: {spec} is opened" for spec in self.outputs if spec not in old.outputs]
        return [*changed, *gone, *new]


@cache
def _block_of(filter_kind: Filter) -> type[Strict]:
    """A model with the fields, bounds and defaults of a filter's parameters."""
    hints, defaults = get_type_hints(filter_kind.params, include_extras=True), filter_kind.params()
    content: dict[str, Any] = {name: (hints[name], getattr(defaults, name)) for name in filter_kind.names}
    return create_model(filter_kind.params.__name__, __base__=Strict, **content)


def _file() -> type[Strict]:
    """The model of a file: every key is optional, and a block may be empty."""
    filters = FILTERS.loaded
    content: dict[str, Any] = {"filter": (Literal[tuple(filters)], DEFAULT.name)}
    content |= {name: (_block_of(filter_kind) | None, None) for name, filter_kind in filters.items()}
    content |= {
        SAMPLE_RATE: (Annotated[float, Gt(0.0), Le(1e6)] | None, None),
        SLEW: (Annotated[float, Gt(0.0), Le(1e6)] | None, None),
        "provenance": (dict[str, Any] | None, None),
        "outputs": (Any, None),
        "columns": (Any, None),
        "send": (Any, None),
        "axes": (Any, None),
        "mount": (Any, None),
        CALIBRATION: (Any, None),
    }
    return create_model("File", __base__=Strict, **content)


def load_config(path: Path, source: str = "") -> Config:
    """Read and check a config file, or its block of a source.

    Without `filter:` the first block by the order of FILTERS chooses the filter; without a block it is the default.

    Raises
    ------
    ConfigError
        With all mistakes as lines `file:line:column key: problem; expected value`.
    """
    read = config_block(path, source)
    named = " or ".join(f"filter: {name}" for name in FILTERS.own)
    if read.value is None and not read.problems:
        read.report((), f"is empty; expected at least {named}")
    elif read.value is not None and not isinstance(read.value, dict):
        content = "text" if isinstance(read.value, str) else describe_value(read.value)  # the text may be a password
        read.report((), f"holds {content}; expected keys such as {named}")
    given = read.value if isinstance(read.value, dict) else {}
    file = _check(read) if isinstance(read.value, dict) and not _broken_plug_ins(read, given) else None
    outputs = outputs_in(given.get("outputs"), _within(read, "outputs"))
    columns = columns_in(given.get("columns"), lambda content: read.report(("columns",), content))
    send = send_in(given.get("send"), lambda content: read.report(("send",), content))
    axes, mount = (
        axes_in(given.get("axes"), _within(read, "axes")),
        mount_in(given.get("mount"), _within(read, "mount")),
    )
    calibration = calibration_in(given.get(CALIBRATION), _within(read, CALIBRATION))
    if file is None or read.problems:
        raise ConfigError(read.problems)
    return replace(
        _config(file, given),
        outputs=outputs,
        columns=columns,
        send=send,
        calibration=calibration,
        axes=axes,
        mount=mount,
        text=public_yaml(read.text),
        mode=read.mode,
    )


def config_block(path: Path, source: str) -> YamlFile:
    """A file, or its block of a source without the keys of the link."""
    read = read_yaml(path)
    if not source:
        if isinstance(read.value, dict) and SOURCES in read.value:
            read.report((SOURCES,), "is for serve without --port; this needs a config of one gyro")
            del read.value[SOURCES]
        return read
    block = read.block((SOURCES, source))
    if isinstance(block.value, dict):
        block.value = {key: value for key, value in block.value.items() if key not in LINK_KEYS}
    elif not read.problems:
        read.report((SOURCES, source), "is missing; restart the service without it")
    return block


def columns_in(value: Any, report: Callable[[str], None], *, is_aid: bool = False) -> str | None:
    """Columns from the value of `columns:`, text as `--columns` takes it or a list of its entries; None if absent.

    `is_aid` for those of a second source.
    """
    if value is None:
        return None
    entries = value if isinstance(value, list) else [value]
    if not all(isinstance(entry, str) for entry in entries):
        wrong = next(entry for entry in entries if not isinstance(entry, str))
        report(f"is {describe_value(wrong)}; expected text such as 't_ms, _, rate:lsb/131', or a list of its entries")
        return None
    from gyrodrift.columns.spec import parsed  # noqa: PLC0415 - few configs have columns

    spec = ", ".join(entries)
    if len(spec) > LONGEST_COLUMNS:
        report(f"are {len(spec)} characters; expected no more than {LONGEST_COLUMNS}")
        return None
    try:
        parsed(spec, is_aid=is_aid)
    except ValueError as error:
        report(str(error))
        return None
    return spec


def send_in(value: Any, report: Callable[[str], None]) -> bytes:
    """Bytes from the value of `send:`, text with escapes as `--send` takes it; empty if absent."""
    if value is None:
        return b""
    if not isinstance(value, str):
        report(rf"is {describe_value(value)}; expected text in quotes such as '\r\n'")
        return b""
    from gyrodrift.link.opening import bytes_to_send  # noqa: PLC0415 - few configs send anything

    try:
        return bytes_to_send(value)
    except ValueError as error:
        report(str(error))
        return b""


def _config(file: Strict, given: Mapping[str, Any]) -> Config:
    """Config from the keys that this module checks; the caller adds the blocks of other modules."""
    content = file.model_dump()
    begun = [name for name in FILTERS.loaded if name in given]
    chosen = content["filter"] if "filter" in given else (begun or [DEFAULT.name])[0]
    completed = [] if "filter" in given or begun else [f"filter: {chosen}"]
    blocks = {}
    for name, filter_kind in FILTERS.loaded.items():
        values = content[name] or {}
        if name in begun:
            blocks[name] = filter_kind.params(**values)
        if name in begun or name == chosen:
            missing = [key for key in filter_kind.names if key not in (given.get(name) or {})]
            completed += [f"{name}.{key}: {getattr(filter_kind.params(**values), key):g}" for key in missing]
    return Config(chosen, blocks, content[SAMPLE_RATE], tuple(completed), slew_dps=content[SLEW])


def _broken_plug_ins(read: YamlFile, given: Mapping[str, Any]) -> bool:
    """Load the filters of other packages that a file names; whether one is broken, which is reported."""
    keys = {key: key for key in given if key not in CONFIG_KEYS} | {str(given.get("filter", DEFAULT.name)): "filter"}
    is_broken = False
    for name, key in keys.items():
        try:
            FILTERS.get(name)
        except PlugInError as error:
            read.report((key,), str(error))
            is_broken = True
    return is_broken


def _within(read: YamlFile, block: str) -> Callable[[Key, str], None]:
    return lambda key, message: read.report((block, *key), message)


def _check(read: YamlFile) -> Strict | None:
    model = _file()
    try:
        return model.model_validate(read.value)
    except ValidationError as error:
        for number, problem in enumerate(error.errors(include_url=False)):
            key: Key = problem["loc"]
            is_told = number < MOST_PROBLEMS
            read.report(key, _explain(model, key, problem["type"], problem["input"]) if is_told else "is wrong, too")
        return None


def _explain(file: type[Strict], key: Key, kind: str, value: Any) -> str:
    block, name = (FILTERS.loaded.get(str(key[0])) if len(key) > 1 else None), str(key[-1])
    model_fields = (_block_of(block) if block else file).model_fields
    if kind == "extra_forbidden":
        return unknown_key(name, list(model_fields), "a key of this file")
    meant = did_you_mean(value, FILTERS) if name == "filter" and isinstance(value, str) else ""
    return f"is {describe_value(value)}; {meant or 'expected ' + _expectation(block, name, model_fields)}"


def _expectation(block: Filter | None, name: str, model_fields: Mapping[str, FieldInfo]) -> str:
    if name not in model_fields:
        return "another value"
    if name in FILTERS.loaded:
        return f"a block with {', '.join(FILTERS[name].names)}"
    if name == "filter":
        return " or ".join(FILTERS)
    if name == "provenance":
        return "a block of keys"
    return expectation(name, model_fields[name], f" {block.parameter(name).unit}".rstrip() if block else None)
