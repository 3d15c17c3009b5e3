"""The state of the service as one value, for outputs, `ctl status` and `top`, and the meter of the link."""

import os
import time
from dataclasses import asdict, dataclass, field
from typing import TYPE_CHECKING

from gyrodrift import __version__
from gyrodrift.io.json_numbers import finite
from gyrodrift.link.link import Link
from gyrodrift.outputs.fields import Use, fields_of
from gyrodrift.outputs.net.addresses import well_formed
from gyrodrift.outputs.status import ConfigStatus, DeviceStatus, FilterStatus, LinkStatus, ServiceStatus, aid_status
from gyrodrift.service.config_follower import ConfigFollower
from gyrodrift.service.listener import IdleListener
from gyrodrift.service.output_feed import OutputFeed, memory_bytes
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.values.constants import LINE_BITS_PER_BYTE
from gyrodrift.values.sample import Sample
from gyrodrift.values.secret import without_secrets

if TYPE_CHECKING:  # optional parts of the service
    from gyrodrift.service.memory_keeper import MemoryKeeper
    from gyrodrift.service.recording_switch import RecordingSwitch


SECOND_S = 1.0

CALIBRATED = ("date", "sign", "scale_ccw", "scale_cw")
"""Values of a calibration in the status."""


class LinkMeter(IdleListener):
    """Measures the samples of a link over the last whole second.

    rate_hz
        Samples per second.
    jitter_s
        Peak-to-peak variation of the delay from device clock to arrival, s.
    busy
        Used share of the capacity of the line; 0 for a pty.
    """

    def __init__(self, link: Link) -> None:
        self.link = link
        self._marked_s = time.monotonic()
        self._samples = self._bytes = 0
        self._least_s = float("inf")
        self._most_s = float("-inf")
        self.rate_hz = self.jitter_s = self.busy = 0.0

    def take(self, samples: list[Sample]) -> None:
        """Note the delay of the newest sample."""
        if not samples:
            return
        newest = samples[-1]
        late_s = newest.t_host_s - newest.t_device_s
        self._least_s = min(self._least_s, late_s)
        self._most_s = max(self._most_s, late_s)

    def tick(self, now_s: float) -> None:
        """Update the values once a second."""
        elapsed_s = now_s - self._marked_s
        if elapsed_s < SECOND_S:
            return
        counters, port = self.link.counters, self.link.port
        self.rate_hz = (counters.samples - self._samples) / elapsed_s
        self.jitter_s = max(0.0, self._most_s - self._least_s)
        bits_per_s = (counters.bytes - self._bytes) * LINE_BITS_PER_BYTE / elapsed_s
        self.busy = bits_per_s / self.link.baud if port is not None and port.has_line_rate else 0.0
        self._marked_s, self._samples, self._bytes = now_s, counters.samples, counters.bytes
        self._least_s, self._most_s = float("inf"), float("-inf")


@dataclass(slots=True)
class Reporting:
    """Sources of the state of the service."""

    meter: LinkMeter
    follower: ConfigFollower
    feed: OutputFeed
    memory: "MemoryKeeper | None" = None
    recording: "RecordingSwitch | None" = None
    _started_s: float = field(default_factory=time.time)
    _since_s: float = field(default_factory=time.monotonic)

    def status(self) -> ServiceStatus:
        """Present state; that of the outputs is of the last second."""
        return ServiceStatus(
            version=__version__,
            pid=os.getpid(),
            started_s=self._started_s,
            uptime_s=round(time.monotonic() - self._since_s, 3),
            memory_bytes=memory_bytes(os.getpid()) + memory_bytes(self.feed.pid),
            dropped=self.feed.dropped,
            link=_link_status(self.meter),
            device=_device_status(self.meter),
            filter=_filter_status(self.follower.pipeline),
            config=_config_status(self.follower),
            outputs=self.feed.statuses(),
            memory=None if self.memory is None else self.memory.status(),
            recording=None if self.recording is None else self.recording.file,
        )


def _link_status(meter: LinkMeter) -> LinkStatus:
    link, decoder = meter.link, meter.link.decoder
    return LinkStatus(
        port=without_secrets(well_formed(link.name)),
        baud=link.baud,
        protocol=decoder.name if decoder else "unknown",
        is_open=link.port is not None,
        silent_s=round(link.silent_s(), 3),
        rate_hz=round(meter.rate_hz, 2),
        jitter_ms=round(1e3 * meter.jitter_s, 3),
        **{name: value for name, value in link.counted().items() if name != "lone_yaws"},
        busy=round(meter.busy, 3),
    )


def _device_status(meter: LinkMeter) -> DeviceStatus:
    device = meter.link.device
    values = (device.device_id, device.sample_rate_hz, device.dps_per_lsb, device.encoder_cpr, device.device_filter)
    return DeviceStatus(*values)


def _filter_status(pipeline: Pipeline) -> FilterStatus:
    state, now, witness = pipeline.state, pipeline.now(), pipeline.witness
    return FilterStatus(
        name=pipeline.filter.name,
        **{field.name: finite(field.number(now)) for field in fields_of(Use.STATUS)},
        scale_sigma_deg=finite(pipeline.run.scale_sigma_deg),
        rejected=state.rejected,
        still=finite(now.sample.still),
        is_witness_believed=None if witness is None else witness.is_believed,
        temp_curve=getattr(state, "temp_curve", None),
        aids={name: aid_status(status) for name, status in pipeline.run.aids.items()} or None,
    )


def _config_status(follower: ConfigFollower) -> ConfigStatus:
    pipeline, watch = follower.pipeline, follower.watch
    file = None if watch is None else well_formed(str(watch.path))
    counts = (follower.applied, follower.refused, follower.applied_s)
    mount = None if pipeline.run.three_axes is None else asdict(pipeline.run.mount)
    applied = pipeline.calibrating.applied
    calibration = None if applied is None else {name: getattr(applied, name) for name in CALIBRATED}
    params = asdict(pipeline.params)
    return ConfigStatus(file, pipeline.filter.name, params, *counts, mount=mount, calibration=calibration)
