"""Discovery document for Home Assistant over MQTT, with all entities of the service.

Keys are the abbreviations of MQTT discovery, or whole words if there is no abbreviation:
https://www.home-assistant.io/integrations/mqtt/#device-discovery-payload
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from gyrodrift.outputs.fields import OF_EVERY_DEVICE, OF_THREE_AXES, Field, Use, fields_of
from gyrodrift.outputs.status import DeviceStatus

ONLINE, OFFLINE = "online", "offline"
BIRTH = "online"
"""Message of Home Assistant on `PREFIX/status` when it starts."""


@dataclass(frozen=True, slots=True)
class Topics:
    """Topics of a service.

    state, link
        JSON of the last sample and of the serial link.
    availability
        `online` or `offline`, by last will.
    """

    state: str
    link: str
    availability: str

    @classmethod
    def of(cls, base: str, name: str) -> "Topics":
        """Topics below `base/name`."""
        return cls(*(f"{base}/{name}/{part}" for part in ("state", "link", "availability")))


@dataclass(frozen=True, slots=True)
class Entity:
    """One sensor: the key of its JSON value, and how it is displayed."""

    key: str
    name: str
    unit: str | None = None
    decimals: int | None = None
    device_class: str | None = None
    state_class: str | None = "measurement"


UNITS = {"deg": "°", "deg/s": "°/s", "": None}
DEVICE_CLASSES = {"°C": "temperature"}
NO_MEAN = ("heading_deg",)
"""A mean of headings has no meaning, so heading has no state class."""


def _entity(field: Field) -> Entity:
    unit, state_class = UNITS.get(field.unit, field.unit), None if field.name in NO_MEAN else "measurement"
    return Entity(field.name, field.title, unit, field.shown, DEVICE_CLASSES.get(field.unit), state_class)


MEASURED, TILT = (tuple(map(_entity, fields_of(Use.SENSOR, table))) for table in (OF_EVERY_DEVICE, OF_THREE_AXES))
"""Sensors of `Topics.state`, and further ones of a device with three axes."""

DIAGNOSTIC = (
    Entity("rate_hz", "Sample rate", "Hz", 1, "frequency"),
    Entity("jitter_ms", "Jitter", "ms", 2, "duration"),
    Entity("missing", "Lost samples", None, 0, None, "total_increasing"),
    Entity("damaged", "Damaged frames", None, 0, None, "total_increasing"),
    Entity("reconnects", "Reconnects", None, 0, None, "total_increasing"),
    Entity("health", "Health", state_class=None),
)
"""Sensors of `Topics.link`."""


def discovery(name: str, topics: Topics, device: DeviceStatus, version: str, *, has_axes: bool = False) -> str:
    """Document for `PREFIX/device/NAME/config`, as JSON.

    Parameters
    ----------
    has_axes
        Whether the device has three axes, and so an attitude.
    """
    measured = MEASURED + TILT if has_axes else MEASURED
    service = {"t": topics.availability}
    link = {"t": topics.link, "val_tpl": _template(f"'{ONLINE}' if value_json.is_open else '{OFFLINE}'")}
    components: dict[str, Any] = {
        entity.key: _sensor(name, entity, topics.state) | {"avty": [service, link]} for entity in measured
    }
    components |= {entity.key: _sensor(name, entity, topics.link) | {"ent_cat": "diagnostic"} for entity in DIAGNOSTIC}
    components["is_open"] = {
        "p": "binary_sensor",
        "uniq_id": f"{name}_is_open",
        "name": "Serial link",
        "dev_cla": "connectivity",
        "ent_cat": "diagnostic",
        "stat_t": topics.link,
        "val_tpl": _template("'ON' if value_json.is_open else 'OFF'"),
    }
    document = {
        "dev": _device(name, device, version),
        "o": {"name": "gyrodrift", "sw": version},
        "cmps": components,
        "avty": [service],
        "avty_mode": "all",
        "stat_t": topics.state,
    }
    return json.dumps(document, ensure_ascii=False)


def _device(name: str, device: DeviceStatus, version: str) -> Mapping[str, Any]:
    serial = {"serial_number": device.device_id} if device.device_id else {}
    return {"ids": [name], "name": name, "mf": "gyrodrift", "mdl": "Gyro on a serial link", "sw": version, **serial}


def _sensor(name: str, entity: Entity, topic: str) -> dict[str, Any]:
    settings = {
        "unit_of_meas": entity.unit,
        "dev_cla": entity.device_class,
        "stat_cla": entity.state_class,
        "suggested_display_precision": entity.decimals,
    }
    return {
        "p": "sensor",
        "uniq_id": f"{name}_{entity.key}",
        "name": entity.name,
        "stat_t": topic,
        "val_tpl": _template(f"value_json.{entity.key}"),
        **{key: value for key, value in settings.items() if value is not None},
    }


def _template(expression: str) -> str:
    return f"{{{{ {expression} }}}}"
