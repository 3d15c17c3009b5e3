"""Reads WebSocket outputs until it is stopped, `KIND=URL` each, and says how many messages of each came."""

import json
import signal
import sys
from collections import Counter
from functools import partial
from threading import Thread

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect
from websockets.typing import Subprotocol

PATHS = {"web": "/stream"}
PROTOCOLS = {"foxglove": [Subprotocol("foxglove.sdk.v1")]}


def subscribe(kind: str, client: ClientConnection) -> None:
    """Ask for all that there is; the page's stream comes by itself."""
    if kind == "rosbridge":
        client.send(json.dumps({"op": "subscribe", "topic": "/imu/data"}))
    if kind == "foxglove":
        while (told := json.loads(client.recv()))["op"] != "advertise":
            pass
        asks = [{"id": number, "channelId": each["id"]} for number, each in enumerate(told["channels"])]
        client.send(json.dumps({"op": "subscribe", "subscriptions": asks}))


def read(kind: str, url: str, heard: Counter[str]) -> None:
    """Count messages, for ever."""
    with connect(url + PATHS.get(kind, ""), subprotocols=PROTOCOLS.get(kind), compression=None) as client:
        subscribe(kind, client)
        try:
            for _ in client:
                heard[kind] += 1
        except ConnectionClosed:
            return


def main() -> None:
    """One thread for each."""
    asked = [word.partition("=")[::2] for word in sys.argv[1:]]
    heard = Counter({kind: 0 for kind, _ in asked})
    for kind, url in asked:
        Thread(target=partial(read, kind, url, heard), daemon=True).start()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(0))
    try:
        signal.pause()
    finally:
        print(json.dumps(heard), flush=True)


if __name__ == "__main__":
    main()
