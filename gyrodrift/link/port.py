"""Serial port; the only file that uses pyserial.

pyserial opens, locks and configures; reading goes to the file descriptor itself, since `read(1)` through
pyserial costs a thousand times as much. Opening flushes the input and, on many boards, resets the device.
"""

import errno
import os
import select
import stat
from contextlib import suppress
from pathlib import Path

import serial
from serial.tools import list_ports
from serial.tools.list_ports_common import ListPortInfo

from gyrodrift.link.holder import holder_of
from gyrodrift.link.serial_port import SerialPort, built_in_ports, has_uart
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.values.errors import LinkError, PortBusyError, PortDeniedError, PortMissingError, UsageError

try:
    import fcntl
    import termios
except ImportError:  # Windows, where ThreadPort reads
    HAS_TERMIOS = False
    SERIAL_ERRORS: tuple[type[Exception], ...] = (OSError, ValueError)  # SerialException is an OSError
else:
    HAS_TERMIOS = True
    SERIAL_ERRORS = (OSError, ValueError, termios.error)

USUAL_BAUDS = (115200, 9600, 921600, 460800, 230400, 57600, 38400, 19200, 4800, 1000000, 2000000)
"""Baud rates of `--baud auto`, the most common first."""

READ_BYTES = 4096
READS_PER_TURN = 16
"""Largest number of reads at a time, so that a flood does not block the loop."""

PTY_SLAVE_MAJORS = range(136, 144)
BY_ID = Path("/dev/serial/by-id")

LOOKS = 3
"""Attempts to list the ports: pyserial reads sysfs in pieces, and fails if an adapter is unplugged meanwhile."""

HUNG_UP = frozenset({errno.EIO, errno.ENXIO, errno.EBADF, errno.ENODEV})
"""Errors of a hung-up port; a pty without its other end has them for a moment. Other errors end the port."""


class PortGoneError(Exception):
    """Port that is unplugged, or whose other end is closed."""


class Port(SourcePort):
    """Open port with exclusive use of its device."""

    def __init__(self, path: str, baud: int) -> None:
        self._serial = open_serial(path, baud)
        self.fd: int = self._serial.fileno()
        super().__init__(path, self.fd)
        self.is_pty = _is_pty(self.fd)
        self.has_line_rate = not self.is_pty
        if not self.is_pty:  # after a kill, a pty would stay locked while its other end is open
            with suppress(OSError):
                fcntl.ioctl(self.fd, termios.TIOCEXCL)
        # Best effort: drivers, ptys and other systems refuse it in different ways.
        with suppress(OSError, ValueError, NotImplementedError, AttributeError):
            self._serial.set_low_latency_mode(True)

    def read(self) -> bytes:
        """Available bytes, up to a limit, without waiting.

        Raises
        ------
        PortGoneError
            The port is closed, and all its bytes have been read.
        """
        chunks: list[bytes] = []
        for _ in range(READS_PER_TURN):
            try:
                chunk = os.read(self.fd, READ_BYTES)
            except BlockingIOError:
                break
            except OSError as error:
                if error.errno not in HUNG_UP and not chunks:
                    raise PortGoneError(self.path) from error
                chunk = b""
            if not chunk:
                if chunks or not self._hung_up():
                    break  # pyserial sets VMIN 0, so an empty read may only mean that there are no bytes
                raise PortGoneError(self.path)
            chunks.append(chunk)
            if len(chunk) < READ_BYTES // 2:
                break
        return b"".join(chunks)

    def write(self, content: bytes) -> int:
        """Send without waiting, and return the number of bytes; the next read reports a closed port."""
        try:
            return os.write(self.fd, content)
        except OSError:
            return 0

    def _hung_up(self) -> bool:
        poller = select.poll()
        poller.register(self.fd, 0)
        return bool(poller.poll(0))

    def set_baud(self, baud: int) -> None:
        """Change the baud rate, and drop bytes received at the old one."""
        try:
            self._serial.baudrate = baud
            self._serial.reset_input_buffer()
        except SERIAL_ERRORS as error:
            raise PortGoneError(self.path) from error

    def close(self) -> None:
        """Close the port in any state of the device."""
        with suppress(OSError):
            if not self.is_pty:
                fcntl.ioctl(self.fd, termios.TIOCNXCL)
        with suppress(*SERIAL_ERRORS):
            self._serial.close()


