"""How the link is now, second by second: what a person who watches wants beside the counters."""

import time
from typing import Any

from gyrodrift.link.link import Link
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.sample import Sample

SECOND_S = 1.0
BITS_PER_BYTE = 10
"""A byte on a serial line has a start and a stop bit."""


class LinkMeter:
    """Hears the samples of a link; rate and jitter are of the last whole second."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._marked_s = time.monotonic()
        self._samples = self._bytes = 0
        self._least_s = float("inf")
        self._most_s = float("-inf")
        self._rate_hz = self._jitter_s = self._busy = 0.0

    def take(self, samples: list[Sample]) -> None:
        """Note how late the newest of them is."""
        if not samples:
            return
        newest = samples[-1]
        late_s = newest.t_host_s - newest.t_device_s
        self._least_s = min(self._least_s, late_s)
        self._most_s = max(self._most_s, late_s)

    def tick(self, now_s: float) -> None:
        """Once a second, the figures of the second that has passed."""
        elapsed_s = now_s - self._marked_s
        if elapsed_s < SECOND_S:
            return
        counters, port = self._link.counters, self._link.port
        self._rate_hz = (counters.samples - self._samples) / elapsed_s
        self._jitter_s = max(0.0, self._most_s - self._least_s)
        bits_per_s = (counters.bytes - self._bytes) * BITS_PER_BYTE / elapsed_s
        self._busy = bits_per_s / self._link.baud if port is not None and not port.is_pty else 0.0
        self._marked_s, self._samples, self._bytes = now_s, counters.samples, counters.bytes
        self._least_s, self._most_s = float("inf"), float("-inf")

    def stats(self) -> dict[str, Any]:
        """Nothing of its own: the loop logs the counters."""
        return {}

    def close(self) -> None:
        """Nothing is open."""

    def link_status(self) -> LinkStatus:
        """The link as it is."""
        link, counters, decoder = self._link, self._link.counters, self._link.decoder
        ppm = link.clock.drift_ppm if link.clock else None
        return LinkStatus(
            port=link.name,
            baud=link.baud,
            protocol=decoder.name if decoder else "unknown",
            is_open=link.port is not None,
            silent_s=round(link.silent_s(), 3),
            rate_hz=round(self._rate_hz, 2),
            jitter_ms=round(1e3 * self._jitter_s, 3),
            samples=counters.samples,
            bytes=counters.bytes,
            damaged=decoder.counters.damaged if decoder else 0,
            before_hello=decoder.counters.before_hello if decoder else 0,
            clipped=decoder.counters.clipped if decoder else 0,
            gaps=counters.gaps,
            missing=counters.missing,
            device_resets=counters.restarts,
            reconnects=counters.reconnects,
            gone_s=round(counters.gone_s, 3),
            clock_ppm=None if ppm is None else round(ppm, 1),
            busy=round(self._busy, 3),
        )

    def device_status(self) -> DeviceStatus:
        """What the device has said of itself."""
        device = self._link.device
        return DeviceStatus(device.device_id, device.sample_rate_hz, device.dps_per_lsb, device.encoder_cpr)
