"""The output mqtt with a real broker, mosquitto, and its own client, mosquitto_sub."""

import json
import os
import signal
import subprocess
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from broker_support import broker, certificate, need_mosquitto, needs_openssl
from clients_support import python_client
from outputs_support import await_problem, corrected, csv_at_100_hz, events, hub, path_of, serving, tilted
from support import PATIENCE_S, awaited, free_port, never

from gyrodrift.config.outputs import output_of
from gyrodrift.outputs.home_assistant import Topics, discovery
from gyrodrift.outputs.status import DeviceStatus, LinkStatus, ServiceStatus

pytest.importorskip("aiomqtt", reason="the extra mqtt is not installed")

need_mosquitto()

AVAILABILITY = "gyrodrift/bench/availability"


@pytest.fixture
def number() -> int:
    """A port that nobody has."""
    return free_port()


def heard(number: int, topic: str, count: int, *options: str) -> list[str]:
    command = [
        "mosquitto_sub",
        "-h",
        "127.0.0.1",
        "-p",
        str(number),
        "-t",
        topic,
        "-C",
        str(count),
        "-W",
        str(round(PATIENCE_S)),
        "-F",
        "%r %p",
        *options,
    ]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 0, result
    return result.stdout.splitlines()


@contextmanager
def subscribed(number: int, topic: str, count: int) -> Iterator[Iterator[str]]:
    """Payloads of a topic in mosquitto_sub, which has subscribed; `count` of them, then it ends."""
    command = [
        "mosquitto_sub",
        "-h",
        "127.0.0.1",
        "-p",
        str(number),
        "-t",
        AVAILABILITY,
        "-t",
        topic,
        "-C",
        str(count + 1),
        "-W",
        str(round(PATIENCE_S)),
    ]
    with subprocess.Popen([*command, "-F", "%p"], stdout=subprocess.PIPE, text=True) as client:
        assert client.stdout is not None
        try:
            assert client.stdout.readline() == "online\n"
            yield (line.rstrip("\n") for line in client.stdout)
        finally:
            client.kill()


def entry(number: int, topic: str, *options: str) -> Any:
    """The next JSON of a topic."""
    return json.loads(heard(number, topic, 1, *options)[0].partition(" ")[2])


def test_home_assistant_finds_the_service_and_every_topic_it_names(number: int, port: Path, tmp_path: Path) -> None:
    """The real command: discovery and link are retained, and templates ask for keys that are sent."""
    options = f"mqtt:port={number},id=bench,rate_hz=100"
    with broker(number, tmp_path), serving(port, "--output", options) as (serve, device):
        assert path_of(serve, "mqtt") == f"127.0.0.1:{number}/gyrodrift/bench/state"
        assert heard(number, "gyrodrift/bench/availability", 1) == ["1 online"]
        retained, _, text = heard(number, "homeassistant/device/bench/config", 1)[0].partition(" ")
        document = json.loads(text)
        assert retained == "1"
        with subscribed(number, "gyrodrift/bench/state", 5) as heard_states:
            device.send_all(csv_at_100_hz(60), never)
            states = [json.loads(item) for item in heard_states]
        lines = {line["seq"]: line for line in serve.take_lines(59)}
        assert len(states) == 5
        for item in states:
            assert item.items() >= lines[item["seq"]].items()
        statement = {"gyrodrift/bench/state": states[0], "gyrodrift/bench/link": entry(number, "gyrodrift/bench/link")}
        for component in document["cmps"].values():
            key = component["val_tpl"].partition("value_json.")[2].split()[0]
            assert key in statement[component["stat_t"]]
        assert serve.stop() == 0
        assert heard(number, "gyrodrift/bench/availability", 1) == ["1 offline"]


def test_the_last_will_speaks_for_a_process_that_was_killed(number: int, port: Path, tmp_path: Path) -> None:
    with broker(number, tmp_path), serving(port, "--output", f"mqtt:port={number},id=bench") as (serve, _):
        path_of(serve, "mqtt")
        with subscribed(number, "nothing/else", 2) as lines:
            own = serve.process.pid
            children = Path(f"/proc/{own}/task/{own}/children").read_text().split()
            subprocess.run(["kill", "-9", *children], check=True)
            assert next(lines) == "offline"
            serve.until(lambda it: len(events(it, "output_open", "mqtt")) == 2, "second opening")
            assert next(lines) == "online"


