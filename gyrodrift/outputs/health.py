"""How the service is, in plain words: the same on the page, in the terminal and wherever a person looks."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

from gyrodrift.outputs.status import DeviceStatus, LinkStatus, ServiceStatus

SILENT_S = 5.0
BUSY = 0.85
JITTER_MS = 20.0
DAMAGED_SHARE = 0.001
CLOCK_PPM = 500.0
RATE_TOLERANCE = 0.05


class HealthLevel(StrEnum):
    """How much it matters."""

    GOOD = "good"
    NOTE = "note"
    BAD = "bad"


@dataclass(frozen=True, slots=True)
class Health:
    """One sentence about the service."""

    level: HealthLevel
    says: str


def health(status: ServiceStatus) -> list[Health]:
    """What is to be said of it, the worst first; one sentence that all is well where nothing is."""
    found = [*_of_link(status), *_of_outputs(status)]
    order = list(HealthLevel)
    return sorted(found, key=lambda each: -order.index(each.level)) or [
        Health(HealthLevel.GOOD, "Every sample arrives whole.")
    ]


def _of_link(status: ServiceStatus) -> Iterator[Health]:
    link = status.link
    said = (
        _of_port(link),
        line_busy(link),
        damaged(link),
        lost(link),
        restarted(link),
        replugged(link),
        clipped(link),
        _rejected(status),
        uneven(link),
        clock_off(link),
        rate_differs(link, status.device),
    )
    return filter(None, said)


def _of_port(link: LinkStatus) -> Health | None:
    if not link.is_open:
        return Health(HealthLevel.BAD, f"The port {link.port} is gone; it is waited for.")
    if not link.samples:
        return Health(HealthLevel.NOTE, f"Nothing that can be decoded has come from {link.port} yet.")
    return silent(link)


def silent(link: LinkStatus, longest_s: float = SILENT_S) -> Health | None:
    """A device that has stopped."""
    if link.silent_s > longest_s:
        return Health(HealthLevel.BAD, f"The device has said nothing for {link.silent_s:.0f} s.")
    return None


def line_busy(link: LinkStatus) -> Health | None:
    """Whether the line rate leaves room."""
    if link.busy > BUSY:
        return Health(
            HealthLevel.BAD, f"The line is used to {link.busy:.0%} of its capacity; samples start to be lost."
        )
    return None


def damaged(link: LinkStatus) -> Health | None:
    """Frames that failed their checksum or form."""
    if link.samples and link.damaged > DAMAGED_SHARE * link.samples:
        share = link.damaged / (link.samples + link.damaged)
        return Health(
            HealthLevel.BAD, f"{link.damaged} frames arrived damaged ({share:.1%}); look at cable, ground and baud."
        )
    if link.damaged:
        return Health(HealthLevel.NOTE, f"{_counted(link.damaged, 'frame')} arrived damaged.")
    return None


def lost(link: LinkStatus) -> Health | None:
    """Samples that never came."""
    if not link.missing:
        return None
    return Health(HealthLevel.NOTE, f"Lost: {_counted(link.missing, 'sample')} in {_counted(link.gaps, 'gap')}.")


def restarted(link: LinkStatus) -> Health | None:
    """A device that booted, or whose clock jumped."""
    if not link.device_resets:
        return None
    return Health(HealthLevel.NOTE, f"The device began anew {_times(link.device_resets)}.")


def replugged(link: LinkStatus) -> Health | None:
    """A port that was gone for a while."""
    if not link.reconnects:
        return None
    away = f"after {link.gone_s:.1f} s away in all"
    return Health(HealthLevel.NOTE, f"The port came back {_times(link.reconnects)}, {away}.")


def clipped(link: LinkStatus) -> Health | None:
    """Samples that the device marks as out of its range."""
    if not link.clipped:
        return None
    return Health(HealthLevel.NOTE, f"{_counted(link.clipped, 'sample')} left the range of the sensor.")


def _rejected(status: ServiceStatus) -> Health | None:
    if not status.filter.rejected:
        return None
    return Health(HealthLevel.NOTE, f"{_counted(status.filter.rejected, 'sample')} made no sense and were left out.")


def uneven(link: LinkStatus) -> Health | None:
    """How evenly samples arrive."""
    if link.jitter_ms > JITTER_MS:
        return Health(HealthLevel.NOTE, f"Samples arrive unevenly: by up to {link.jitter_ms:.0f} ms.")
    return None


def clock_off(link: LinkStatus) -> Health | None:
    """The device's clock against the host's."""
    if link.clock_ppm is not None and abs(link.clock_ppm) > CLOCK_PPM:
        return Health(HealthLevel.NOTE, f"The device's clock runs {link.clock_ppm:+.0f} ppm off this computer's.")
    return None


def rate_differs(link: LinkStatus, device: DeviceStatus) -> Health | None:
    """The sample rate that arrives against the one that the device states."""
    told_hz = device.sample_rate_hz
    if told_hz and link.rate_hz and abs(link.rate_hz / told_hz - 1.0) > RATE_TOLERANCE:
        return Health(HealthLevel.NOTE, f"{link.rate_hz:.1f} samples a second arrive; the device says {told_hz:g}.")
    return None


def _of_outputs(status: ServiceStatus) -> Iterator[Health]:
    for output in status.outputs:
        if output.problem:
            yield Health(HealthLevel.BAD, f"The output {output.output} is not open: {output.problem}.")
        elif output.warning:
            yield Health(HealthLevel.BAD, f"The output {output.output}: {output.warning}.")
        elif output.dropped:
            yield Health(HealthLevel.NOTE, f"Clients of {output.output} were too slow for {output.dropped} messages.")
    if status.dropped:
        yield Health(HealthLevel.BAD, f"The outputs were too slow for {_counted(status.dropped, 'sample')}.")
    if status.config.refused > 0 and status.config.file:
        yield Health(
            HealthLevel.NOTE, f"{status.config.file} had mistakes {_times(status.config.refused)}; see the log."
        )


def _counted(count: int, what: str) -> str:
    return f"{count} {what}" if count == 1 else f"{count} {what}s"


def _times(count: int) -> str:
    return "once" if count == 1 else f"{count} times"
