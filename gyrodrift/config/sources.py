"""Several gyros in one config: the block `sources:` with a name, a link and settings for each."""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gyrodrift.config.explain import describe_value, unknown_key
from gyrodrift.config.model import AIDS, LINK_KEYS, SOURCES, columns_in
from gyrodrift.config.yaml import YamlFile, read_yaml
from gyrodrift.values.errors import ConfigError

NAME = re.compile(r"[A-Za-z][A-Za-z0-9_-]{0,31}")
"""Name of a source: it becomes a folder, a part of file names and of topics."""

MOST_SOURCES = 32
"""Largest number of sources; ten of 1 kHz use a processor. Chosen."""

LONGEST_TIMEOUT_S = 86_400.0
SHARED_PORTS = ("tcp://", "ws://", "wss://", "mqtt://", "mqtts://")
"""Servers of several clients, which several sources may read: each takes the lines of another sender."""


@dataclass(frozen=True, slots=True)
class SourceSettings:
    """Link of a source; its filter, calibration and outputs are in the `Config` of its block.

    aids
        Name of the gyro for which it is a second source; empty for a gyro.
    columns, late_s
        SPEC of a second source, None for known messages, and the delay of its messages, s.
    """

    name: str
    port: str
    baud: int | None = None
    protocol: str = "auto"
    timeout_s: float = 0.0
    aids: str = ""
    columns: str | None = None
    late_s: float = 0.0


AID_KEYS = ("port", "baud", AIDS, "columns", "late")
"""Keys of a second source."""

LONGEST_LATE_S = 10.0
"""Longest delay of a second source, s. Chosen: a filter keeps its last seconds."""


def load_sources(path: Path) -> tuple[SourceSettings, ...]:
    """Links of the sources in a config; empty for a config of one gyro.

    Raises
    ------
    ConfigError
        With all mistakes of the block `sources:`.
    """
    read = read_yaml(path)
    if not isinstance(read.value, dict) or SOURCES not in read.value:
        return ()
    for key in read.value.keys() - {SOURCES, "provenance"}:
        read.report((key,), f"belongs to a source; move it below {SOURCES}: NAME:")
    settings = _all_settings(read, read.value[SOURCES])
    if read.problems:
        raise ConfigError(read.problems)
    return settings


def _all_settings(read: YamlFile, value: Any) -> tuple[SourceSettings, ...]:
    if not isinstance(value, dict) or not 0 < len(value) <= MOST_SOURCES:
        read.report((SOURCES,), f"is {describe_value(value)}; expected 1 to {MOST_SOURCES} blocks NAME: {{port: …}}")
        return ()
    settings = [_settings(read, name, block) for name, block in value.items()]
    ports = [entry.port for entry in settings if entry is not None]
    for entry in settings:
        if entry is not None and ports.count(entry.port) > 1 and not entry.port.startswith(SHARED_PORTS):
            read.report((SOURCES, entry.name, "port"), "is used by two sources; each needs its own")
    gyros = [entry.name for entry in settings if entry is not None and not entry.aids]
    for entry in settings:
        if entry is not None and entry.aids and entry.aids not in gyros:
            expected = f"one of {', '.join(gyros)}" if gyros else "a block of a gyro beside it"
            read.report((SOURCES, entry.name, AIDS), f"is {describe_value(entry.aids)}; expected {expected}")
    return tuple(entry for entry in settings if entry is not None)


def _settings(read: YamlFile, name: str, block: Any) -> SourceSettings | None:
    if NAME.fullmatch(name) is None:
        read.report((SOURCES, name), "is no name; expected up to 32 letters, digits, _ and -, a letter first")
        return None
    if not isinstance(block, dict) or not isinstance(block.get("port"), str):
        read.report((SOURCES, name), "has no port; expected port: with a path or a source such as tcp://HOST:PORT")
        return None
    if AIDS in block:
        return _second_source(read, name, block)
    baud, protocol, timeout_s = (block.get(key) for key in LINK_KEYS[1:])
    if baud is not None and not (isinstance(baud, int) and not isinstance(baud, bool) and baud > 0):
        read.report((SOURCES, name, "baud"), f"is {describe_value(baud)}; expected a whole number above 0")
    elif timeout_s is not None and not (_is_number(timeout_s) and 0.0 <= timeout_s <= LONGEST_TIMEOUT_S):
        read.report((SOURCES, name, "timeout"), f"is {describe_value(timeout_s)}; expected s, 0 waits for ever")
    elif protocol is not None and not _is_protocol(protocol):
        message = unknown_key(str(protocol), _protocols(), "a protocol")
        read.report((SOURCES, name, "protocol"), message)
    else:
        return SourceSettings(name, block["port"], baud, protocol or "auto", float(timeout_s or 0.0))
    return None


def _second_source(read: YamlFile, name: str, block: dict[str, Any]) -> SourceSettings | None:
    """Settings of a source that aids a gyro."""
    keys, baud, late_s = (SOURCES, name), block.get("baud"), block.get("late", 0.0)
    before = len(read.problems)
    for key in block.keys() - set(AID_KEYS):
        read.report((*keys, key), unknown_key(str(key), list(AID_KEYS), f"a key of a source with {AIDS}:"))
    if baud is not None and not (isinstance(baud, int) and not isinstance(baud, bool) and baud > 0):
        read.report((*keys, "baud"), f"is {describe_value(baud)}; expected a whole number above 0")
    if not (_is_number(late_s) and 0.0 <= late_s <= LONGEST_LATE_S):
        read.report((*keys, "late"), f"is {describe_value(late_s)}; expected s from 0 to {LONGEST_LATE_S:g}")
    columns = columns_in(block.get("columns"), lambda text: read.report((*keys, "columns"), text), is_aid=True)
    if len(read.problems) > before:
        return None
    return SourceSettings(name, block["port"], baud, aids=str(block[AIDS]), columns=columns, late_s=float(late_s))


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)


def _is_protocol(name: Any) -> bool:
    from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS  # noqa: PLC0415 - few configs name a protocol

    return isinstance(name, str) and (name == AUTO or name in PROTOCOLS)


def _protocols() -> list[str]:
    from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS  # noqa: PLC0415 - few configs name a protocol

    return [AUTO, *PROTOCOLS]
