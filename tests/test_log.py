"""The log: what goes to a terminal or a file."""

import io
from typing import Any

import pytest

from gyrodrift.io.log import open_log
from gyrodrift.io.log_words import sentence


@pytest.mark.parametrize("style", ["text", "json"])
def test_what_others_call_themselves_commands_no_terminal(style: str) -> None:
    """Control characters of all kinds are written as escapes; words of any language stay as they are."""
    to = io.StringIO()
    open_log("info", style, to).info("device", name="\x1b]0;owned\x07 \x9b2J\u202e", place="Köln")
    assert to.getvalue().rstrip("\n").isprintable()
    assert ("\\u001b" if style == "json" else "x1b]0;owned") in to.getvalue()
    assert ("K\\u00f6ln" if style == "json" else "Köln") in to.getvalue()


@pytest.mark.parametrize(
    ("event", "fields", "words"),
    [
        ("link_open", {"port": "/dev/ttyUSB0", "baud": 9600}, "Reading /dev/ttyUSB0 at 9600 baud."),
        ("output_open", {"output": "web", "address": "http://127.0.0.1:8117"}, "Open http://127.0.0.1:8117"),
        ("axes_missing", {"seconds": 2.5, "hint": "yaw goes on"}, "Axes missing: yaw goes on (seconds 2.5)"),
        ("from_a_package", {"speed_dps": 3.0}, "From a package (speed 3 deg/s)"),
        ("gap", {"other": 1}, "Gap (other 1)"),
        ("service_end", {"summary": "3 samples."}, "3 samples."),
    ],
)
def test_a_person_reads_a_sentence(event: str, fields: dict[str, Any], words: str) -> None:
    """An event without a sentence, or with other fields, is told by its name and fields."""
    assert sentence(event, fields) == words
