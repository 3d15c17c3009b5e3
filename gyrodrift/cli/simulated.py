"""Simulated devices that run on this machine."""

import os

from firmware_sim import reservation
from gyrodrift.link.serial_port import SerialPort


def simulated_ports() -> list[SerialPort]:
    """Links of the simulated devices that run on this machine."""
    links = [link for link in reservation.reserved_links() if link.is_symlink()]
    return [SerialPort(str(link), os.path.realpath(link), product="simulated device") for link in links]
