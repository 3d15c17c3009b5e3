"""The config that a command uses, the link that it opens, and the tables that a recording keeps of both."""

import argparse
import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.cli.options import AUTO_PORT
from gyrodrift.filters.registry import DEFAULT

if TYPE_CHECKING:
    from gyrodrift.config.model import Config
    from gyrodrift.link.options import EventHandler, LinkOptions
    from gyrodrift.link.serial_port import SerialPort
    from gyrodrift.link.sources.source import SourcePort


def reads_columns_of_config(arguments: argparse.Namespace) -> bool:
    """Whether the config states the columns of text lines, and not an option."""
    return arguments.columns is None and arguments.protocol in ("auto", "text")


def link_target(
    arguments: argparse.Namespace,
    baud: int | None,
    on_event: "EventHandler",
    columns: str | None = None,
    send: bytes = b"",
) -> "tuple[LinkOptions, SourcePort | None]":
    """Link options of a command; with `--port auto` also the open port of the only gyro.

    `columns` and `send` come from the config. The options --columns, --protocol and --send take precedence.
    """
    from gyrodrift.link.options import LinkOptions

    spec = columns if reads_columns_of_config(arguments) else arguments.columns
    stated = LinkOptions(arguments.port, baud, arguments.protocol, arguments.timeout, spec, arguments.send or send)
    if stated.port != AUTO_PORT:
        return stated, None
    from gyrodrift.link.port import serial_ports
    from gyrodrift.link.search import find_gyro
    from gyrodrift.link.sources.registry import source_devices

    return find_gyro(serial_ports(), stated, on_event, simulated_ports(), source_devices())


def simulated_ports() -> "list[SerialPort]":
    """Links of the simulated devices that run on this machine."""
    from firmware_sim.reservation import reserved_links
    from gyrodrift.link.serial_port import SerialPort

    links = [link for link in reserved_links() if link.is_symlink()]
    return [SerialPort(str(link), os.path.realpath(link), product="simulated device") for link in links]


def chosen_config(arguments: argparse.Namespace) -> "Config":
    """Config of --config, or of a filter at its defaults; prints the defaults in use."""
    from gyrodrift.config.model import Config

    return Config(arguments.filter or DEFAULT.name) if arguments.config is None else loaded_config(arguments.config)


def config_tables(path: Path, config: "Config") -> dict[str, dict[str, str]]:
    """Metadata of a recording about its config: the text, and the calibration of its rates."""
    return {"config": {"file": str(path), "text": config.text}, **calibration_tables(config)}


def calibration_tables(config: "Config") -> dict[str, dict[str, str]]:
    """Metadata of a recording about its calibration; an empty table ends an earlier calibration."""
    return {"calibration": {} if config.calibration is None else config.calibration.table()}


def loaded_config(path: Path) -> "Config":
    """Load a config once, and print the defaults in use."""
    from gyrodrift.config.model import load_config

    config = load_config(path)
    if config.completed:
        print(f"gyrodrift: {path}: defaults are {', '.join(config.completed)}", file=sys.stderr)
    return config
