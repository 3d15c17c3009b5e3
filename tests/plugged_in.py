"""Runs a command of ours as on a machine with these ports: `python -m tests.plugged_in PORT,PORT serve --port auto`.

Of the simulated devices only those below the folder SIMULATED_BELOW (environment) exist; without it none.
"""

import os
import sys
from pathlib import Path

from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from firmware_sim import reservation
from gyrodrift.cli import main
from gyrodrift.link import serial_port

if __name__ == "__main__":
    names = [name for name in sys.argv[1].split(",") if name]
    list_ports.comports = lambda *_: [ListPortInfo(name) for name in names]
    serial_port.TERMINALS = Path("/nowhere")
    folder, all_links = os.environ.get("SIMULATED_BELOW", "/nowhere"), reservation.reserved_links
    reservation.reserved_links = lambda: [link for link in all_links() if link.is_relative_to(folder)]
    sys.exit(main(sys.argv[2:]))
