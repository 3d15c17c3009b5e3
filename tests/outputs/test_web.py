"""The output `web` as a browser speaks to it: its files, who may have them, and the stream."""

import json
import socket
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from itertools import pairwise
from math import isnan, nan
from pathlib import Path
from threading import Thread
from types import SimpleNamespace
from typing import Any, cast
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

import pytest
from outputs_support import HubThread, corrected, hub, tilted, with_own_yaw
from support import PATIENCE_S
from websockets import http11
from websockets.datastructures import Headers
from websockets.exceptions import ConnectionClosed, InvalidStatus
from websockets.sync.client import ClientConnection, connect

from gyrodrift.outputs.net.addresses import is_loopback
from gyrodrift.outputs.status import LinkStatus, OutputStatus, ServiceStatus
from gyrodrift.outputs.web.assets import Assets
from gyrodrift.outputs.web.output import MOST_PENDING, is_local
from gyrodrift.outputs.web.points import LAYOUTS, ONE_AXIS, THREE_AXES, PointHistory
from gyrodrift.service.commands import page_url
from gyrodrift.service.control import CommandError
from gyrodrift.values.sample import Corrected

Web = tuple[HubThread, str]


@pytest.fixture
def web() -> Iterator[Web]:
    """Outputs with a page, and where it is."""
    with hub("web:port=0,reached_as=gyro.example") as outputs:
        yield outputs, outputs.address


def got(address: str, path: str = "/", **headers: str) -> tuple[int, str, dict[str, str]]:
    """Status, text and headers of the answer."""
    try:
        with urlopen(Request(address + path, headers=headers), timeout=PATIENCE_S) as answer:
            return answer.status, answer.read().decode(), dict(answer.headers)
    except HTTPError as error:
        with error:
            return error.code, error.read().decode(), dict(error.headers)


def looking(address: str, **options: Any) -> ClientConnection:
    """A client of the stream."""
    client: ClientConnection = connect(address.replace("http", "ws", 1) + "/stream", compression=None, **options)
    return client


def report(client: ClientConnection, kind: str) -> dict[str, Any]:
    """The next message of a kind."""
    while True:
        message = client.recv(PATIENCE_S)
        if isinstance(message, str) and json.loads(message)["kind"] == kind:
            return dict(json.loads(message))


def points(client: ClientConnection, count: int) -> list[dict[str, float]]:
    """The next points, by column."""
    result: list[dict[str, float]] = []
    while len(result) < count:
        message = client.recv(PATIENCE_S)
        if isinstance(message, bytes):
            result += [dict(zip(ONE_AXIS.columns, row, strict=True)) for row in ONE_AXIS.record.iter_unpack(message)]
    return result


def test_the_page_may_load_nothing_from_elsewhere(web: Web) -> None:
    """Every file says so, and what is no file is not there."""
    _, address = web
    for path, kind in (("/", "text/html"), ("/main.js", "text/javascript"), ("/uplot/uPlot.min.css", "text/css")):
        status, text, headers = got(address, path)
        assert (status, headers["Content-Type"].partition(";")[0]) == (200, kind)
        assert headers["Content-Security-Policy"].startswith("default-src 'none'; script-src 'self';")
        assert int(headers["Content-Length"]) == len(text.encode())
    assert "Permission is hereby granted" in got(address, "/uplot/LICENSE")[1]
    assert [got(address, path)[0] for path in ("/nothing", "/../output.py", "/%2e%2e/output.py")] == [404] * 3


@pytest.mark.promise("Clients of outputs")
def test_a_name_that_is_not_of_this_machine_is_refused(web: Web) -> None:
    """A Host header with anything but a name and a port is refused."""
    _, address = web
    assert got(address, Host="gyro.example:80")[0] == got(address, Host="localhost")[0] == 200
    status, text, _ = got(address, Host="evil.example")
    assert status == 403
    assert "add it with web:reached_as=NAME" in text
    assert got(address, Host="[::1]:80")[0] == 200
    for host in (
        "[",
        "localhost.",
        "localhost.evil",
        "127.0.0.1.",
        "me@127.0.0.1",
        "127.0.0.1#.evil",
        "127.0.0.1/.evil",
    ):
        assert got(address, Host=host)[0] == 403


