"""The state of the whole service as one value, for outputs, `ctl status` and `top`."""

import os
import time
from dataclasses import dataclass, field

from gyrodrift import __version__
from gyrodrift.outputs.status import ServiceStatus
from gyrodrift.service.filtering import Filtering
from gyrodrift.service.link_meter import LinkMeter
from gyrodrift.service.output_feed import OutputFeed, memory_bytes


@dataclass(slots=True)
class Reporting:
    """Those who know."""

    meter: LinkMeter
    filtering: Filtering
    feed: OutputFeed
    _started_s: float = field(default_factory=time.time)
    _since_s: float = field(default_factory=time.monotonic)

    def status(self) -> ServiceStatus:
        """As it is now; of the outputs, as of the last second."""
        return ServiceStatus(
            version=__version__,
            pid=os.getpid(),
            started_s=self._started_s,
            uptime_s=round(time.monotonic() - self._since_s, 3),
            memory_bytes=memory_bytes(os.getpid()) + memory_bytes(self.feed.pid),
            dropped=self.feed.dropped,
            link=self.meter.link_status(),
            device=self.meter.device_status(),
            filter=self.filtering.filter_status(),
            config=self.filtering.config_status(),
            outputs=self.feed.statuses(),
        )
