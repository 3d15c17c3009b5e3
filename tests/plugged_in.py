"""Runs a command of ours as on a machine with these ports: `python -m tests.plugged_in PORT,PORT serve --port auto`."""

import sys
from pathlib import Path

from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from gyrodrift.cli import main
from gyrodrift.link import serial_port

if __name__ == "__main__":
    names = [name for name in sys.argv[1].split(",") if name]
    list_ports.comports = lambda *_: [ListPortInfo(name) for name in names]
    serial_port.TERMINALS = Path("/nowhere")
    sys.exit(main(sys.argv[2:]))
