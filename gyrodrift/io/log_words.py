"""The log for a person on a terminal: a sentence for each event, wrapped at words to the width of the terminal."""

import textwrap
from collections.abc import Callable, Mapping
from typing import Any

from gyrodrift.io.terminal import columns_of
from gyrodrift.values.words import counted

STYLES = {"warning": "\x1b[33m", "error": "\x1b[31m", "critical": "\x1b[31m", "debug": "\x1b[2m"}
"""Colors of the words of a level: yellow, red and dim (ECMA-48 SGR)."""

DIM, PLAIN = "\x1b[2m", "\x1b[0m"

LABELS = {"warning": "Warning: ", "error": "Error: ", "critical": "Error: "}

LEAST_COLUMNS = 30
"""Narrower terminals get lines of this width."""

UNKNOWN_COLUMNS = 1000
"""A terminal that does not tell its width wraps by itself."""

UNITS = {
    "dps": "deg/s",
    "deg": "deg",
    "hz": "Hz",
    "s": "s",
    "ms": "ms",
    "c": "°C",
    "g": "g",
    "mps2": "m/s²",
    "ppm": "ppm",
    "bytes": "bytes",
}
"""Units by the last part of the name of a field."""

Fields = Mapping[str, Any]


def _baud(fields: Fields) -> str:
    return f" at {fields['baud']} baud" if "baud" in fields else ""


def _number(value: Any) -> str:
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _device(fields: Fields) -> str:
    parts = [
        f"{_number(fields['sample_rate_hz'])} samples/s" if fields.get("sample_rate_hz") else "",
        f"{fields['dps_per_lsb']:.3g} deg/s per step" if fields.get("dps_per_lsb") else "",
        f"encoder with {fields['encoder_cpr']} counts" if fields.get("encoder_cpr") else "",
        f"sends yaw of its own filter {fields['device_filter']}" if fields.get("device_filter") else "",
    ]
    stated = ", ".join(filter(None, parts))
    return f"The device is {fields['device_id']}{': ' if stated else ''}{stated}."


def _filter(fields: Fields) -> str:
    parameters = fields["parameters"]
    return (
        f"Filter {fields['name']}, {'at its defaults' if parameters == 'defaults' else f'parameters of {parameters}'}."
    )


def _output(fields: Fields) -> str:
    address = fields["address"]
    return f"Open {address}" if fields.get("output") == "web" else f"Output {fields.get('output', '')} at {address}."


def _changes(fields: Fields) -> str:
    changes = "; ".join(map(str, fields["changes"])) or "nothing changed"
    return f"{fields['file']} is applied: {changes}."


def _gap(fields: Fields) -> str:
    missing, seconds = fields["missing"], fields.get("longest_s", fields.get("seconds", 0.0))
    return f"{counted(missing, 'sample')} lost; the longest gap is {seconds:.3g} s."


