"""Evidence from a device, to which `doctor` listens like `serve`, or from a recording and the counters of its link."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.port import PortEvidence, latency_ms, look_at_port
from gyrodrift.facts.host import HostClock
from gyrodrift.facts.session_facts import SessionFacts
from gyrodrift.io.json_numbers import finite
from gyrodrift.io.progress import OnProgress
from gyrodrift.io.waiting import wait_readable
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.sources.source import SourcePort
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.session.session import session_of
from gyrodrift.values.constants import LINE_BITS_PER_BYTE
from gyrodrift.values.errors import LinkError, UnitError
from gyrodrift.values.sample import Sample

LONGEST_WAIT_S = 0.1
RAW_BYTES = 4096
"""Bytes of a device that is not understood in a report. Chosen: some dozen lines or frames."""

SURE_PPM = 100.0
"""Largest standard error of a reported clock drift, ppm."""

CLOCK_CHECKS = frozenset({"clock_unit", "clock_stamps"})
"""Checks whose errors make all times useless."""

COUNTED = ("bytes", "damaged", "before_hello", "clipped", "device_resets", "reconnects")
"""Counters of the link in a recording; others follow from its samples."""


@dataclass(slots=True)
class _Heard:
    samples: list[Sample] = field(default_factory=list)
    units: dict[str, Any] = field(default_factory=dict)
    failure: LinkError | None = None
    is_angle: bool = False
    raw: bytearray = field(default_factory=bytearray)

    def take(self, chunk: bytes, _arrival_s: float) -> None:
        """Keep the first bytes of the device, for a report."""
        self.raw += chunk[: RAW_BYTES - len(self.raw)]

    def on_event(self, event: str, **fields: Any) -> None:
        self.is_angle |= event == "rate_from_angle"
        if event == "rate_unit_differs" or (event == "rate_doubted" and not self.units):
            self.units = fields


def listen(
    options: LinkOptions,
    seconds: float,
    progress: OnProgress,
    port: SourcePort | None = None,
    monotonic: Callable[[], float] = time.monotonic,
) -> DeviceEvidence:
    """Evidence from `seconds` after the first sample; `port` is an open port, or None to open it."""
    outside = look_at_port(options.port)
    heard = _Heard()
    try:
        link = Link(replace(options, keeps_on=True), heard.on_event, monotonic, port)
    except LinkError as error:
        return DeviceEvidence(options.port, port=outside, failure=error)
    try:
        link.tap = heard.take
        _hear(link, seconds, heard, progress, monotonic)
        if outside is not None:  # opening the port changes the timer
            outside = replace(outside, latency_ms=latency_ms(outside.port.device))
        return _evidence(options.port, outside, link, heard)
    finally:
        link.close()


def _evidence(source: str, outside: PortEvidence | None, link: Link, heard: _Heard) -> DeviceEvidence:
    is_timed = not isinstance(heard.failure, UnitError)
    facts = SessionFacts(session_of("now", heard.samples)) if heard.samples and is_timed else None
    about, has_clock = link.device, isinstance(link.clock, DeviceClock)
    return DeviceEvidence(
        source=source,
        port=outside,
        failure=heard.failure,
        link=_status(link, facts, has_clock=has_clock, has_line=outside is not None and outside.has_line_rate),
        device=DeviceStatus(
            about.device_id, about.sample_rate_hz, about.dps_per_lsb, about.encoder_cpr, about.device_filter
        ),
        has_clock=has_clock,
        is_angle=heard.is_angle,
        units=heard.units,
        facts=facts,
        raw=bytes(heard.raw),
    )


def _hear(link: Link, seconds: float, heard: _Heard, progress: OnProgress, monotonic: Callable[[], float]) -> None:
    opened_s = monotonic()
    begun_s: float | None = None
    while True:
        _wait(link)
        try:
            heard.samples += link.read()
        except LinkError as error:
            heard.failure = error
            return
        now_s = monotonic()
        if begun_s is None and heard.samples:
            begun_s = now_s
        if link.is_over or (begun_s is not None and now_s - begun_s >= seconds):
            return
        task = "waiting for the device" if begun_s is None else "listening, keep it still"
        progress(task, int(now_s - (begun_s or opened_s)), int(seconds) if begun_s is not None else 0)


def _wait(link: Link) -> None:
    wait_readable(link.fileno(), min(link.wake_s(), LONGEST_WAIT_S))


def _status(link: Link, facts: SessionFacts | None, *, has_clock: bool, has_line: bool) -> LinkStatus:
    """Counters of the link, with the share of its line that the samples use."""
    host = facts.host if facts else None
    counted = link.counted() | {"clock_ppm": clock_ppm(host) if has_clock else None}
    counted.pop("lone_yaws", None)
    rate_hz = facts.rate_hz or 0.0 if facts else 0.0
    bits_per_s = counted["bytes"] / max(counted["samples"], 1) * rate_hz * LINE_BITS_PER_BYTE
    return LinkStatus(
        port=link.name,
        baud=link.baud,
        protocol=link.decoder.name if link.decoder else "unknown",
        is_open=link.port is not None or link.is_over,
        silent_s=link.silent_s(),
        rate_hz=rate_hz,
        jitter_ms=jitter_ms(host),
        busy=bits_per_s / link.baud if has_line else 0.0,
        **counted,
    )


def clock_ppm(host: HostClock | None) -> float | None:
    """Drift of the device clock against the host clock, ppm; None if it is uncertain."""
    if host is None or host.drift_ppm is None or (host.drift_sd_ppm or 0.0) >= SURE_PPM:
        return None
    return host.drift_ppm


def jitter_ms(host: HostClock | None) -> float:
    """95th percentile of the arrival delay, ms; 0 without host times."""
    return 0.0 if host is None else 1e3 * host.delay_p95_s


def recorded(path: Path, reading: ReadingOptions = AS_WRITTEN) -> DeviceEvidence:
    """Evidence from a recording; the readable part if it is damaged.

    `reading` holds the columns and units that the user states.

    Raises
    ------
    DataError
        It cannot be read.
    """
    checked = examined(session_as_stated(path, reading), reading)
    facts, is_timed = checked.facts, not any(f.is_error and f.id in CLOCK_CHECKS for f in checked.findings)
    about, kept, device = (facts.session.metadata.get(name, {}) for name in ("recording", "link", "device"))
    counted = {name: int(_number(kept, name) or 0.0) for name in COUNTED}
    protocol = about.get("protocol", "")
    link = LinkStatus(
        port=about.get("port", str(path)),
        baud=int(_number(about, "baud") or 0.0),
        protocol=protocol,
        is_open=True,
        rate_hz=facts.rate_hz or 0.0 if is_timed else 0.0,
        jitter_ms=jitter_ms(facts.host),
        samples=facts.samples,
        gaps=facts.gaps.count,
        missing=facts.gaps.missing,
        clock_ppm=clock_ppm(facts.host),
        **counted,
    )
    return DeviceEvidence(
        source=str(path),
        recording=path,
        link=link,
        device=_device(device),
        has_clock=PROTOCOLS[protocol].has_clock if protocol in PROTOCOLS else True,
        checked=checked.findings,
        facts=facts if is_timed else None,
    )


def _device(kept: Mapping[str, str]) -> DeviceStatus:
    """Data about the device from the time of the recording."""
    counts = _number(kept, "encoder_cpr")
    return DeviceStatus(
        device_id=kept.get("device_id"),
        sample_rate_hz=_number(kept, "sample_rate_hz"),
        dps_per_lsb=_number(kept, "dps_per_lsb"),
        encoder_cpr=None if counts is None else int(counts),
        device_filter=kept.get("device_filter"),
    )


def _number(kept: Mapping[str, str], name: str) -> float | None:
    """Number in the metadata; None without one, or if it is not a number."""
    try:
        value = float(kept[name])
    except (KeyError, ValueError):
        return None
    return finite(value)
