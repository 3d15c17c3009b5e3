"""Text protocol: lines of foreign text, read by the columns that the user names.

Its decoder is loaded on demand, because most devices use another protocol.
"""

from dataclasses import replace
from typing import TYPE_CHECKING

from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.protocol import WireProtocol

if TYPE_CHECKING:
    from gyrodrift.link.text_decoder import TextDecoder

NAME = "text"
SHIPPED_COLUMNS = "t_ms=t_ms, gz=rate:lsb/131"
"""Columns of the simulated device."""


def text_protocol(columns: str) -> WireProtocol:
    """Text protocol with these columns.

    Raises
    ------
    UsageError
        The columns have a mistake.
    """
    from gyrodrift.columns.spec import QUATERNION, columns_of  # noqa: PLC0415 - loaded on demand

    parsed = columns_of(columns)

    def decoder() -> "TextDecoder":
        from gyrodrift.link.text_decoder import TextDecoder  # noqa: PLC0415 - loaded on demand

        return TextDecoder(parsed)

    has_clock = any(column.clock for column in parsed)
    sends_angle = any(column.meaning in ("yaw", *QUATERNION) for column in parsed)
    is_unit_said = any(column.unit for column in parsed if column.meaning in ("rate", "delta"))
    rate_scale = next((abs(column.scale) for column in parsed if column.meaning == "rate"), 1.0) or 1.0
    return replace(
        PROTOCOL,
        decoder=decoder,
        has_clock=has_clock,
        is_unit_said=is_unit_said,
        is_asked=True,
        rate_scale=rate_scale,
        sends_angle=sends_angle,
    )


def read_by(decoder: Decoder, columns: str) -> None:
    """Change the columns of a text decoder."""
    from gyrodrift.columns.spec import columns_of  # noqa: PLC0415 - loaded on demand
    from gyrodrift.link.text_decoder import TextDecoder  # noqa: PLC0415 - loaded on demand

    if isinstance(decoder, TextDecoder):
        decoder.read_by(columns_of(columns))


def _shipped() -> "TextDecoder":
    from gyrodrift.columns.spec import columns_of  # noqa: PLC0415 - loaded on demand
    from gyrodrift.link.text_decoder import TextDecoder  # noqa: PLC0415 - loaded on demand

    return TextDecoder(columns_of(SHIPPED_COLUMNS))


HELP = "lines with columns of your own, see --columns"
PROTOCOL = WireProtocol(NAME, HELP, _shipped, has_clock=True, rank=90, is_detected=False)