def test_the_stream_is_for_its_own_page(web: Web) -> None:
    _, address = web
    for origin in ("http://evil.example", "null"):
        with pytest.raises(InvalidStatus) as refused:
            looking(address, origin=origin)
        assert refused.value.response.status_code == 403
    for options in ({"origin": address}, {}):
        with looking(address, **options) as client:
            assert report(client, "hello")["columns"] == list(ONE_AXIS.columns)


def test_what_a_page_says_closes_it(web: Web) -> None:
    _, address = web
    with looking(address) as client:
        client.send('{"zero":true}')
        with pytest.raises(ConnectionClosed, match="takes no messages"):
            report(client, "nothing")


def test_a_spike_of_one_sample_is_in_a_point(web: Web) -> None:
    outputs, address = web
    with looking(address) as client:
        report(client, "hello")
        samples = [corrected(seq, yaw_deg=1.0, rest_probability=nan) for seq in range(200)]
        samples[77] = corrected(77, yaw_deg=99.0)
        outputs.samples(samples)
        observed = points(client, 1)
        while observed[-1]["t_s"] < samples[-1].sample.t_host_s:
            observed += points(client, 1)
        assert len(observed) < 20
        assert max(item["yaw_deg_hi"] for item in observed) == 99.0
        assert observed[-1]["yaw_deg"] == observed[-1]["yaw_deg_lo"] == 1.0
        assert isnan(observed[-1]["rest_probability"])
        assert observed[-1]["error_deg_lo"] == -9.0


def test_a_page_that_comes_later_is_given_what_was(web: Web) -> None:
    """Points, events and the state, in words too."""
    outputs, address = web
    with looking(address) as first:
        outputs.samples([corrected(1), corrected(2)])
        points(first, 1)
        outputs.event("config_applied", file="my.yaml", changes=["tau_s 1 → 2"])
        outputs.status(ServiceStatus(pid=1, link=LinkStatus(port="/dev/gyro", is_open=False)))
        report(first, "event")
        report(first, "state")
        with looking(address) as second:
            assert points(second, 1)[-1]["t_s"] == corrected(2).sample.t_host_s
            assert report(second, "event")["fields"]["changes"] == ["tau_s 1 → 2"]
            health = report(second, "state")["health"]
            assert health[0] == {"level": "bad", "says": "The port /dev/gyro is gone; the service waits for it."}


def test_points_of_three_axes_have_further_columns(web: Web) -> None:
    """A new hello says so with the first attitude, and pages that come later know it; one axis stays what it is."""
    outputs, address = web
    with looking(address) as client:
        assert report(client, "hello")["columns"] == list(ONE_AXIS.columns)
        outputs.samples([corrected(0)])
        assert len(client.recv(PATIENCE_S)) == ONE_AXIS.record.size
        outputs.samples([tilted(1)])
        assert report(client, "hello")["columns"] == list(THREE_AXES.columns)
        assert len(client.recv(PATIENCE_S)) == THREE_AXES.record.size
        outputs.samples([tilted(2, roll_deg=-5.0), tilted(3)])
        message = client.recv(PATIENCE_S)
    assert isinstance(message, bytes)
    point = dict(zip(THREE_AXES.columns, THREE_AXES.record.unpack(message), strict=True))
    assert (point["roll_deg"], point["pitch_deg"]) == (10.0, -20.0)
    assert (point["roll_deg_lo"], point["roll_deg_hi"]) == (-5.0, 10.0)
    with looking(address) as late:
        assert report(late, "hello")["columns"] == list(THREE_AXES.columns)
        assert len(late.recv(PATIENCE_S)) == 2 * THREE_AXES.record.size


@pytest.mark.parametrize(("make", "has_axes"), [(corrected, False), (tilted, True)])
def test_points_of_a_device_with_a_filter_have_its_yaw(
    web: Web, make: Callable[[int], Corrected], *, has_axes: bool
) -> None:
    """The difference stays where a sample has no result; the columns come with the first one."""
    outputs, address = web
    layout = LAYOUTS[has_axes, True]
    with looking(address) as client:
        report(client, "hello")
        outputs.samples([with_own_yaw(make(1))])
        assert report(client, "hello")["columns"] == list(layout.columns)
        client.recv(PATIENCE_S)
        outputs.samples([make(2)._replace(device_difference_deg=0.5)])
        message = client.recv(PATIENCE_S)
    assert isinstance(message, bytes)
    point = dict(zip(layout.columns, layout.record.unpack(message), strict=True))
    assert (point["device_difference_deg"], point["device_difference_deg_hi"]) == (0.5, 0.5)
    assert isnan(point["device_yaw_deg"])