@pytest.mark.promise("Memory and the end")
def test_who_subscribes_after_the_kill_learns_it_from_the_retained_last_will(
    number: int, port: Path, tmp_path: Path
) -> None:
    """After a kill, an MQTT broker says `offline`."""
    with broker(number, tmp_path), serving(port, "--output", f"mqtt:port={number},id=bench") as (serve, _):
        path_of(serve, "mqtt")
        assert heard(number, AVAILABILITY, 1) == ["1 online"]
        (child,) = Path(f"/proc/{serve.process.pid}/task/{serve.process.pid}/children").read_text().split()
        serve.process.send_signal(signal.SIGSTOP)
        os.kill(int(child), signal.SIGKILL)
        awaited(lambda: heard(number, AVAILABILITY, 1), lambda states: states == ["1 offline"])


def test_a_broker_that_is_away_is_told_and_tried_again(number: int, tmp_path: Path) -> None:
    with hub() as outputs:
        outputs.want(f"mqtt:port={number},id=bench")
        assert f"the broker at 127.0.0.1:{number}" in await_problem(outputs, "refused")
        with broker(number, tmp_path):
            outputs.opened()
        while not outputs.statuses()[0].problem:
            outputs.status(ServiceStatus())
        with broker(number, tmp_path):
            outputs.opened()
            assert heard(number, "gyrodrift/bench/availability", 1) == ["1 online"]


def test_a_broker_that_does_not_read_loses_the_oldest_states_and_gets_the_newest(number: int, tmp_path: Path) -> None:
    with broker(number, tmp_path) as process, hub() as outputs:
        outputs.want(f"mqtt:port={number},id=bench,rate_hz=1000,discovery=")
        outputs.opened()
        with subscribed(number, "gyrodrift/bench/state", 1_000_000) as lines:
            process.send_signal(signal.SIGSTOP)
            seq = 0
            while not outputs.statuses()[0].dropped:
                outputs.samples([corrected(seq + item) for item in range(5000)])
                seq += 5000
            process.send_signal(signal.SIGCONT)
            outputs.samples([corrected(seq)])
            assert any(json.loads(line)["seq"] == seq for line in lines)


def test_home_assistant_that_starts_is_told_again_and_of_a_device_that_came_later(number: int, tmp_path: Path) -> None:
    with broker(number, tmp_path), hub() as outputs:
        outputs.want(f"mqtt:port={number},id=bench,discovery=ha")
        outputs.opened()
        assert "serial_number" not in entry(number, "ha/device/bench/config")["dev"]
        with subscribed(number, "ha/device/bench/config", 3) as lines:
            next(lines)
            outputs.status(ServiceStatus(device=DeviceStatus("G-17"), link=LinkStatus(is_open=True)))
            assert json.loads(next(lines))["dev"]["serial_number"] == "G-17"
            subprocess.run(["mosquitto_pub", "-p", str(number), "-t", "ha/status", "-m", "online"], check=True)
            assert json.loads(next(lines))["dev"]["serial_number"] == "G-17"


def test_home_assistant_learns_of_a_tilt_with_the_first_sample_that_has_one(number: int, tmp_path: Path) -> None:
    """A device with one axis has no sensors of tilt, which would never have a value."""
    with broker(number, tmp_path), hub() as outputs:
        outputs.want(f"mqtt:port={number},id=bench,discovery=ha")
        outputs.opened()
        with subscribed(number, "ha/device/bench/config", 2) as lines:
            before = json.loads(next(lines))["cmps"]
            with subscribed(number, "gyrodrift/bench/state", 1) as states:
                outputs.samples([tilted(seq=1)])
                state = json.loads(next(states))
            after = json.loads(next(lines))["cmps"]
    assert after.keys() - before.keys() == {"tilt_deg", "roll_deg", "pitch_deg", "tilt_sigma_deg"}
    assert all(state[name] is not None for name in after.keys() - before.keys())


