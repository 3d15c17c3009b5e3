"""JSON schemas of the output `foxglove`. Unknown values are omitted, so no property is required."""

from dataclasses import fields
from types import NoneType, UnionType
from typing import Any, get_args, get_origin, get_type_hints

from gyrodrift.outputs.json_line import FIELDS

TYPES = {int: "integer", float: "number", str: "string", bool: "boolean", dict: "object"}

SAMPLE_SCHEMA = {
    "title": "gyrodrift.Sample",
    "type": "object",
    "properties": {name: {"type": "integer" if name == "seq" else "number"} for name in FIELDS},
}


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
