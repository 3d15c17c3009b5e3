"""Source ble through bleak, with a backend of the test: errors of any kind, and other characteristics."""

import asyncio
import time
from collections.abc import Callable
from contextlib import closing
from typing import Any, ClassVar

import pytest
from sources_support import PATIENCE_S, Events, read_until

from firmware_sim.wire.witmotion_ble import ble_frame
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources import ble
from gyrodrift.link.sources.ble import LONGEST_KEPT_BYTES, BlePort
from gyrodrift.values.errors import LinkError, PortMissingError, UsageError

pytest.importorskip("bleak", reason="bleak is not installed: pip install 'gyrodrift[ble]'")

from bleak.backends.characteristic import BleakGATTCharacteristic
from bleak.backends.client import BaseBleakClient
from bleak.backends.service import BleakGATTService, BleakGATTServiceCollection
from bleak.exc import BleakDeviceNotFoundError, BleakError

ADDRESS = "DF:BE:12:20:70:8C"
WITMOTION = ("0000ffe4-0000-1000-8000-00805f9a34fb", "0000ffe9-0000-1000-8000-00805f9a34fb")
UNUSUAL = "12345678-1234-5678-1234-56789abcdef0"


class Radio(BaseBleakClient):  # type: ignore[misc, unused-ignore] # Any where bleak is not installed
    """A backend of bleak with one device.

    characteristics
        UUIDs of the device, with their properties.
    is_near
        Whether it can be connected.
    current
        Connected backend.
    """

    characteristics: ClassVar[dict[str, list[Any]]] = {}
    is_near: ClassVar[bool] = True
    current: ClassVar["Radio | None"] = None

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.written: list[tuple[str, bytes]] = []
        self._callback: Callable[[bytearray], None] | None = None
        self._is_connected = False
        self._loop: asyncio.AbstractEventLoop | None = None

    async def connect(self, pair: bool = False, **kwargs: Any) -> None:  # noqa: FBT001, FBT002 - the interface of bleak
        if not Radio.is_near:
            raise BleakDeviceNotFoundError(self.address, "not found")
        self._is_connected, self._loop = True, asyncio.get_running_loop()
        self.services = BleakGATTServiceCollection()
        service = BleakGATTService(None, 1, "0000ffe5-0000-1000-8000-00805f9a34fb")
        self.services.add_service(service)
        for index, (uuid, properties) in enumerate(Radio.characteristics.items()):
            entry = BleakGATTCharacteristic(None, 2 + index, uuid, properties, lambda: 20, service)
            self.services.add_characteristic(entry)
        Radio.current = self

    async def start_notify(self, characteristic: Any, callback: Callable[[bytearray], None], **kwargs: Any) -> None:
        self._callback = callback

    async def write_gatt_char(self, characteristic: Any, data: Any, response: bool) -> None:  # noqa: FBT001 - the interface of bleak
        self.written.append((characteristic.uuid, bytes(data)))

    async def disconnect(self) -> None:
        self._is_connected = False

    @property
    def is_connected(self) -> bool:
        return self._is_connected

    @property
    def mtu_size(self) -> int:
        return 23

    @property
    def name(self) -> str:
        return "WT901BLE68"

    async def pair(self, *args: Any, **kwargs: Any) -> None: ...
    async def unpair(self) -> None: ...
    async def stop_notify(self, characteristic: Any) -> None: ...
    async def write_gatt_descriptor(self, descriptor: Any, data: Any) -> None: ...

    async def read_gatt_char(self, characteristic: Any, **kwargs: Any) -> bytearray:
        return bytearray()

    async def read_gatt_descriptor(self, descriptor: Any, **kwargs: Any) -> bytearray:
        return bytearray()

    def notify(self, content: bytes) -> None:
        """The device notifies, on the thread of bleak."""
        assert self._loop is not None
        assert self._callback is not None
        self._loop.call_soon_threadsafe(self._callback, bytearray(content))

    def leave(self) -> None:
        """The device is out of reach."""
        assert self._loop is not None
        self._is_connected = False
        if self._disconnected_callback is not None:
            self._loop.call_soon_threadsafe(self._disconnected_callback)


@pytest.fixture(autouse=True)
def radio(monkeypatch: pytest.MonkeyPatch) -> None:
    """A WitMotion near the machine."""
    monkeypatch.setattr(ble, "client_backend", Radio)
    monkeypatch.setattr(Radio, "characteristics", {WITMOTION[0]: ["notify"], WITMOTION[1]: ["write"]})
    monkeypatch.setattr(Radio, "is_near", True)
    monkeypatch.setattr(Radio, "current", None)


def device() -> Radio:
    assert Radio.current is not None
    return Radio.current


