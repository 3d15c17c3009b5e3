"""Why nothing could be read of a device, and what to try, from what came of it."""

import shlex

from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS, listed
from gyrodrift.link.unread import spoken

CSV_LINE = "t_us,rate_dps[,encoder_deg[,temp_c[,still]]]"
MOST_NAMES = 12
DATA_SHARE = 0.4
"""Of digits: in messages for people there are fewer, and in lines of numbers more."""

RATE_UNITS = "dps, rads, mdps or lsb/N"
ANGLE_NOTE = (
    ". It is an angle: the filter of the device has been at work. If it falls in a turn to the left, write :- behind it"
)


def why_silent(
    timeout_s: float,
    baud: int | None,
    heard_bytes: int,
    decoder: Decoder | None,
    protocol: str,
    heard: Heard,
    port: str,
) -> str:
    """What to tell a person whose device said nothing that can be decoded within `timeout_s`.

    `baud` is the line rate that was given, None where it was to be found; `decoder` is the one that was chosen, by
    what was asked for as `protocol`; `heard` holds the last of the `heard_bytes`, which came from `port`.
    """
    waited = f"within {timeout_s:g} s"
    if not heard_bytes:
        return f"the device said nothing {waited}; is it powered, is this its port, are TX and RX the right way round?"
    if decoder is not None and decoder.counters.before_hello:
        return (
            f"{decoder.counters.before_hello} samples came {waited}, but no HELLO frame that says their scale; "
            "the device has to send one once a second"
        )
    if decoder is not None and decoder.counters.other and not (decoder.name == text.NAME and heard.is_text):
        advice = PROTOCOLS[decoder.name].without_rate
        return (
            f"{decoder.counters.other} good {decoder.name} frames came {waited}, but none with a yaw rate"
            f"{f'; {advice}' if advice else ''}"
        )
    known = what_speaks(heard, protocol)
    if known:
        return known
    if heard.is_text:
        return _why_text(protocol, heard, port, waited)
    wanted = listed() if decoder is None and protocol == "auto" else protocol
    tried = "any of the usual baud rates" if baud is None else f"{baud} baud"
    what_to_do = (
        "a rate that is none of the usual ones looks like this, and so does another protocol: give the rate with --baud"
        if baud is None
        else "a wrong baud rate looks like this: leave --baud out, and the usual rates are tried one after the other"
    )
    return f"{heard_bytes} bytes came {waited}, but no {wanted} frame in them at {tried}; {what_to_do}"


def what_speaks(heard: Heard, protocol: str) -> str:
    """What is known of a stream that is none of what was asked for as `protocol`; empty where nothing is."""
    unread = spoken(heard.content)
    if unread is not None:
        return unread.said
    others = [each for each in PROTOCOLS.values() if each.is_detected and protocol not in {AUTO, each.name}]
    found = Detector(others).push(heard.content)
    if found is None:
        return ""
    instead = "--columns" if protocol == text.NAME else f"--protocol {protocol}"
    return f"the device speaks {found[0].name}, not {protocol}; leave {instead} out"


def _why_text(protocol: str, heard: Heard, port: str, waited: str) -> str:
    """Of a device that prints lines: what they look like, and how they are read, or what has to be asked."""
    from gyrodrift.link.text.guess import guess  # noqa: PLC0415 - only a stream that nobody understands needs it

    came = f"the device prints text, so the baud rate is right, but no line is a {_wanted(protocol)}"
    guessed = guess(heard.lines(), heard.lines_per_s)
    if guessed is None:
        return f"{came}: {quoted(heard.last_words())} {_without_columns(heard, waited)}"
    names = [column.said for column in guessed.columns]
    shown = ", ".join(names[:MOST_NAMES]) + (", …" if len(names) > MOST_NAMES else "")
    looks = f"{came}: {quoted(guessed.example)} looks like {shown} ({guessed.form})"
    turn_it = f"gyrodrift doctor --port {shlex.quote(port)} --turn"
    if guessed.turn is None or guessed.template is None:
        return (
            f"{looks}, and nothing says which of them is the yaw rate; {_expected(protocol)}, or say what the columns"
            f" are with --columns, or let a quarter turn tell: {turn_it}"
        )
    is_angle = guessed.turn.entry.startswith("yaw")
    columns = f"'{guessed.template}'"  # no label holds a quotation mark
    reasons = "; ".join(f"{column.said} {column.why}" for column in guessed.columns if column.entry != "_")
    if not guessed.is_unit_said:
        return (
            f"{looks} ({reasons}), but nothing says in which unit: put {'deg or rad' if is_angle else RATE_UNITS} in"
            f" place of UNIT in --columns {columns}, or let a quarter turn tell: {turn_it}"
        )
    note = ANGLE_NOTE if is_angle else ""
    return f"{looks}; {_expected(protocol)}, or read it as it is: --columns {columns} ({reasons}){note}"


def _without_columns(heard: Heard, waited: str) -> str:
    """What to do about data in a form that is not known, a board that is still starting, or one that waits."""
    text = "".join(heard.lines())
    if sum(character.isdigit() for character in text) >= DATA_SHARE * max(1, len(text)):
        return "looks like data in a form that is not known; is there another form of output that the device can send?"
    return (
        f"looks like a message for people; is its program running? If it is still starting up {waited}, wait longer"
        " with --timeout 30; if it waits for a key, send one with --send '\\r\\n'"
    )


def _wanted(protocol: str) -> str:
    if protocol == text.NAME:
        return "sample by the columns of --columns"
    return f"{protocol} sample" if protocol != "auto" else f"{listed()} sample"


def _expected(protocol: str) -> str:
    """What a device that prints could print instead."""
    return f"expected is {CSV_LINE}" if protocol in {"auto", "csv"} else f"expected is --protocol {protocol}"
