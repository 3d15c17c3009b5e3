"""A recording as evidence: its samples, and what was kept of its link beside them."""

from collections.abc import Mapping
from pathlib import Path

from gyrodrift.describe.describe import describe
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.listen import SURE_PPM
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.outputs.status import DeviceStatus, LinkStatus
from gyrodrift.session.files import load_session

COUNTED = frozenset({"bytes", "damaged", "before_hello", "clipped", "device_resets", "reconnects"})


def recorded(path: Path) -> DeviceEvidence:
    """What a recording shows of the device.

    Raises
    ------
    DataError
        Where it cannot be read.
    """
    session = load_session(path)
    description = describe(session)
    about, kept, device = (session.metadata.get(name, {}) for name in ("recording", "link", "device"))
    counted = {name: int(float(text)) for name, text in kept.items() if name in COUNTED}
    host = description.host
    is_sure = host is not None and host.drift_ppm is not None and (host.drift_sd_ppm or 0.0) < SURE_PPM
    protocol = about.get("protocol", "")
    link = LinkStatus(
        port=about.get("port", str(path)),
        baud=int(about.get("baud", "0")),
        protocol=protocol,
        is_open=True,
        rate_hz=description.rate_hz or 0.0,
        jitter_ms=1e3 * host.delay_p95_s if host else 0.0,
        samples=description.samples,
        gaps=description.gaps.count,
        missing=description.gaps.missing,
        clock_ppm=host.drift_ppm if host and is_sure else None,
        **counted,
    )
    return DeviceEvidence(
        source=str(path),
        recording=path,
        link=link,
        device=_device(device),
        has_clock=PROTOCOLS[protocol].has_clock if protocol in PROTOCOLS else True,
        session=session,
        description=description,
    )


def _device(kept: Mapping[str, str]) -> DeviceStatus:
    """What the device said of itself when it was recorded."""
    rate_hz, step_dps, counts = (kept.get(name) for name in ("sample_rate_hz", "dps_per_lsb", "encoder_cpr"))
    return DeviceStatus(
        device_id=kept.get("device_id"),
        sample_rate_hz=None if rate_hz is None else float(rate_hz),
        dps_per_lsb=None if step_dps is None else float(step_dps),
        encoder_cpr=None if counts is None else int(counts),
    )
