"""JSON schemas of the output `foxglove`. Unknown values are omitted, so no property is required."""

from dataclasses import fields
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from gyrodrift.outputs.json_line import NAMES

TYPES = {int: "integer", float: "number", str: "string", bool: "boolean", dict: "object"}

NUMBERS = {"type": "array", "items": {"type": "number"}}
LISTS = ("q", "bias_xyz_dps")
"""Fields with several numbers."""

SAMPLE_SCHEMA = {
    "title": "gyrodrift.Sample",
    "type": "object",
    "properties": {name: {"type": "number"} for name in NAMES}
    | {"seq": {"type": "integer"}}
    | dict.fromkeys(LISTS, NUMBERS),
}


TIME_SCHEMA = {"type": "object", "properties": {"sec": {"type": "integer"}, "nsec": {"type": "integer"}}}
VECTOR_SCHEMA = {"type": "object", "properties": {name: {"type": "number"} for name in "xyz"}}
QUATERNION_SCHEMA = {"type": "object", "properties": {name: {"type": "number"} for name in "xyzw"}}

POSE_SCHEMA = {
    "title": "foxglove.PoseInFrame",
    "type": "object",
    "properties": {
        "timestamp": TIME_SCHEMA,
        "frame_id": {"type": "string"},
        "pose": {"type": "object", "properties": {"position": VECTOR_SCHEMA, "orientation": QUATERNION_SCHEMA}},
    },
}
"""Schema that the app draws as a pose; source: schemas/jsonschema/PoseInFrame.json of foxglove/foxglove-sdk."""


def schema_of(title: str, record: type[Any]) -> dict[str, Any]:
    """Schema of a dataclass of plain values."""
    hints = get_type_hints(record)
    return {
        "title": title,
        "type": "object",
        "properties": {field.name: {"type": _type_of(hints[field.name])} for field in fields(record)},
    }


def _type_of(hint: Any) -> str:
    if isinstance(hint, UnionType):
        hint = next(option for option in get_args(hint) if option is not NoneType)
    return TYPES[get_origin(hint) or hint]
