"""Why nothing could be read of a device, and what to try, from what came of it."""

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.registry import listed


def why_silent(timeout_s: float, baud: int | None, heard_bytes: int, decoder: Decoder | None) -> str:
    """What to tell a person whose device said nothing that can be decoded within `timeout_s`.

    `baud` is the line rate that was given, None where it was to be found; `decoder` is the one that was chosen.
    """
    waited = f"within {timeout_s:g} s"
    if not heard_bytes:
        return f"the device said nothing {waited}; is it powered, is this its port, are TX and RX the right way round?"
    tried = "any of the usual baud rates" if baud is None else f"{baud} baud"
    if decoder is None:
        return (
            f"{heard_bytes} bytes came {waited}, but no {listed()} frame in them at {tried}; "
            "a wrong baud rate looks like this: give the device's with --baud"
        )
    if decoder.counters.before_hello:
        return (
            f"{decoder.counters.before_hello} samples came {waited}, but no HELLO frame that says their scale; "
            "the device has to send one once a second"
        )
    return (
        f"{heard_bytes} bytes came {waited}, but no {decoder.name} sample in them at {tried} "
        f"({decoder.counters.damaged} damaged frames); check --baud and --protocol"
    )
