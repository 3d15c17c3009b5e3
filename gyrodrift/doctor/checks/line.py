"""Checks of the line: protocol, baud rate, load, damage, restarts, units."""

from functools import partial

from gyrodrift.doctor.evidence import Check, DeviceEvidence, checks
from gyrodrift.doctor.finding import DeviceFinding, Severity, error, note, of_error, of_health, ok, sentence
from gyrodrift.link.port import USUAL_BAUDS
from gyrodrift.outputs import health
from gyrodrift.values.constants import LINE_BITS_PER_BYTE
from gyrodrift.values.errors import DeviceSilentError, UnitError

FULL = 0.6
"""Share of the line above which larger frames, or a higher rate, do not fit."""

SILENT_S = 1.0
"""Gap that counts as silence, s: shorter than in a service, since `doctor` listens for half a minute only."""

UNCHECKED = frozenset({"csv", "text", "witmotion-ble"})
"""Protocols without a checksum."""


def protocol(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Protocol, with or without checksum and clock."""
    link = evidence.link
    if isinstance(evidence.failure, DeviceSilentError):
        return of_error(str(evidence.failure).removeprefix(f"{link.port or evidence.source}: "))
    if not evidence.is_understood or not link.protocol:
        return None
    says = f"It sends {link.protocol}"
    if evidence.device.device_id:
        says += f", device {evidence.device.device_id}"
    if not evidence.has_clock:
        return note(
            f"{says}, which has no device clock: samples get the time of their arrival.",
            "If you can change the firmware, send the time of the sensor with each sample.",
        )
    if link.protocol in UNCHECKED:
        unit = "frames" if link.protocol == "witmotion-ble" else "lines"
        return note(
            f"{says}: {unit} without a checksum, so a damaged value may look like a rate.",
            "Use native frames on long or noisy lines.",
        )
    return ok(f"{says}.")


def baud(evidence: DeviceEvidence) -> DeviceFinding | None:
    """The baud rate, and rates that carry this stream."""
    needs = _needs_baud(evidence)
    if not needs or evidence.recording is not None or not evidence.link.baud:
        return None
    fitting = sorted(rate for rate in USUAL_BAUDS if needs <= FULL * rate)
    carried = ", ".join(map(str, fitting[:4])) if fitting else "none of the usual baud rates"
    if not _has_line(evidence):
        return ok(
            f"The port is not a UART, so any baud rate works; a UART needs {carried}.",
            evidence.link.baud,
            "baud",
        )
    return ok(f"It sends at {evidence.link.baud} baud; this stream fits at {carried}.", evidence.link.baud, "baud")


def line_budget(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Load of the line at this sample rate and frame size."""
    link, needs = evidence.link, _needs_baud(evidence)
    if not needs or not link.baud:
        return None
    frame_bytes, share = link.bytes / link.samples, needs / link.baud
    limit_hz = health.BUSY * link.baud / LINE_BITS_PER_BYTE / frame_bytes
    about = f"{frame_bytes:.1f} bytes per sample at {link.rate_hz:.4g} Hz are {share:.0%} of {link.baud} baud"
    if not _has_line(evidence):
        return ok(f"{about}; this port has no such limit.", share)
    slower = f"send at most {limit_hz:.0f} samples per second of this size"
    faster = min((rate for rate in USUAL_BAUDS if needs <= FULL * rate), default=None)
    do = f"Set {faster} baud in the firmware, or {slower}." if faster else f"{slower[0].upper()}{slower[1:]}."
    busy = health.line_busy(link)
    if busy is not None:
        return of_health(busy, Severity.ERROR, do, share)
    if share > FULL:
        return note(f"{about}: little is left.", do, share)
    return ok(f"{about}; up to {limit_hz:.0f} Hz fit.", share)


def damage(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Frames with a wrong checksum or form."""
    if not _is_counted(evidence):
        return None
    health_finding = health.damaged(evidence.link)
    share = evidence.link.damaged / max(evidence.link.samples + evidence.link.damaged, 1)
    if health_finding is None:
        says = "All lines could be read." if evidence.link.protocol in UNCHECKED else "No frame arrived damaged."
        return ok(says, 0.0)
    return of_health(
        health_finding,
        Severity.WARNING,
        "Shorten the cable, lay it away from motors, connect the grounds, lower the baud rate, and give the sensor its "
        "own supply.",
        share,
    )


def silence(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the device stopped sending."""
    if not evidence.is_understood or evidence.recording is not None or not evidence.link.is_open:
        return None
    silent = health.silent(evidence.link, SILENT_S)
    if silent is None:
        return None
    return of_health(
        silent, Severity.ERROR, "Its firmware hangs, perhaps while reading the sensor: reset it, and check the wires."
    )


def unplugged(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the port went away."""
    if evidence.recording is None and evidence.is_understood and not evidence.link.is_open:
        return error("The port went away while doctor listened.", "Check plug, cable and hub.")
    replugged = health.replugged(evidence.link)
    if replugged is None:
        return None
    return of_health(
        replugged, Severity.WARNING, "Check plug, cable and hub: USB power, or a hub that switches ports off."
    )


def restarts(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the device booted, or its clock jumped."""
    if finding := of_recording("restarts", evidence):
        return finding
    if not _is_counted(evidence):
        return None
    restarted = health.restarted(evidence.link)
    if restarted is None:
        return ok("The device did not restart.", 0)
    return of_health(
        restarted,
        Severity.WARNING,
        "Give the board its own supply, with a capacitor. Look for a watchdog, a DTR line, or firmware that sets its "
        "clock.",
        evidence.link.device_resets,
    )


def clock_unit(evidence: DeviceEvidence) -> DeviceFinding | None:
    """A clock in milliseconds or seconds."""
    if not isinstance(evidence.failure, UnitError):
        return of_recording("clock_unit", evidence)
    return of_error(str(evidence.failure).removeprefix(f"{evidence.link.port}: "))


def rate_unit(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Rates in rad/s or counts."""
    units = evidence.units
    if not units:
        return of_recording("rate_unit", evidence)
    says = f"The rates are {units['unit']} instead of deg/s, with odds of {units['odds']}: " if "unit" in units else ""
    return error(sentence(f"{says}{units['reason']}"), sentence(units["hint"]))


def of_recording(check: str, evidence: DeviceEvidence) -> DeviceFinding | None:
    """Finding of a check of a recording; None without one."""
    finding = next((finding for finding in evidence.checked if finding.id == check), None)
    if finding is None:
        return None
    severity = Severity.ERROR if finding.is_error else Severity.WARNING
    return DeviceFinding(severity, sentence(finding.says), sentence(finding.do))


def _is_counted(evidence: DeviceEvidence) -> bool:
    """Whether there are counters of the link; a foreign table has none."""
    return evidence.is_understood and (evidence.recording is None or evidence.link.bytes > 0)


def _has_line(evidence: DeviceEvidence) -> bool:
    return evidence.port.has_line_rate if evidence.port else evidence.recording is None


def _needs_baud(evidence: DeviceEvidence) -> float:
    """Smallest baud rate for this stream; 0 if it is unknown."""
    link = evidence.link
    return link.bytes / link.samples * link.rate_hz * LINE_BITS_PER_BYTE if link.samples and link.bytes else 0.0


CHECKS = (
    *checks(protocol, baud, line_budget, damage, silence, unplugged, restarts, clock_unit, rate_unit),
    *(
        Check(name, about, partial(of_recording, name))
        for name, about in (
            ("clock_stamps", "constant or coarse times in a recording"),
            ("clock_pace", "device time against host time in a recording"),
            ("rate_sign", "sign of the rates against the encoder in a recording"),
            ("rate_axis", "whether the rates of a recording follow its encoder"),
        )
    ),
)
