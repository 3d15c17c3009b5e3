"""Evidence from a recording: its samples, and the counters of its link."""

from collections.abc import Mapping
from pathlib import Path

from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.listen import clock_ppm, jitter_ms
from gyrodrift.io.json_numbers import finite
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated

CLOCK_CHECKS = frozenset({"clock_unit", "clock_stamps"})
"""Checks whose errors make all times useless."""

COUNTED = ("bytes", "damaged", "before_hello", "clipped", "device_resets", "reconnects")
"""Counters of the link in a recording; others follow from its samples."""


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