def test_an_hour_is_kept_in_few_points_and_no_spike_is_lost() -> None:
    history = PointHistory()
    flat = ONE_AXIS.point_of([corrected(0)])
    count, spike = 3700 * 30, 700 * 30
    for index in range(count):
        point = flat._replace(t_s=index / 30.0)
        history.add(point._replace(hi=(500.0, *point.hi[1:])) if index == spike else point)
    rows = [dict(zip(ONE_AXIS.columns, ONE_AXIS.record.unpack(row), strict=True)) for row in history.rows()]
    times = [row["t_s"] for row in rows]
    assert times == sorted(set(times))
    assert 3590.0 < times[-1] - times[0] < 3610.0
    assert times[-3500:] == [index / 30.0 for index in range(count - 3500, count)]
    assert max(late - early for early, late in pairwise(times)) < 2.1
    first = next(name for name in ONE_AXIS.columns if name.endswith("_hi"))
    spikes = [row["t_s"] for row in rows if row[first] == 500.0]
    assert len(spikes) == 1
    assert 0.0 <= spikes[0] - spike / 30.0 < 2.1
    assert len(rows) * ONE_AXIS.record.size < 1 << 20, "more than waits for a client"


@dataclass
class FakeService:
    """A control socket that answers each command with the words it got."""

    path: str
    commands: list[str]


@pytest.fixture
def controlled(tmp_path: Path) -> Iterator[tuple[str, FakeService]]:
    """A page with a control socket behind it, and where it is."""
    listening = socket.socket(socket.AF_UNIX)
    service = FakeService(str(tmp_path / "control"), [])
    listening.bind(service.path)
    listening.listen()

    def answer() -> None:
        while True:
            try:
                connection, _ = listening.accept()
            except OSError:
                return
            with connection:
                service.commands.append(connection.makefile().readline().strip())
                connection.sendall(b'{"ok": true, "yaw_deg": 0.0}\n')

    answering = Thread(target=answer)
    answering.start()
    with hub() as outputs:
        outputs.access(service.path, TOKEN)
        outputs.want("web:port=0,reached_as=gyro.example")
        yield outputs.opened()[0].address, service
    listening.shutdown(socket.SHUT_RDWR)
    listening.close()
    answering.join()


TOKEN = "0123456789abcdef"


def test_a_local_page_with_the_token_gives_commands(controlled: tuple[str, FakeService]) -> None:
    address, service = controlled
    with looking(address, origin=address) as client:
        assert report(client, "hello")["has_buttons"] is True
        client.send(json.dumps({"token": TOKEN, "command": "zero"}))
        assert report(client, "answer") == {"kind": "answer", "command": "zero", "answer": {"ok": True, "yaw_deg": 0.0}}
    assert service.commands == ["zero"]


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize(
    ("token", "command", "reason"),
    [
        ("0123456789abcdee", "zero", "the token is wrong"),
        ("", "zero", "the token is wrong"),
        (None, "zero", "the token is wrong"),
        (TOKEN, "stop", "there is no such button"),
        (TOKEN, "zero\nstop", "there is no such button"),
        (TOKEN, "zero ", "there is no such button"),
        (TOKEN, 7, "expected a token and a command"),
    ],
)
def test_a_wrong_token_or_button_closes_the_page(
    controlled: tuple[str, FakeService], token: str | None, command: Any, reason: str
) -> None:
    """A wrong token or button closes the page."""
    address, service = controlled
    with looking(address, origin=address) as client:
        client.send(json.dumps({"token": token, "command": command}))
        with pytest.raises(ConnectionClosed, match=reason):
            report(client, "nothing")
    assert service.commands == []


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize(
    "content", ["[" * 60_000, '{"token":' * 5000, "NaN", b"\xff", "", '"\\ud800"', "9" * 5000, "[]"]
)
def test_a_message_that_is_no_command_closes_the_page(
    controlled: tuple[str, FakeService], content: str | bytes
) -> None:
    """A message that is no command closes the page, and is no error of the server."""
    address, service = controlled
    with looking(address, origin=address) as client:
        client.send(content)
        with pytest.raises(ConnectionClosed, match=r"1008 .*(this is no JSON|nested more|expected a token)"):
            report(client, "nothing")
    assert service.commands == []


