"""Health of the service in sentences, the same on the page and in the terminal."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from gyrodrift.outputs.status import DeviceStatus, LinkStatus, ServiceStatus
from gyrodrift.values.words import counted

SILENT_S = 5.0
BUSY = 0.85
JITTER_MS = 20.0
DAMAGED_SHARE = 0.001
CLOCK_PPM = 500.0
RATE_TOLERANCE = 0.05


class HealthLevel(StrEnum):
    """Severity of a finding."""

    GOOD = "good"
    NOTE = "note"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class Health:
    """One sentence about the service."""

    level: HealthLevel
    says: str


def health(status: ServiceStatus) -> list[Health]:
    """Findings about the service, worst first, or one finding that the link is ok."""
    findings = [*_of_link(status), *_of_aids(status), *_of_outputs(status)]
    order = list(HealthLevel)
    return sorted(findings, key=lambda finding: -order.index(finding.level)) or [
        Health(HealthLevel.GOOD, "Link OK: no samples lost or damaged.")
    ]


def _of_link(status: ServiceStatus) -> Iterator[Health]:
    link = status.link
    findings = (
        _of_port(link),
        line_busy(link),
        damaged(link),
        lost(link),
        restarted(link),
        replugged(link),
        clipped(link),
        impossible(link),
        _rejected(status),
        uneven(link),
        clock_off(link),
        rate_differs(link, status.device),
    )
    return filter(None, findings)


def _of_aids(status: ServiceStatus) -> Iterator[Health]:
    for name, aid in (status.filter.aids or {}).items():
        if aid["differs"]:
            says = f"The second source {name} contradicts the gyro and is left out: {aid['differs']}."
            yield Health(HealthLevel.NOTE, says)


def _of_port(link: LinkStatus) -> Health | None:
    if not link.is_open:
        return Health(HealthLevel.BAD, f"The port {link.port} is gone; the service waits for it.")
    if not link.samples:
        return Health(HealthLevel.NOTE, f"Nothing was decoded from {link.port} yet.")
    return silent(link)


def silent(link: LinkStatus, longest_s: float = SILENT_S) -> Health | None:
    """Finding about a device that sends nothing."""
    if link.silent_s > longest_s:
        return Health(HealthLevel.BAD, f"No sample for {link.silent_s:.0f} s.")
    return None


def line_busy(link: LinkStatus) -> Health | None:
    """Finding about a line near its capacity."""
    if link.busy > BUSY:
        return Health(HealthLevel.BAD, f"The line uses {link.busy:.0%} of its capacity; samples may be lost.")
    return None


def damaged(link: LinkStatus) -> Health | None:
    """Finding about frames with a wrong checksum or form."""
    if link.samples and link.damaged > DAMAGED_SHARE * link.samples:
        share = link.damaged / (link.samples + link.damaged)
        return Health(
            HealthLevel.BAD, f"{link.damaged} frames are damaged ({share:.1%}); check cable, ground and baud."
        )
    if link.damaged:
        return Health(HealthLevel.NOTE, f"Damaged: {counted(link.damaged, 'frame')}.")
    return None


def lost(link: LinkStatus) -> Health | None:
    """Finding about lost samples."""
    if not link.missing:
        return None
    return Health(HealthLevel.NOTE, f"Lost: {counted(link.missing, 'sample')} in {counted(link.gaps, 'gap')}.")


def restarted(link: LinkStatus) -> Health | None:
    """Finding about a restart of the device, or a jump of its clock."""
    if not link.device_resets:
        return None
    return Health(HealthLevel.NOTE, f"The device restarted {_times(link.device_resets)}.")


def replugged(link: LinkStatus) -> Health | None:
    """Finding about a port that was gone."""
    if not link.reconnects:
        return None
    away = f"after {link.gone_s:.1f} s in total"
    return Health(HealthLevel.NOTE, f"The port was reconnected {_times(link.reconnects)}, {away}.")


def clipped(link: LinkStatus) -> Health | None:
    """Finding about samples out of the range of the sensor."""
    if not link.clipped:
        return None
    return Health(HealthLevel.NOTE, f"Out of range: {counted(link.clipped, 'sample')}.")


def impossible(link: LinkStatus) -> Health | None:
    """Finding about single readings that cannot be."""
    if not link.impossible:
        return None
    return Health(HealthLevel.NOTE, f"Impossible rates left out: {counted(link.impossible, 'sample')}.")


def _rejected(status: ServiceStatus) -> Health | None:
    if not status.filter.rejected:
        return None
    return Health(HealthLevel.NOTE, f"Invalid time or rate: {counted(status.filter.rejected, 'sample')}.")


def uneven(link: LinkStatus) -> Health | None:
    """Finding about uneven arrival."""
    if link.jitter_ms > JITTER_MS:
        return Health(HealthLevel.NOTE, f"Samples arrive unevenly, by up to {link.jitter_ms:.0f} ms.")
    return None


def clock_off(link: LinkStatus) -> Health | None:
    """Finding about the rate of the device clock."""
    if link.clock_ppm is not None and abs(link.clock_ppm) > CLOCK_PPM:
        return Health(HealthLevel.NOTE, f"The device clock runs {link.clock_ppm:+.0f} ppm against this computer.")
    return None


def rate_differs(link: LinkStatus, device: DeviceStatus) -> Health | None:
    """Finding about a sample rate that differs from the one stated by the device."""
    stated_hz = device.sample_rate_hz
    if stated_hz and link.rate_hz and abs(link.rate_hz / stated_hz - 1.0) > RATE_TOLERANCE:
        return Health(HealthLevel.NOTE, f"The rate is {link.rate_hz:.1f} Hz; the device states {stated_hz:g} Hz.")
    return None


def _of_outputs(status: ServiceStatus) -> Iterator[Health]:
    for output in status.outputs:
        if output.problem:
            yield Health(HealthLevel.BAD, f"The output {output.output} is not open: {output.problem}.")
        elif output.warning:
            yield Health(HealthLevel.BAD, f"The output {output.output}: {output.warning}.")
        elif output.dropped:
            yield Health(HealthLevel.NOTE, f"Slow clients of {output.output}: {output.dropped} messages dropped.")
    if status.dropped:
        yield Health(HealthLevel.BAD, f"The outputs are too slow: {counted(status.dropped, 'sample')} dropped.")
    if status.config.refused > 0 and status.config.file:
        yield Health(
            HealthLevel.NOTE, f"{status.config.file} had mistakes {_times(status.config.refused)}; see the log."
        )


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