# paho-mqtt leaves a socket whose handshake failed to the garbage collector, which closes it.
@pytest.mark.filterwarnings("ignore:Exception ignored in. <ssl.SSLSocket:pytest.PytestUnraisableExceptionWarning")
@needs_openssl
def test_user_password_and_certificate_are_checked(number: int, tmp_path: Path) -> None:
    """A wrong one of each is told; the right ones open; the password is shown to nobody."""
    users, trusted, secret = tmp_path / "users", certificate(tmp_path), tmp_path / "secret"
    subprocess.run(["mosquitto_passwd", "-c", "-b", users, "ann", "s3cret"], check=True, capture_output=True)
    secret.write_text("s3cret\n")
    lines = [f"certfile {trusted}", f"keyfile {trusted.with_suffix('.key')}", f"password_file {users}"]
    right = f"mqtt:port={number},id=bench,tls=true,user=ann,ca={trusted}"
    with broker(number, tmp_path, *lines, "allow_anonymous false"), hub() as outputs:
        outputs.want(f"mqtt:port={number},tls=true,user=ann,password=s3cret")
        assert await_problem(outputs, "CERTIFICATE_VERIFY_FAILED")
        outputs.want(f"{right},password=wr0ng")
        assert await_problem(outputs, "ot authorized")
        assert "password=***" in outputs.statuses()[0].output
        outputs.want(f"{right},password_file={secret}")
        outputs.opened()
        access = ["--cafile", str(trusted), "-u", "ann", "-P", "s3cret"]
        assert heard(number, "gyrodrift/bench/availability", 1, *access) == ["1 online"]


@pytest.mark.parametrize(
    ("option", "problem"),
    [
        ("id=a/b", "letters"),
        ("topic=a/#", "may have no"),
        ("password_file=/nowhere", "cannot read password_file"),
        ("tls=true,ca=/nowhere", "cannot use the certificates"),
    ],
)
def test_options_that_cannot_be_are_told(option: str, problem: str) -> None:
    with hub() as outputs:
        outputs.want(f"mqtt:{option}")
        assert await_problem(outputs, problem)


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize("option", ["ca", "certificate", "key"])
def test_a_pipe_in_the_place_of_a_certificate_stops_no_other_output(tmp_path: Path, option: str) -> None:
    """A pipe instead of an MQTT certificate stops no other output."""
    pipe, trusted = tmp_path / "pipe", tmp_path / "trusted"
    os.mkfifo(pipe)
    trusted.touch()
    first = f"certificate={trusted}," if option == "key" else ""
    with hub() as outputs:
        outputs.want(f"mqtt:tls=true,{first}{option}={pipe}")
        assert await_problem(outputs, "is no ordinary file")


def test_a_password_that_mqtt_cannot_send_is_told(tmp_path: Path) -> None:
    secret = tmp_path / "secret"
    secret.write_text("x" * 65536)
    with hub() as outputs:
        outputs.want(f"mqtt:user=ann,password_file={secret}")
        assert await_problem(outputs, "cannot read password_file")


def test_what_is_not_known_is_null(number: int, tmp_path: Path) -> None:
    with broker(number, tmp_path), hub() as outputs:
        outputs.want(f"mqtt:port={number},id=bench,discovery=")
        outputs.opened()
        with subscribed(number, "gyrodrift/bench/state", 1) as lines:
            outputs.samples([corrected(seq=1, heading_deg=float("nan"))])
            state = json.loads(next(lines))
        assert state["heading_deg"] is None
        assert state["yaw_deg"] == 0.0125


def test_the_discovery_document_has_what_home_assistant_asks_for() -> None:
    """Keys that its device schema knows, each entity with a platform and an identity of its own."""
    document = json.loads(discovery("bench", Topics.of("gyrodrift", "bench"), DeviceStatus("G-17"), "1.0"))
    assert document.keys() == {"dev", "o", "cmps", "avty", "avty_mode", "stat_t"}
    assert document["dev"].keys() <= {"ids", "cns", "name", "mf", "mdl", "sw", "hw", "serial_number"}
    assert document["o"].keys() <= {"name", "sw", "url"}
    components = document["cmps"].values()
    assert len({item["uniq_id"] for item in components}) == len(components)
    assert all(item["p"] in ("sensor", "binary_sensor") and item["stat_t"] for item in components)


def test_home_assistant_itself_takes_the_discovery_document(tmp_path: Path) -> None:
    document = tmp_path / "document.json"
    topics = Topics.of("gyrodrift", "bench")
    document.write_text(discovery("bench", topics, DeviceStatus("G-17"), "1.0", has_axes=True))
    statement, complaint = python_client("homeassistant", "home_assistant.py", str(document)).communicate(
        timeout=PATIENCE_S
    )
    assert complaint == ""
    result = json.loads(statement)
    assert result["complaints"] == []
    assert result["unknown"] == {key: [] for key in json.loads(document.read_text())["cmps"]}


def test_a_password_is_no_part_of_what_is_shown() -> None:
    """Options that are given are, the password is not."""
    spec = output_of("mqtt:user=ann,password=s3cret")
    assert str(spec) == "mqtt:user=ann,password=***"