SENTENCES: Mapping[str, Callable[[Fields], str]] = {
    "link_open": lambda it: f"Reading {it['port']}{_baud(it)}.",
    "link_lost": lambda it: f"{it['port']} is gone. Yaw and bias are kept until it is back.",
    "link_refused": lambda it: f"{it['port']} cannot be opened: {it['reason']}",
    "link_restored": lambda it: f"{it['port']} is back after {it['gone_s']:.1f} s.",
    "link_silent": lambda it: f"No sample for {it['seconds']:.0f} s.",
    "link_speaks": lambda _: "Samples arrive again.",
    "port_search": lambda it: f"Listening on {counted(it['ports'], 'port')}.",
    "port_found": lambda it: f"A gyro sends on {it['port']}: {it['protocol']}{_baud(it)}.",
    "protocol_found": lambda it: f"The protocol is {it['protocol']}.",
    "no_device_clock": lambda _: "The device sends no clock; samples are timed by their arrival.",
    "device": _device,
    "device_reset": lambda it: f"The device restarted; it was gone for {it['gone_s']:.1f} s.",
    "filter_chosen": _filter,
    "three_axes": lambda _: "The device sends three rates and accelerations: the attitude is estimated, too.",
    "output_open": _output,
    "output_failed": lambda it: f"Output {it['output']}: {it['reason']}. Next try in {it['retry_s']:g} s.",
    "config_applied": _changes,
    "config_completed": lambda it: (
        f"{it['file']} leaves these at their defaults: {', '.join(map(str, it['defaults']))}."
    ),
    "config_rejected": lambda it: f"The config is refused, and the old one stays. {it['reason']}",
    "config_gone": lambda it: f"{it['file']} is gone; the last valid config stays.",
    "config_back": lambda it: f"{it['file']} is there again.",
    "history_filtered": lambda it: (
        f"The last {it['seconds']:.0f} s were filtered again with the new parameters; yaw changed by "
        f"{it['step_deg']:+.2f} deg."
    ),
    "yaw_corrected": lambda it: f"Yaw was corrected by {it['step_deg']:+.2f} deg; the device did not turn.",
    "samples_rejected": lambda it: f"{it['count']} invalid samples, {it['total']} in all.",
    "gap": _gap,
    "memory_used": lambda it: f"The bias of {it['device']} is known from {it['file']}, {it['age_s']:.0f} s old.",
    "memory_new": lambda it: f"{it['file']} will keep what the filter learns about {it['device']}.",
    "calibration_applied": lambda it: f"The calibration of {it['date']} is applied.",
    "reader_gone": lambda _: "The reader of the output has closed it.",
}
"""Sentence of an event from its fields; an event without one is told by its name and fields."""


def sentence(event: str, fields: Fields) -> str:
    """Sentence about an event."""
    if "summary" in fields:
        return str(fields["summary"])
    words = SENTENCES.get(event)
    if words is not None:
        try:
            return words(fields)
        except (KeyError, TypeError, ValueError):  # an event of another package may have other fields
            pass
    return _plain(event, fields)


def _plain(event: str, fields: Fields) -> str:
    name = event.replace("_", " ")
    values = ", ".join(_value(key, value) for key, value in fields.items() if key not in {"hint", "reason"})
    says = "; ".join(str(fields[key]) for key in ("reason", "hint") if fields.get(key))
    parts = ": ".join(filter(None, (name[:1].upper() + name[1:], says)))
    return f"{parts} ({values})" if values else parts


def _value(key: str, value: Any) -> str:
    name, _, unit = key.rpartition("_")
    if name and unit in UNITS:
        return f"{name.replace('_', ' ')} {_number(value)} {UNITS[unit]}"
    return f"{key.replace('_', ' ')} {_number(value)}"


class PersonRenderer:
    """Renders an event as time, level and a sentence; further lines begin below the sentence.

    Parameters
    ----------
    fd
        Descriptor of the terminal.
    has_colors
        Whether warnings, errors and times are colored.
    """

    def __init__(self, fd: int, *, has_colors: bool) -> None:
        self._fd, self._has_colors = fd, has_colors

    def __call__(self, _logger: Any, _method: str, entry: Mapping[str, Any]) -> str:
        """Lines of an event, without the last line end."""
        fields = dict(entry)
        time, level, event = fields.pop("timestamp"), fields.pop("level"), fields.pop("event")
        source = f"{fields.pop('source')}: " if "source" in fields else ""
        text = f"{LABELS.get(level, '')}{source}{sentence(event, fields)}"
        margin = " " * (len(time) + 2)
        columns = max(columns_of(self._fd) or UNKNOWN_COLUMNS, LEAST_COLUMNS)
        lines = textwrap.wrap(
            text, columns - 1, initial_indent=margin, subsequent_indent=margin, break_on_hyphens=False
        )
        shown = "\n".join(lines)[len(margin) :]
        if not self._has_colors:
            return f"{time}  {shown}"
        return f"{DIM}{time}{PLAIN}  {STYLES.get(level, '')}{shown}{PLAIN if level in STYLES else ''}"