@pytest.mark.promise("Clients of outputs")
def test_a_page_that_is_clicked_faster_than_the_service_answers_stays_open(tmp_path: Path) -> None:
    """A page keeps its buttons if it is clicked faster than the service answers."""
    clicks = 10
    with socket.socket(socket.AF_UNIX) as listening, hub() as outputs:
        path = str(tmp_path / "control")
        listening.bind(path)
        listening.listen()
        outputs.access(path, TOKEN)
        outputs.want("web:port=0")
        address = outputs.opened()[0].address
        with looking(address, origin=address) as client:
            for _ in range(clicks):
                client.send(json.dumps({"token": TOKEN, "command": "zero"}))
            busy = [report(client, "answer")["answer"] for _ in range(clicks - MOST_PENDING)]
            assert busy == [{"ok": False, "error": "the service is busy; try again"}] * (clicks - MOST_PENDING)
            for _ in range(MOST_PENDING):
                listening.accept()[0].close()
            late = [report(client, "answer")["answer"] for _ in range(MOST_PENDING)]
            assert {answer["ok"] for answer in late} == {False}


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize(
    ("host", "origin"),
    [("gyro.example", "http://gyro.example"), ("192.0.2.1", "http://192.0.2.1"), ("127.0.0.1:80", None)],
)
def test_a_page_that_was_not_opened_through_loopback_has_no_buttons(
    controlled: tuple[str, FakeService], host: str, origin: Any
) -> None:
    """The buttons of the live page work for the local user only."""
    address, service = controlled
    here = urlsplit(address)
    connection = socket.create_connection((here.hostname or "", here.port or 0))
    with connect(f"ws://{host}/stream", sock=connection, compression=None, origin=origin) as client:
        assert report(client, "hello")["has_buttons"] is False
        client.send(json.dumps({"token": TOKEN, "command": "zero"}))
        with pytest.raises(ConnectionClosed, match="takes no messages"):
            report(client, "nothing")
    assert service.commands == []


def test_only_loopback_addresses_count_as_this_machine() -> None:
    assert [is_loopback(host) for host in ("127.0.0.1", "::1", "::ffff:127.0.0.1", "localhost")] == [True] * 4
    assert [is_loopback(host) for host in ("192.0.2.1", "::ffff:192.0.2.1", "gyro", "0.0.0.0", "")] == [False] * 5
    opened = [OutputStatus("tcp", "127.0.0.1:1"), OutputStatus("web:host=0.0.0.0", "http://0.0.0.0:8117")]
    assert page_url(opened, "t") == "http://127.0.0.1:8117/#token=t"
    assert page_url([OutputStatus("web", "http://[::1]:8117")], "t") == "http://[::1]:8117/#token=t"
    with pytest.raises(CommandError, match=r"its buttons need host=127\.0\.0\.1"):
        page_url([OutputStatus("web", "http://192.0.2.1:8117")], "t")
    with pytest.raises(CommandError, match="no live page is open"):
        page_url(opened[:1], "t")
    with pytest.raises(CommandError, match="the live page is not open: port 8117 is in use"):
        page_url([OutputStatus("web", problem="port 8117 is in use")], "t")


@pytest.mark.promise("Clients of outputs")
def test_two_host_headers_are_refused() -> None:
    """A request with two Host headers is refused, whatever their order is."""
    for hosts in (["localhost", "evil.example"], ["evil.example", "localhost"], ["localhost", "localhost"]):
        headers = Headers([("Host", host) for host in hosts])
        response = Assets().answer(cast("Any", None), http11.Request("/", headers))
        assert response is not None
        assert response.status_code == 403
        origin = Headers([*headers.raw_items(), ("Origin", f"http://{hosts[0]}")])
        connection = SimpleNamespace(request=http11.Request("/stream", origin), remote_address=("127.0.0.1", 5))
        assert not is_local(cast("Any", connection))
