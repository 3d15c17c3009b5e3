"""The state of the service as one value, for outputs, `ctl status` and `top`."""

import os
import time
from dataclasses import asdict, dataclass, field
from math import isfinite
from typing import TYPE_CHECKING

from gyrodrift import __version__
from gyrodrift.outputs.net.names import well_formed
from gyrodrift.outputs.status import ConfigStatus, DeviceStatus, FilterStatus, LinkStatus, ServiceStatus
from gyrodrift.service.filtering import Filtering
from gyrodrift.service.link_meter import LinkMeter
from gyrodrift.service.output_feed import OutputFeed, memory_bytes
from gyrodrift.service.reference import DeviceReference
from gyrodrift.values.secret import without_secrets

if TYPE_CHECKING:  # optional parts of the service
    from gyrodrift.service.memory_keeper import MemoryKeeper
    from gyrodrift.service.recording_switch import RecordingSwitch


@dataclass(slots=True)
class Reporting:
    """Sources of the state of the service."""

    meter: LinkMeter
    filtering: Filtering
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
            filter=_filter_status(self.filtering),
            config=_config_status(self.filtering),
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


def _filter_status(filtering: Filtering) -> FilterStatus:
    state = filtering.state
    return FilterStatus(
        name=filtering.filter.name,
        yaw_deg=filtering.yaw_deg,
        yaw_sigma_deg=_finite(state.yaw_sigma_deg),
        scale_sigma_deg=_finite(filtering.scale_sigma_deg),
        bias_dps=state.bias_dps,
        bias_sigma_dps=_finite(state.bias_sigma_dps),
        rest_probability=_finite(state.rest_probability),
        confidence=_finite(state.confidence),
        heading_deg=_finite(filtering.correcting.reference.heading_deg(state.yaw_deg)),
        temp_c=_finite(filtering.last.temp_c) if filtering.last else None,
        rejected=state.rejected,
        still=_finite(filtering.last.still) if filtering.last else None,
        temp_curve=getattr(state, "temp_curve", None),
        is_witness_believed=None if filtering.witness is None else filtering.witness.is_believed,
        **_tilt_status(filtering),
        **_device_yaw_status(filtering.correcting.device),
    )


def _tilt_status(filtering: Filtering) -> dict[str, float | None]:
    """Tilt, roll and pitch of a device with three axes."""
    if filtering.run.three_axes is None:
        return {}
    attitude = filtering.correcting.attitude()
    names = ("tilt_deg", "roll_deg", "pitch_deg", "tilt_sigma_deg")
    return {name: _finite(getattr(attitude, name)) for name in names}


def _device_yaw_status(device: DeviceReference) -> dict[str, float | None]:
    """Result of the device's own filter; empty for a device without one."""
    if device.last is None:
        return {}
    return {
        "device_yaw_deg": device.last.yaw_deg,
        "device_yaw_sigma_deg": _finite(device.last.yaw_sigma_deg),
        "device_bias_dps": device.last.bias_dps,
        "device_difference_deg": _finite(device.difference_deg),
    }


def _config_status(filtering: Filtering) -> ConfigStatus:
    file = None if filtering.watch is None else well_formed(str(filtering.watch.path))
    counts = (filtering.applied, filtering.refused, filtering.applied_s)
    mount = None if filtering.run.three_axes is None else asdict(filtering.run.mount)
    return ConfigStatus(file, filtering.filter.name, asdict(filtering.params), *counts, mount=mount)


def _finite(value: float) -> float | None:
    """A finite value, or None."""
    return value if isfinite(value) else None
