"""Encoder `milli`: the simulated device sends frames `W<rate in thousandths of a deg/s>!`."""

from collections.abc import Iterable, Iterator

from firmware_sim.measure import Block
from firmware_sim.rig import Base
from firmware_sim.wire.encoder import Frame, Measurement, WireEncoder

GYRODRIFT_API = 1
END = b"!"


def _frame(t_s: float, rate_dps: float) -> Frame:
    return Frame(t_s, b"W%d" % round(rate_dps * 1000.0) + END, 1, END)


def frames(blocks: Iterable[Block], base: Base) -> Iterator[Frame]:
    """Frames of the samples of a rig."""
    for block in blocks:
        for _, _, t_host_s, rate_raw, *_ in block.rows():
            yield _frame(t_host_s, rate_raw * base.dps_per_lsb)


def recorded(measurements: Iterable[Measurement], _base: Base) -> Iterator[Frame]:
    """Frames of a recording, for `gyrodrift replay`."""
    return (_frame(m.due_s, m.rate_dps) for m in measurements)


ENCODER = WireEncoder("milli", frames, recorded)
