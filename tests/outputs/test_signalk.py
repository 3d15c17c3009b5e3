"""Deltas of Signal K: by hand, and as a Signal K server shows them."""

from math import nan, radians
from pathlib import Path
from typing import Any

import pytest
from outputs_support import HubThread, connected, corrected, tilted
from signalk_support import signalk_server

from gyrodrift.outputs.signalk import delta
from gyrodrift.values.sample import Corrected


def values(sample: Corrected) -> dict[str, Any]:
    (update,) = delta(sample)["updates"]
    return {entry["path"]: entry["value"] for entry in update["values"]}


def test_a_delta_has_what_is_known() -> None:
    level = values(corrected(0, heading_deg=270.0))
    assert level == {"navigation.rateOfTurn": near(-1.25), "navigation.headingTrue": near(270.0)}
    assert values(corrected(0, heading_deg=nan)).keys() == {"navigation.rateOfTurn"}


def near(angle_deg: float) -> Any:
    return pytest.approx(radians(angle_deg), abs=1e-6)


def test_an_attitude_is_positive_to_starboard_and_with_the_bow_up() -> None:
    attitude = values(tilted(0, yaw_deg=190.0))["navigation.attitude"]
    assert attitude == {"roll": near(10.0), "pitch": near(20.0), "yaw": near(170.0)}
    unknown = tilted(0).attitude
    assert unknown is not None
    sample = tilted(0)._replace(attitude=unknown._replace(roll_deg=nan))
    assert "navigation.attitude" not in values(sample)


def test_a_client_gets_deltas_ten_times_a_second(outputs: HubThread) -> None:
    outputs.want("signalk:port=0")
    with connected(outputs.endpoint()) as client:
        client.connection.sendall(b'{"context":"*","subscribe":[]}\n')
        while outputs.statuses()[0].client_count == 0:
            pass
        outputs.samples([tilted(seq) for seq in range(21)])
        times = [client.json()["updates"][0]["timestamp"] for _ in range(3)]
    assert times == [f"2023-11-14T22:13:20.{tenths}00Z" for tenths in range(3)]


@pytest.mark.promise("Clients of outputs")
def test_signalk_server_shows_the_attitude(outputs: HubThread, tmp_path: Path) -> None:
    """A Signal K server shows the attitude."""
    outputs.want("signalk:port=0")
    source = {"type": "tcp", "host": "127.0.0.1", "port": str(outputs.endpoint()[1])}
    with signalk_server("SignalK", source, tmp_path) as server:
        shown = server.navigation("attitude", lambda number: outputs.samples([tilted(10 * number)]))
    assert shown["attitude"]["value"] == {"roll": near(10.0), "pitch": near(20.0), "yaw": near(-30.0)}
    assert shown["headingTrue"]["value"] == near(90.0)
    assert shown["rateOfTurn"]["value"] == near(-1.25)
    assert shown["attitude"]["$source"].startswith("gyro")
