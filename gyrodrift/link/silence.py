"""Reasons why a device could not be read, and advice, from the bytes that it sent."""

import shlex

from gyrodrift.link.binary_frames import BinaryFrames, binary_frames
from gyrodrift.link.heard import Heard, quoted
from gyrodrift.link.protocols import text
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS, detected_names
from gyrodrift.link.sources.source import ByteSource
from gyrodrift.link.unread import CONVERT, spoken

CSV_LINE = "t_us,rate_dps[,encoder_deg[,temp_c[,still]]]"
NAMES_MAX = 12
DATA_SHARE = 0.4
"""Share of digits above which a line is data, and below which it is a message."""

ANGLE_NOTE = (
    ". It is an angle, which a filter in the device has processed. If it falls during a turn to the left, append :-"
)


def why_silent(
    timeout_s: float,
    baud: int | None,
    heard_bytes: int,
    decoder: Decoder | None,
    protocol: str,
    heard: Heard,
    port: str,
    source: ByteSource | None = None,
    found_baud: int = 0,
) -> str:
    """Message about a device that sent nothing decodable within `timeout_s`.

    `baud` is the given baud rate, or None if the link searched for it. `decoder` is the chosen decoder for the option
    `protocol`. `heard` holds the last of the `heard_bytes` from `port`, which belongs to `source`, or is serial, at
    `found_baud`.
    """
    waited = f"within {timeout_s:g} s"
    if not heard_bytes:
        advice = "check its power, the port, and whether TX and RX are swapped" if source is None else source.silence
        return f"the device sent nothing {waited}; {advice}"
    undecoded = "" if decoder is None else _why_undecoded(decoder, heard, waited, source)
    if undecoded:
        return undecoded
    unread = unread_protocol(heard, protocol, _line(port, found_baud, source))
    if unread or heard.is_text:
        return unread or _why_text(protocol, heard, port, waited, source)
    frames = binary_frames(heard.content)
    if frames is not None and frames.is_checked:
        return _why_frames(frames, heard, found_baud, source)
    noise = _why_noise(heard_bytes, baud, decoder, protocol, waited, source)
    if frames is None:
        return noise
    return f"{noise}; if the rate is right, the bytes are a binary protocol: {frames.described(heard.bytes_per_s)}"


def _why_undecoded(decoder: Decoder, heard: Heard, waited: str, source: ByteSource | None) -> str:
    """Message about good frames without a sample; empty without any."""
    counters = decoder.counters
    if counters.before_hello:
        return (
            f"{counters.before_hello} samples arrived {waited}, but no HELLO frame with their scale; "
            "the device must send one every second"
        )
    if decoder.unread or not counters.other_frames or (decoder.name == text.NAME and heard.is_text):
        return decoder.unread
    own = source.protocol if source is not None else None
    advice = (own or PROTOCOLS[decoder.name]).without_rate
    frames = f"{counters.other_frames} good {decoder.name} frames arrived {waited}, but none with a yaw rate"
    return f"{frames}; {advice}" if advice else frames


def _line(port: str, baud: int, source: ByteSource | None) -> str:
    """Address of a port as a part of another address: `/dev/ttyUSB0,57600`, `tcp:HOST:PORT`."""
    if source is None:
        return f"{port},{baud}"
    return port.replace("tcp://", "tcp:").replace("udp://", "udpin:")


def _why_frames(frames: BinaryFrames, heard: Heard, baud: int, source: ByteSource | None) -> str:
    """Message about the frames of an unknown binary protocol."""
    described = frames.described(heard.bytes_per_s)
    device = f", as {frames.resembles} sends them" if frames.resembles else ""
    at_baud = f" at {baud} baud" if source is None or source.has_baud else ""
    sends = f"the device sends {described}{device}{at_baud}: a binary protocol, which gyrodrift does not read"
    return f"{sends}; can it send text, or one of {detected_names()}? {CONVERT[0].upper()}{CONVERT[1:]}"


def _why_noise(
    heard_bytes: int, baud: int | None, decoder: Decoder | None, protocol: str, waited: str, source: ByteSource | None
) -> str:
    """Message about bytes that are neither text nor a known protocol."""
    expected = decoder.name if decoder is not None else detected_names() if protocol == "auto" else protocol
    frames = f"{heard_bytes} bytes arrived {waited}, but no {expected} frame"
    if source is not None and not source.has_baud:
        return f"{frames}; check what the device sends, and the baud rate of a serial line behind it"
    return f"{frames} at {_tried(baud)}"


