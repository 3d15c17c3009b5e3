"""Why nothing could be read of a device, and what to try, from what came of it."""

import shlex

from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.registry import PROTOCOLS, listed

CSV_LINE = "t_us,rate_dps[,encoder_deg[,temp_c[,still]]]"
MOST_NAMES = 12


def why_silent(
    timeout_s: float, baud: int | None, heard_bytes: int, decoder: Decoder | None, protocol: str, heard: Heard
) -> str:
    """What to tell a person whose device said nothing that can be decoded within `timeout_s`.

    `baud` is the line rate that was given, None where it was to be found; `decoder` is the one that was chosen, by
    what was asked for as `protocol`; `heard` holds the last of the `heard_bytes`.
    """
    waited = f"within {timeout_s:g} s"
    if not heard_bytes:
        return f"the device said nothing {waited}; is it powered, is this its port, are TX and RX the right way round?"
    if decoder is not None and decoder.counters.before_hello:
        return (
            f"{decoder.counters.before_hello} samples came {waited}, but no HELLO frame that says their scale; "
            "the device has to send one once a second"
        )
    if decoder is not None and decoder.counters.other:
        advice = PROTOCOLS[decoder.name].without_rate
        return (
            f"{decoder.counters.other} good {decoder.name} frames came {waited}, but none with a yaw rate"
            f"{f'; {advice}' if advice else ''}"
        )
    if heard.is_text:
        return _why_text(protocol, heard)
    wanted = listed() if decoder is None and protocol == "auto" else protocol
    tried = "any of the usual baud rates" if baud is None else f"{baud} baud"
    what_to_do = (
        "a rate that is none of the usual ones looks like this, and so does another protocol: give the rate with --baud"
        if baud is None
        else "a wrong baud rate looks like this: leave --baud out, and the usual rates are tried one after the other"
    )
    return f"{heard_bytes} bytes came {waited}, but no {wanted} frame in them at {tried}; {what_to_do}"


def _why_text(protocol: str, heard: Heard) -> str:
    """Of a device that prints lines: what they look like, what is expected, and how they are read as they are."""
    from gyrodrift.link.text.guess import guess  # noqa: PLC0415 - only a stream that nobody understands needs it

    lines = heard.lines()
    guessed = guess(lines, heard.lines_per_s)
    came = f"the device prints text, so the baud rate is right, but no line is a {_wanted(protocol)}"
    if guessed is None:
        last = lines[-1] if lines else ""
        return (
            f"{came}: {quoted(last)} looks like a message for people; is its program running, does it wait for a key?"
        )
    names = [column.said for column in guessed.columns]
    shown = ", ".join(names[:MOST_NAMES]) + (", …" if len(names) > MOST_NAMES else "")
    looks = f"{came}: {quoted(guessed.example)} looks like {shown} ({guessed.form})"
    if guessed.spec is None:
        return f"{looks}, without a yaw rate; {_expected(protocol)}, or name its columns with --columns"
    reasons = "; ".join(f"{column.said} {column.why}" for column in guessed.columns if column.entry != "_")
    return f"{looks}; {_expected(protocol)}, or read it as it is: --columns {shlex.quote(guessed.spec)} ({reasons})"


def _wanted(protocol: str) -> str:
    if protocol == text.NAME:
        return "sample by the columns of --columns"
    return f"{protocol} sample" if protocol != "auto" else f"{listed()} sample"


def _expected(protocol: str) -> str:
    """What a device that prints could print instead."""
    return f"expected is {CSV_LINE}" if protocol in {"auto", "csv"} else f"expected is --protocol {protocol}"
