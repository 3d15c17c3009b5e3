"""BlueZ, the Bluetooth service that bleak calls on Linux, on a D-Bus of the test, with one device.

Interfaces: org.bluez.Adapter1, Device1, GattService1 and GattCharacteristic1 of BlueZ (doc/org.bluez.*.rst).
"""

import asyncio
import shutil
import subprocess
import threading
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import pytest

pytest.importorskip("dbus_fast", reason="dbus-fast, which bleak uses on Linux, is not installed")

import bleak.backends.bluezdbus.manager as manager_module
from dbus_fast import Message, MessageType, Variant
from dbus_fast.aio import MessageBus

ADAPTER, BLUEZ = "/org/bluez/hci0", "org.bluez"
SERVICE_UUID = "0000ffe5-0000-1000-8000-00805f9a34fb"
PATIENCE_S = 240.0


class FakeBluez:
    """The service, in a thread with a loop of its own.

    near
        Whether the device advertises.
    written
        Contents that were written to characteristics, with their UUIDs.
    """

    def __init__(self, bus_address: str, address: str, name: str, characteristics: dict[str, list[str]]) -> None:
        self.near = True
        self.written: list[tuple[str, bytes]] = []
        self._device = f"{ADAPTER}/dev_{address.replace(':', '_')}"
        self._service = f"{self._device}/service000a"
        self._paths = {uuid: f"{self._service}/char{11 + 2 * i:04x}" for i, uuid in enumerate(characteristics)}
        self._flags, self._address, self._name = characteristics, address, name
        self._is_connected = False
        self._loop = asyncio.new_event_loop()
        self._thread = threading.Thread(target=self._loop.run_forever)
        self._thread.start()
        self._run(self._start(bus_address))

    def notify(self, uuid: str, content: bytes) -> None:
        """The device notifies."""
        self._run(self._changed(self._paths[uuid], "org.bluez.GattCharacteristic1", {"Value": Variant("ay", content)}))

    def leave(self) -> None:
        """The device is out of reach."""
        self.near = False
        self._run(self._connect(is_connected=False))

    def close(self) -> None:
        """End the service, and the last connection of bleak to the bus, which bleak keeps for its next loop."""
        for manager in manager_module._global_instances.values():
            if manager._bus is not None:
                with suppress(RuntimeError):  # its loop is closed
                    manager._bus._finalize(None)
        manager_module._global_instances.clear()

        async def disconnect() -> None:
            self._bus.disconnect()
            await self._bus.wait_for_disconnect()

        self._run(disconnect())
        self._loop.call_soon_threadsafe(self._loop.stop)
        self._thread.join()
        self._loop.close()

    def _run(self, work: Any) -> None:
        asyncio.run_coroutine_threadsafe(work, self._loop).result(PATIENCE_S)

    async def _start(self, bus_address: str) -> None:
        self._bus: Any = await MessageBus(bus_address).connect()
        self._bus.add_message_handler(self._answer)
        await self._bus.request_name(BLUEZ)

    def _answer(self, message: Any) -> Any:
        if message.message_type is not MessageType.METHOD_CALL or message.destination != BLUEZ:
            return None
        signature, body = "", []
        match message.member:
            case "GetManagedObjects":
                signature, body = "a{oa{sa{sv}}}", [self._objects()]
            case "StartDiscovery":
                self._scan = self._loop.create_task(self._advertise())
            case "StopDiscovery":
                self._scan.cancel()
            case "Connect":
                if not self.near:
                    return Message.new_error(message, "org.bluez.Error.Failed", "out of reach")
                self._loop.create_task(self._connect_and_reply(message))
                return True
            case "Disconnect":
                self._loop.create_task(self._connect(is_connected=False))
            case "WriteValue":
                uuid = next(uuid for uuid, path in self._paths.items() if path == message.path)
                self.written.append((uuid, bytes(message.body[0])))
        return Message.new_method_return(message, signature, body)

    async def _advertise(self) -> None:
        while True:
            if self.near:
                await self._changed(self._device, "org.bluez.Device1", {"RSSI": Variant("n", -50)})
            await asyncio.sleep(0.02)

    async def _connect_and_reply(self, message: Message) -> None:
        """Report the connection before the answer, as BlueZ does."""
        await self._connect(is_connected=True)
        await self._bus.send(Message.new_method_return(message))

    async def _connect(self, *, is_connected: bool) -> None:
        self._is_connected = is_connected
        state = Variant("b", is_connected)
        await self._changed(self._device, "org.bluez.Device1", {"Connected": state, "ServicesResolved": state})

    async def _changed(self, path: str, interface: str, changed: dict[str, Any]) -> None:
        properties = "org.freedesktop.DBus.Properties"
        body = [interface, changed, []]
        await self._bus.send(Message.new_signal(path, properties, "PropertiesChanged", "sa{sv}as", body))

    def _objects(self) -> dict[str, Any]:
        state = Variant("b", self._is_connected)
        device = {
            "Address": Variant("s", self._address),
            "AddressType": Variant("s", "random"),
            "Name": Variant("s", self._name),
            "Alias": Variant("s", self._name),
            "Adapter": Variant("o", ADAPTER),
            "UUIDs": Variant("as", [SERVICE_UUID]),
            "Paired": Variant("b", False),
            "Connected": state,
            "ServicesResolved": state,
        }
        adapter = {
            "Address": Variant("s", "00:11:22:33:44:55"),
            "Powered": Variant("b", True),
            "Roles": Variant("as", ["central"]),
        }
        service = {
            "UUID": Variant("s", SERVICE_UUID),
            "Device": Variant("o", self._device),
            "Primary": Variant("b", True),
        }
        objects = {
            ADAPTER: {"org.bluez.Adapter1": adapter},
            self._device: {"org.bluez.Device1": device},
            self._service: {"org.bluez.GattService1": service},
        }
        for uuid, path in self._paths.items():
            characteristic = {
                "UUID": Variant("s", uuid),
                "Service": Variant("o", self._service),
                "Flags": Variant("as", self._flags[uuid]),
                "MTU": Variant("q", 23),
            }
            objects[path] = {"org.bluez.GattCharacteristic1": characteristic}
        return objects


@contextmanager
def system_bus(monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """D-Bus daemon of the test in place of the system's."""
    daemon = shutil.which("dbus-daemon")
    if daemon is None:
        pytest.skip("dbus-daemon is not installed")
    command = [daemon, "--session", "--nofork", "--nopidfile", "--print-address"]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as process:
        assert process.stdout is not None
        try:
            address = process.stdout.readline().strip().partition(",guid")[0]
            monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", address)
            yield address
        finally:
            process.kill()