def feed(link: Link, count: int, rate_dps: float = 10.0) -> list[Any]:
    """Samples of frames that arrive one by one."""

    def has_enough(samples: list[Any]) -> bool:
        device().notify(ble_frame(rate_dps))
        time.sleep(0.005)
        return len(samples) >= count

    return read_until(link, has_enough)


def test_notifications_are_read_like_a_cable() -> None:
    events = Events()
    with closing(Link(LinkOptions(f"ble:{ADDRESS}"), events)) as link:
        samples = feed(link, 100)
    assert samples[-1].rate_dps == pytest.approx(10.0, abs=0.1)
    assert ("protocol_found", {"protocol": "witmotion-ble"}) in events.told


def test_a_device_that_comes_back_is_read_again() -> None:
    events = Events()
    with closing(Link(LinkOptions(f"ble:{ADDRESS}"), events)) as link:
        feed(link, 80)
        Radio.is_near = False
        device().leave()
        read_until(link, lambda _: link.port is None)
        Radio.is_near = True
        read_until(link, lambda _: link.port is not None)
        feed(link, 20)
        assert link.counters.reconnects == 1
    assert events.names().count("link_restored") == 1


def test_what_is_sent_is_written_to_the_device() -> None:
    """A setting of WitMotion, such as its rate."""
    with closing(Link(LinkOptions(f"ble:{ADDRESS}", send=b"\xff\xaa\x03\x09\x00"), Events())) as link:
        until_s = time.monotonic() + PATIENCE_S
        while not device().written:
            assert time.monotonic() < until_s
            link.read()
        assert device().written[0] == (WITMOTION[1], b"\xff\xaa\x03\x09\x00")


def test_a_device_that_is_not_near_is_an_error() -> None:
    Radio.is_near = False
    with pytest.raises(PortMissingError, match=rf"ble:{ADDRESS}: the device is not found; is it on, near"):
        Link(LinkOptions(f"ble:{ADDRESS}"), Events())


def test_another_characteristic_is_named_by_the_address(monkeypatch: pytest.MonkeyPatch) -> None:
    """The error lists those that there are."""
    monkeypatch.setattr(Radio, "characteristics", {UNUSUAL: ["notify"], WITMOTION[1]: ["write"]})
    with pytest.raises(LinkError, match=rf"no known characteristic; append \?notify=UUID with one of: {UNUSUAL}"):
        Link(LinkOptions(f"ble:{ADDRESS}"), Events())
    with closing(Link(LinkOptions(f"ble:{ADDRESS}?notify={UNUSUAL}"), Events())) as link:
        assert len(feed(link, 60)) >= 60


def test_an_error_of_the_driver_is_an_error_of_ours(monkeypatch: pytest.MonkeyPatch) -> None:
    async def fail(self: Radio, pair: bool = False, **kwargs: Any) -> None:  # noqa: FBT001, FBT002 - as above
        raise BleakError("adapter is busy")

    monkeypatch.setattr(Radio, "connect", fail)
    with pytest.raises(LinkError, match="no connection: BleakError adapter is busy; try 'bluetoothctl connect'"):
        Link(LinkOptions(f"ble:{ADDRESS}"), Events())


def test_without_a_bluetooth_service_the_error_says_so(monkeypatch: pytest.MonkeyPatch) -> None:
    """The backend of this system, where there is no D-Bus."""
    monkeypatch.setattr(ble, "client_backend", None)
    monkeypatch.setenv("DBUS_SYSTEM_BUS_ADDRESS", "unix:path=/nowhere")
    with pytest.raises(LinkError, match=r"no Bluetooth; install bluez|Bluetooth is not available|no connection"):
        Link(LinkOptions(f"ble:{ADDRESS}"), Events())


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("ble:", "expected ble:ADDRESS or ble:NAME"),
        (f"ble:{ADDRESS}?notify=ffe4", "notify=ffe4 is no UUID"),
        (f"ble:{ADDRESS}?rate=5", "'rate=5' is no option of this source; there are notify=… and write=…"),
    ],
)
def test_a_wrong_address_is_an_error(text: str, expected: str) -> None:
    with pytest.raises(UsageError, match=expected):
        Link(LinkOptions(text), Events())


def test_notifications_that_nobody_reads_are_dropped_and_reported() -> None:
    port = BlePort("ble:test")
    with closing(port):
        for _ in range(LONGEST_KEPT_BYTES // 512 + 2):
            port._hear(None, bytearray(10_000))
        assert len(port.read()) == LONGEST_KEPT_BYTES
        assert port.notes == [("source_overflow", {"dropped_bytes": 1024})]
        assert port.read() == b""