def stable_name(path: str) -> str:
    """Name that the adapter keeps when it is replugged; the path itself without one."""
    device = os.path.realpath(path)
    if not Path(path).is_symlink():
        with suppress(OSError):  # it is there while an adapter is
            for name in sorted(BY_ID.iterdir()):
                if os.path.realpath(name) == device:
                    return str(name)
    return path


def serial_ports() -> list[SerialPort]:
    """Ports of this machine with hardware, by name; no port is opened."""
    ports = {entry.device: _described(entry) for entry in _plugged_in() if has_uart(entry.device)}
    for device in built_in_ports():  # pyserial leaves out those on a chip, such as the Raspberry Pi's
        ports.setdefault(device, SerialPort(stable_name(device), device))
    return sorted(ports.values(), key=lambda port: port.name)


def _plugged_in() -> list[ListPortInfo]:
    """Ports that pyserial lists; empty if adapters come and go all the time."""
    for _ in range(LOOKS):
        with suppress(OSError, TypeError, ValueError):
            return list(list_ports.comports())
    return []


def _described(entry: ListPortInfo) -> SerialPort:
    usb_id = None if entry.vid is None else f"{entry.vid:04x}:{entry.pid:04x}"
    return SerialPort(
        stable_name(entry.device), entry.device, entry.manufacturer, entry.product, usb_id, entry.serial_number
    )


def open_serial(path: str, baud: int) -> serial.Serial:
    """Open a port for this process alone; its reads do not wait.

    Raises
    ------
    UsageError
        If the port does not have this rate.
    LinkError
        If the port cannot be opened; the message says why and what to do.
    """
    try:
        return serial.Serial(path, baud, timeout=0, exclusive=True)
    except ValueError as error:
        raise UsageError(f"{path}: cannot use {baud} baud: {error}") from error
    except SERIAL_ERRORS as error:
        raise _explain(path, error) from error


def _explain(path: str, error: Exception) -> LinkError:
    try:
        return _explain_by_text(path, error) if not HAS_TERMIOS else _looked_into(path, error)
    except OSError:  # names come and go
        return PortMissingError(f"{path}: the port went away while it was being opened: {error}")


def _looked_into(path: str, error: Exception) -> LinkError:
    number = getattr(error, "errno", None)
    if not os.path.lexists(path):
        return PortMissingError(f"{path}: there is no such port; {_ports_there_are()}")
    if not Path(path).exists():
        return PortMissingError(f"{path} points to {os.path.realpath(path)}, which is not there; is the device on?")
    if number in (errno.EACCES, errno.EPERM):
        from gyrodrift.link.permission import how_to_get_permission

        return PortDeniedError(f"{path}: no permission to open it; {how_to_get_permission(path)}")
    if number in (errno.EBUSY, errno.EAGAIN):
        return PortBusyError(f"{path}: the port is in use{_by_whom(path)}; stop that program first")
    if not stat.S_ISCHR(Path(path).stat().st_mode):
        return LinkError(f"{path}: this is not a serial port; {_ports_there_are()}")
    return LinkError(f"{path}: the port cannot be opened: {error}")


def _explain_by_text(path: str, error: Exception) -> LinkError:
    """Windows names no file; pyserial quotes its error in the text."""
    if getattr(error, "errno", None) == errno.ENOENT or "FileNotFoundError" in str(error):
        return PortMissingError(f"{path}: there is no such port; {_ports_there_are()}")
    if "PermissionError" in str(error):
        return PortBusyError(f"{path}: the port is in use; stop the program that has it open first")
    return LinkError(f"{path}: the port cannot be opened: {error}")


def _ports_there_are() -> str:
    names = sorted(port.device for port in serial_ports())
    return f"ports on this machine: {', '.join(names)}" if names else "no serial port is plugged in"


def _by_whom(path: str) -> str:
    holder = holder_of(path)
    return f" by {holder}" if holder else ""


def _is_pty(fd: int) -> bool:
    return os.major(os.fstat(fd).st_rdev) in PTY_SLAVE_MAJORS
