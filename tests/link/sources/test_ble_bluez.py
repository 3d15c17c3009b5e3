"""Source ble through bleak's own backend of Linux, with a service of the test in place of BlueZ and its radio."""

import sys
import time
from collections.abc import Iterator
from contextlib import closing
from typing import Any

import pytest
from bluez_support import FakeBluez, system_bus
from sources_support import PATIENCE_S, Events, read_until

from firmware_sim.wire.witmotion_ble import ble_frame
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.sources import ble
from gyrodrift.values.errors import PortMissingError

pytest.importorskip("bleak", reason="bleak is not installed: pip install 'gyrodrift[ble]'")
if sys.platform != "linux":
    pytest.skip("BlueZ is on Linux", allow_module_level=True)

ADDRESS, NAME = "DF:BE:12:20:70:8C", "WT901BLE68"
NOTIFY, WRITE = "0000ffe4-0000-1000-8000-00805f9a34fb", "0000ffe9-0000-1000-8000-00805f9a34fb"


@pytest.fixture
def bluez(monkeypatch: pytest.MonkeyPatch) -> Iterator[FakeBluez]:
    with system_bus(monkeypatch) as address:
        flags = {NOTIFY: ["notify"], WRITE: ["write-without-response"]}
        with closing(FakeBluez(address, ADDRESS, NAME, flags)) as service:
            yield service


def feed(link: Link, service: FakeBluez, count: int) -> list[Any]:
    def has_enough(samples: list[Any]) -> bool:
        service.notify(NOTIFY, ble_frame(10.0))
        time.sleep(0.005)
        return len(samples) >= count

    return read_until(link, has_enough)


@pytest.mark.parametrize("name", [ADDRESS, NAME])
def test_a_device_is_found_connected_and_read(bluez: FakeBluez, name: str) -> None:
    with closing(Link(LinkOptions(f"ble:{name}"), Events())) as link:
        samples = feed(link, bluez, 60)
    assert samples[-1].rate_dps == pytest.approx(10.0, abs=0.1)
    assert not bluez._is_connected


def test_a_setting_is_written(bluez: FakeBluez) -> None:
    with closing(Link(LinkOptions(f"ble:{ADDRESS}", send=b"\xff\xaa\x03\x09\x00"), Events())) as link:
        until_s = time.monotonic() + PATIENCE_S
        while not bluez.written:
            assert time.monotonic() < until_s
            link.read()
    assert bluez.written[0] == (WRITE, b"\xff\xaa\x03\x09\x00")


def test_a_device_that_leaves_is_read_again_when_it_is_back(bluez: FakeBluez, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ble, "CONNECT_S", 0.5)
    with closing(Link(LinkOptions(f"ble:{ADDRESS}"), Events())) as link:
        feed(link, bluez, 60)
        bluez.leave()
        read_until(link, lambda _: link.port is None)
        time.sleep(0.7)
        link.read()
        bluez.near = True
        read_until(link, lambda _: link.port is not None)
        feed(link, bluez, 10)
        assert link.counters.reconnects == 1


def test_a_device_that_does_not_advertise_is_an_error(bluez: FakeBluez, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ble, "CONNECT_S", 0.3)
    bluez.near = False
    with pytest.raises(PortMissingError, match="the device is not found; is it on, near"):
        Link(LinkOptions(f"ble:{ADDRESS}"), Events())
    with pytest.raises(PortMissingError, match=f"no device advertises the name '{NAME}'"):
        Link(LinkOptions(f"ble:{NAME}"), Events())