def _tried(baud: int | None) -> str:
    """Baud rates that were tried, and advice."""
    if baud is None:
        return (
            "any of the usual baud rates; the device has an unusual baud rate, or another protocol: set the rate with "
            "--baud"
        )
    return f"{baud} baud; the baud rate may be wrong: without --baud all usual rates are tried"


def unread_protocol(heard: Heard, protocol: str, line: str = "") -> str:
    """Message about a stream of another protocol than `protocol`, on a line; empty if it is unknown."""
    unread = spoken(heard.content)
    if unread is not None:
        return unread.message(line)
    candidates = [entry for entry in PROTOCOLS.values() if entry.is_detected and protocol not in {AUTO, entry.name}]
    detected = Detector(candidates).push(heard.content)
    if detected is None:
        return ""
    instead = "--columns" if protocol == text.NAME else f"--protocol {protocol}"
    return f"the device sends {detected[0].name}, not {protocol}; leave out {instead}"


def _why_text(protocol: str, heard: Heard, port: str, waited: str, source: ByteSource | None) -> str:
    """Message about a device that prints text: its columns, and how to read them, or the missing information."""
    from gyrodrift.columns.guess import guess  # noqa: PLC0415 - for unknown streams only

    baud = "" if source is not None and not source.has_baud else ", so the baud rate is right"
    prints = f"the device prints text{baud}, but no line is a {_expected_sample(protocol)}"
    guessed = guess(heard.lines(), heard.lines_per_s)
    if guessed is None:
        return f"{prints}: {quoted(heard.last_words())} {_without_columns(heard, waited)}"
    names = [column.looks_like for column in guessed.columns]
    shown = ", ".join(names[:NAMES_MAX]) + (", …" if len(names) > NAMES_MAX else "")
    looks = f"{prints}: {quoted(guessed.example)} looks like {shown} ({guessed.form})"
    turn_it = f"gyrodrift doctor --port {shlex.quote(port)} --turn"
    if guessed.turn is None or guessed.template is None:
        reason = guessed.question or "none of them is known to be the yaw rate"
        return (
            f"{looks}, but {reason}; {_expected(protocol)}, or name the columns with"
            f" --columns, or find them by a quarter turn: {turn_it}"
        )
    is_angle = guessed.turn.entry.startswith("yaw")
    columns = f"'{guessed.template}'"  # no label holds a quotation mark
    if guessed.missing:
        unknown = "its unit" if "UNIT by" in guessed.missing[-1] else "the sender"
        return (
            f"{looks} ({guessed.reasons}), but {unknown} is unknown: replace {', and '.join(guessed.missing)}"
            f" in --columns {columns}, or find it by a quarter turn: {turn_it}"
        )
    note = ANGLE_NOTE if is_angle else ""
    return f"{looks}; {_expected(protocol)}, or read these lines with --columns {columns} ({guessed.reasons}){note}"


def _without_columns(heard: Heard, waited: str) -> str:
    """Advice about data of an unknown form, a board that is still starting, or a board that waits."""
    from gyrodrift.columns.fields import is_hex  # noqa: PLC0415 - for unknown streams only

    lines = heard.lines()
    text = "".join(lines)
    if 2 * sum(is_hex(line.strip()) for line in lines) > len(lines):
        return "has hexadecimal numbers, which are not read; print decimal numbers"
    if sum(character.isdigit() for character in text) >= DATA_SHARE * max(1, len(text)):
        return "looks like data of an unknown form; can the device send another format?"
    return (
        f"looks like a message; is its program running? If it is still starting up {waited}, wait longer with --timeout"
        " 30; if it waits for a key, send one with --send '\\r\\n'"
    )


def _expected_sample(protocol: str) -> str:
    if protocol == text.NAME:
        return "sample for these --columns"
    return f"{protocol} sample" if protocol != "auto" else f"{detected_names()} sample"


def _expected(protocol: str) -> str:
    """Lines that the device could print instead."""
    return f"print {CSV_LINE}" if protocol in {"auto", "csv"} else f"send {protocol}"
