"""Source `ble:ADDRESS`: the notifications of a Bluetooth LE device, such as WitMotion's WT901BLE, through bleak.

bleak runs in a thread with an event loop of its own.
"""

import asyncio
import re
import threading
from collections.abc import Coroutine
from concurrent.futures import Future
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from gyrodrift.link.inbox import Inbox
from gyrodrift.link.port import PortGoneError
from gyrodrift.link.sources.source import ByteSource, SourceAddress, SourcePort
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError

if TYPE_CHECKING:
    from bleak import BleakClient

OPTIONS = ("notify", "write")
UUID = re.compile(r"[0-9A-Fa-f]{8}(?:-[0-9A-Fa-f]{4}){3}-[0-9A-Fa-f]{12}")
HARDWARE_ADDRESS = re.compile(rf"(?:[0-9A-Fa-f]{{2}}:){{5}}[0-9A-Fa-f]{{2}}|{UUID.pattern}")
"""Address of a device; macOS has a UUID in its place."""

CHARACTERISTICS = (
    ("0000ffe4-0000-1000-8000-00805f9a34fb", "0000ffe9-0000-1000-8000-00805f9a34fb"),
    ("6e400003-b5a3-f393-e0a9-e50e24dcca9e", "6e400002-b5a3-f393-e0a9-e50e24dcca9e"),
    ("0000ffe1-0000-1000-8000-00805f9b34fb", "0000ffe1-0000-1000-8000-00805f9b34fb"),
)
"""Characteristics that notify and that are written.

Of WitMotion (Bluetooth 5.0 communication protocol), of the Nordic UART service, and of HM-10 modules.
"""

CONNECT_S = 15.0
"""Longest wait for a device, s: it advertises at least every 10.24 s (Bluetooth Core, Vol 6, Part B, 4.4.2.2)."""

STOP_S = 3.0
BUS_CLOSE_S = 0.05
"""Time for bleak to close its connection to D-Bus, s: it waits for the end of the stream. Chosen."""

LONGEST_KEPT_BYTES = 1 << 18
"""Bytes that wait for the loop; then new ones are dropped. At 1 Mbit/s of the radio that is 2 s."""

LONGEST_NOTIFICATION_BYTES = 512
"""Longest value of an attribute (Bluetooth Core, Vol 3, Part F, 3.2.9)."""

client_backend: "type[Any] | None" = None
"""Backend of bleak; None for that of the system. Tests have their own, because they have no radio."""


class BlePort(SourcePort):
    """Connected device."""

    def __init__(self, path: str) -> None:
        self._inbox = Inbox()
        super().__init__(path, self._inbox.fd)
        self._dropped_bytes = 0
        self._client: BleakClient | None = None
        self._write_to = ""
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever, name=f"read {path}", daemon=True)
        self._thread.start()

    def connect(self, name: str, notify: str | None, write: str | None) -> None:
        """Connect, and ask for notifications.

        Raises
        ------
        LinkError
            The device is absent, or has no such characteristic; the message says why.
        """
        future = self._call(self._connect(name, notify, write))
        try:
            future.result(2.0 * CONNECT_S + STOP_S)
        except LinkError:
            raise
        except Exception as error:  # bleak, D-Bus and the drivers have errors of any kind
            raise _explained(self.path, error) from error

    def read(self) -> bytes:
        """Bytes that have arrived, without waiting."""
        content = self._inbox.take()
        if self._dropped_bytes:
            self.note("source_overflow", dropped_bytes=self._dropped_bytes)
            self._dropped_bytes = 0
        if not content and self._inbox.is_over:
            raise PortGoneError(self.path)
        return content

    def write(self, content: bytes) -> int:
        """Send to the device, in the background."""
        if self._client is not None and self._write_to and not self._inbox.is_over:
            self._call(self._write(content))
        return len(content)

    def close(self) -> None:
        """Disconnect, and end the thread."""
        if not self._thread.is_alive():
            return
        with suppress(TimeoutError):
            self._call(self._disconnect()).result(STOP_S)
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join(STOP_S)
        if not self._thread.is_alive():
            self._loop.close()
        self._inbox.close()

    def _call(self, work: Coroutine[Any, Any, None]) -> "Future[None]":
        return asyncio.run_coroutine_threadsafe(work, self._loop)

    async def _connect(self, name: str, notify: str | None, write: str | None) -> None:
        from bleak import BleakClient, BleakScanner

        device: Any = name
        if not HARDWARE_ADDRESS.fullmatch(name):
            device = await BleakScanner.find_device_by_name(name, timeout=CONNECT_S)
            if device is None:
                raise PortMissingError(f"{self.path}: no device advertises the name {name!r}; is it on and near?")
        client = BleakClient(device, disconnected_callback=self._lose, timeout=CONNECT_S, backend=client_backend)
        await client.connect()
        self._client = client
        present = {entry.uuid: entry.properties for service in client.services for entry in service.characteristics}
        source, self._write_to = _chosen(self.path, present, notify, write)
        await client.start_notify(source, self._hear)

    async def _disconnect(self) -> None:
        """Disconnect. After a lost connection, too: bleak still holds a connection to D-Bus."""
        if self._client is not None:
            with suppress(Exception):  # a device that is gone cannot be disconnected
                await self._client.disconnect()
        unfinished = asyncio.all_tasks() - {asyncio.current_task()}
        for task in unfinished:
            task.cancel()
        await asyncio.gather(*unfinished, return_exceptions=True)
        await asyncio.sleep(BUS_CLOSE_S)

    async def _write(self, content: bytes) -> None:
        if self._client is not None:
            with suppress(Exception):  # a lost device is noticed by its callback
                await self._client.write_gatt_char(self._write_to, content, response=False)

    def _hear(self, _: object, content: bytearray) -> None:
        content = content[:LONGEST_NOTIFICATION_BYTES]
        if len(self._inbox) + len(content) <= LONGEST_KEPT_BYTES:
            self._inbox.put(bytes(content))
        else:
            self._dropped_bytes += len(content)

    def _lose(self, _: object) -> None:
        self._inbox.end()


