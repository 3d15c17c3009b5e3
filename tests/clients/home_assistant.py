"""Home Assistant's own reading of a discovery document: home_assistant.py FILE, where `homeassistant` is installed.

Prints a JSON line: the version, what its schemas refuse or warn of, and the keys that they do not know, by entity.
"""

import asyncio
import json
import logging
import sys
from logging.handlers import QueueHandler
from pathlib import Path
from queue import SimpleQueue
from tempfile import TemporaryDirectory

from homeassistant.components.mqtt import binary_sensor, discovery, sensor
from homeassistant.const import __version__
from homeassistant.core import HomeAssistant
from homeassistant.helpers import frame

SCHEMAS = {"sensor": sensor.DISCOVERY_SCHEMA, "binary_sensor": binary_sensor.DISCOVERY_SCHEMA}


def unknown_keys(document: str) -> dict[str, list[str]]:
    device = discovery._parse_device_payload(None, document, "bench", None)
    result = {}
    for name, component in dict(device.get("components", {})).items():
        given = discovery.MQTTDiscoveryPayload(component)
        discovery._replace_all_abbreviations(given)
        schema = SCHEMAS[given.pop("platform")]
        discovery._merge_common_device_options(given, device)
        given |= {"device": device["device"], "origin": device["origin"]}
        result[name] = sorted(given.keys() - schema(dict(given)).keys())
    return result


async def main(document: str) -> None:
    """Within a core that has not been started, which templates ask for."""
    report: SimpleQueue[logging.LogRecord] = SimpleQueue()
    logging.getLogger("homeassistant").addHandler(QueueHandler(report))
    with TemporaryDirectory() as folder:
        frame.async_setup(HomeAssistant(folder))
        unknown = unknown_keys(document)
    complaints = [report.get().getMessage() for _ in range(report.qsize())]
    sys.stdout.write(json.dumps({"version": __version__, "complaints": complaints, "unknown": unknown}) + "\n")


asyncio.run(main(Path(sys.argv[1]).read_text()))
