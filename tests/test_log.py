"""The log: what goes to a terminal or a file."""

import io

import pytest

from gyrodrift.io.log import open_log


@pytest.mark.parametrize("style", ["text", "json"])
def test_what_others_call_themselves_commands_no_terminal(style: str) -> None:
    """Control characters of all kinds are written as escapes; words of any language stay as they are."""
    to = io.StringIO()
    open_log("info", style, to).info("device", name="\x1b]0;owned\x07 \x9b2J\u202e", place="Köln")
    assert to.getvalue().rstrip("\n").isprintable()
    assert ("\\u001b" if style == "json" else "x1b]0;owned") in to.getvalue()
    assert ("K\\u00f6ln" if style == "json" else "Köln") in to.getvalue()
