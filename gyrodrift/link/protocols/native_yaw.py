"""YAW frames of the native protocol, joined with the samples that they belong to.

A YAW follows its sample, so that sample has to wait for it. Devices may send a YAW for every tenth sample only. Then
the other nine do not wait: the smallest distance between two YAWs so far tells which sample has one.
"""

from math import isnan
from struct import Struct

from gyrodrift.link.protocols.decoder import DecoderCounters
from gyrodrift.values.constants import COUNTER_WRAP
from gyrodrift.values.sample import DeviceYaw, Reading

YAW = Struct("<BBHIfff")
YAW_TYPE = 0x04

FILTERS = {1: "hdr", 2: "restlevel", 3: "attitude"}
"""Names of the filters in HELLO version 3; 0 stands for none."""

MOST_DEG = 2.0**23
"""Largest absolute yaw and sigma, deg: from there on a float of four bytes has no half degrees."""

MOST_BIAS_DPS = 2.0**15 * 10.0
"""Largest absolute bias, deg/s: the largest rate in 16 bits at the largest scale."""


def filter_name(number: int) -> str | None:
    """Name of a filter in HELLO; a newer device may run one without a name here."""
    return FILTERS.get(number, f"filter {number}") if number else None


class YawJoin:
    """Holds a sample back while its YAW is due, and joins the two.

    No sample waits until HELLO says that the device runs a filter.

    is_idle
        No sample waits, and none will: samples need not pass through `take`.
    """

    def __init__(self) -> None:
        self.is_idle = True
        self._is_announced = False
        self._held: Reading | None = None
        self._yaw_seq: int | None = None
        self._stride = 0

    def announce(self, filter_name: str | None) -> None:
        """Start again after HELLO of a device, which names its filter or None."""
        self._is_announced = filter_name is not None
        self._yaw_seq, self._stride = None, 0
        self.is_idle = not self._is_announced and self._held is None

    def take(self, reading: Reading, readings: list[Reading]) -> None:
        """Pass a sample on, after the one that waited; it waits itself if its YAW is due."""
        self._release(readings)
        if self._is_due(reading):
            self._held = reading
        else:
            readings.append(reading)

    def join(self, payload: bytes, readings: list[Reading], counters: DecoderCounters) -> None:
        """Pass on the sample that waits, with the YAW of `payload`; without such a sample the YAW is only counted."""
        _, _, seq, t_us, *values = YAW.unpack(payload)
        if not _is_possible(*values):
            counters.damaged += 1
            return
        counters.frames += 1
        sample = self._held
        if not self._is_announced or sample is None or (sample.seq, sample.t_us) != (seq, t_us):
            counters.lone_yaws += 1
            self._learn(seq)
            return
        self._held = sample._replace(device_yaw=DeviceYaw(*values))
        self._release(readings)
        self._learn(seq)

    def _release(self, readings: list[Reading]) -> None:
        if self._held is not None:
            readings.append(self._held)
            self._held = None
            self.is_idle = not self._is_announced

    def _is_due(self, reading: Reading) -> bool:
        """Whether a YAW may follow this sample."""
        if not self._is_announced or self._yaw_seq is None or reading.seq is None:
            return self._is_announced
        return (reading.seq - self._yaw_seq) % COUNTER_WRAP >= self._stride

    def _learn(self, seq: int) -> None:
        """Note the distance from the YAW before; 0 is a repeated frame."""
        distance = 0 if self._yaw_seq is None else (seq - self._yaw_seq) % COUNTER_WRAP
        if distance:
            self._stride = min(self._stride or distance, distance)
        self._yaw_seq = seq


def _is_possible(yaw_deg: float, yaw_sigma_deg: float, bias_dps: float) -> bool:
    """Whether a filter can give these values; only the sigma may be NaN."""
    has_sigma = isnan(yaw_sigma_deg) or 0.0 <= yaw_sigma_deg <= MOST_DEG
    return has_sigma and abs(yaw_deg) <= MOST_DEG and abs(bias_dps) <= MOST_BIAS_DPS
