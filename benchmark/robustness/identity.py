"""A number in every sample, so that it is known again behind the link: in the place of the encoder's count.

A protocol without an encoder says it by the temperature. Neither is looked at by clock or filter.
"""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

import numpy as np

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from gyrodrift.values.sample import Sample

NO_ENCODER = frozenset({"witmotion"})
LOWEST = -32768
"""The temperature, hundredths of °C, of sample 0: a 16-bit number, and so runs have fewer samples than that."""


def numbered(blocks: Iterator[Block]) -> Iterator[Block]:
    """Measurements with their place in the stream in both fields."""
    number = 0
    for block in blocks:
        numbers = np.arange(number, number + len(block.seq))
        number += len(numbers)
        yield replace(block, encoder_counts=numbers, temp_centi_c=(numbers + LOWEST).astype(np.int16))


def number_of(sample: Sample, protocol: str, base: Base) -> int | None:
    """Which one it is; None where it says no whole number."""
    said = sample.temp_c * 100.0 - LOWEST if protocol in NO_ENCODER else sample.encoder_deg / 360.0 * base.encoder_cpr
    if not isfinite(said) or abs(said - round(said)) > 0.01:
        return None
    return round(said)
