"""List the serial ports of this machine: stable name, device, maker, product, and the program that uses it.

Devices of other sources are listed, too, where this machine can find them; their names are what --port takes. With
--listen it also opens the free ports and shows protocol, sample rate and baud rate; many boards reset when their port
is opened. Simulated devices are listed, too. ttyS names without a UART are not.
"""

import argparse
import dataclasses
import json
import sys
from typing import Any

from gyrodrift.cli import numbers, options
from gyrodrift.cli.configs import simulated_ports
from gyrodrift.cli.plug_ins import tell_problems
from gyrodrift.link.listening import HeardPort, listen_at, look_at
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.port import serial_ports
from gyrodrift.link.search import speech_text
from gyrodrift.link.sources.registry import source_devices

EXAMPLES = """\
gyrodrift devices
gyrodrift devices --listen
gyrodrift devices --listen --json
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--listen", action="store_true", help="open each free port, and show protocol and sample rate")
    parser.add_argument(
        "--timeout",
        type=numbers.duration,
        default=10.0,
        metavar="S",
        help="time to wait for samples at each port",
    )
    options.add_send_option(parser)
    parser.add_argument("--json", action="store_true", help="print one JSON array, with an object per port")


def run(arguments: argparse.Namespace) -> int:
    """List the ports; 0 even without any."""
    ports = [*serial_ports(), *source_devices(), *simulated_ports()]
    link_options = LinkOptions(port="", timeout_s=arguments.timeout, send=arguments.send or b"")
    heard = listen_at(ports, link_options) if arguments.listen else look_at(ports)
    tell_problems("gyrodrift.sources", "gyrodrift.protocols")
    if arguments.json:
        print(json.dumps([_as_json(port) for port in heard]))
    elif heard:
        print("\n".join(map(_rows, heard)))
    else:
        print("gyrodrift: no serial port is plugged in", file=sys.stderr)
    return 0


def _rows(heard: HeardPort) -> str:
    port = heard.port
    adapter = " ".join(filter(None, (port.maker, port.product, port.usb_id and f"({port.usb_id})")))
    rows = {
        "device": port.device if port.device != port.name else "",
        "adapter": adapter,
        "serial number": port.serial_number or "",
        "in use by": str(heard.holder or ""),
        "speaks": speech_text(heard.speech) if heard.speech else "",
        "nothing heard": heard.reason if heard.holder is None else "",
    }
    return "\n".join([port.name, *(f"  {name:13}  {value}" for name, value in rows.items() if value)])


def _as_json(heard: HeardPort) -> dict[str, Any]:
    speech, holder = heard.speech, heard.holder
    return dataclasses.asdict(heard.port) | {
        "holder": dataclasses.asdict(holder) if holder else None,
        "speech": dataclasses.asdict(speech) if speech else None,
        "reason": heard.reason or None,
    }