def _chosen(path: str, present: "dict[str, list[Any]]", notify: str | None, write: str | None) -> tuple[str, str]:
    """Characteristics that notify and are written: of the address, else the first known ones."""
    pairs = CHARACTERISTICS if notify is None else ((notify.lower(), (write or "").lower()),)
    for source, sink in pairs:
        if {"notify", "indicate"} & set(present.get(source, ())):
            return source, sink if sink in present else ""
    names = [uuid for uuid, properties in present.items() if {"notify", "indicate"} & set(properties)]
    raise LinkError(
        f"{path}: the device has no {notify or 'known characteristic'}; append ?notify=UUID with one of: "
        f"{', '.join(names[:12]) or 'none'}"
    )


def open_ble(address: SourceAddress) -> BlePort:
    """Connect to a device by its address or its name.

    Raises
    ------
    UsageError
        The address has a mistake.
    LinkError
        The device cannot be connected; the message says why.
    """
    name, options = address.split_query(OPTIONS)
    if not name:
        raise UsageError(f"--port {address.text}: expected ble:ADDRESS or ble:NAME, such as ble:DF:BE:12:20:70:8C")
    for option in OPTIONS:
        if option in options and not UUID.fullmatch(options[option]):
            raise UsageError(f"--port {address.text}: {option}={options[option]} is no UUID")
    port = BlePort(address.text)
    try:
        port.connect(name, options.get("notify"), options.get("write"))
    except BaseException:
        port.close()
        raise
    return port


REASONS = (
    ("DeviceNotFound", PortMissingError, "the device is not found; is it on, near, and not connected elsewhere?"),
    ("Timeout", PortMissingError, "the device does not answer; is it on, near, and not connected elsewhere?"),
    ("FileNotFound", LinkError, "there is no D-Bus, and so no Bluetooth; install bluez and start its service"),
    ("NotAvailable", LinkError, "Bluetooth is not available; turn it on with 'bluetoothctl power on'"),
)
"""Parts of the names of errors, which differ between the versions of bleak, with their meanings."""


def _explained(path: str, error: Exception) -> LinkError:
    for word, kind, reason in REASONS:
        if word in type(error).__name__:
            return kind(f"{path}: {reason}")
    return LinkError(f"{path}: no connection: {type(error).__name__} {error}; try 'bluetoothctl connect'")


BLE = ByteSource(
    "ble",
    "ble:ADDRESS",
    "notifications of a Bluetooth LE device, such as a WT901BLE",
    open_ble,
    packages=("bleak",),
    extra="ble",
    silence="the device is connected; check that it measures, and the characteristic with ?notify=UUID",
)
