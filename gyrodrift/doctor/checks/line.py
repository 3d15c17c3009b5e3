"""The line: what is spoken on it, at which baud rate, how full it is, and what is damaged."""

from functools import partial

from gyrodrift.doctor.check import Check
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, Severity, error, note, of_error, of_health, ok, sentence
from gyrodrift.doctor.listen import BITS_PER_BYTE
from gyrodrift.errors import DeviceSilentError, UnitError
from gyrodrift.link.port import USUAL_BAUDS
from gyrodrift.outputs import health

FULL = 0.6
"""Share of the line above which a frame more, or a higher rate, has no room."""

SILENT_S = 1.0
"""Who listens for half a minute does not wait as long as a service does."""

UNCHECKED = frozenset({"csv", "text", "witmotion-ble"})
"""Protocols without a checksum."""


def protocol(evidence: DeviceEvidence) -> DeviceFinding | None:
    """What it speaks."""
    link = evidence.link
    if isinstance(evidence.failure, DeviceSilentError):
        return of_error(str(evidence.failure).removeprefix(f"{link.port or evidence.source}: "))
    if not evidence.is_understood or not link.protocol:
        return None
    says = f"It speaks {link.protocol}"
    if evidence.device.device_id:
        says += f", device {evidence.device.device_id}"
    if not evidence.has_clock:
        return note(
            f"{says}, which carries no device clock: samples are timed by their arrival.",
            "Send the sensor's time with each sample, where the firmware is yours.",
        )
    if link.protocol in UNCHECKED:
        what = "frames" if link.protocol == "witmotion-ble" else "lines"
        return note(
            f"{says}: {what} without a checksum, so a damaged one may pass for a rate.",
            "Send native frames over long or noisy lines.",
        )
    return ok(f"{says}.")


def baud(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Which line rates carry this stream."""
    needs = _needs_baud(evidence)
    if not needs or evidence.recording is not None:
        return None
    fitting = sorted(rate for rate in USUAL_BAUDS if needs <= FULL * rate)
    carried = ", ".join(map(str, fitting[:4])) if fitting else "none of the usual rates"
    if not _has_line(evidence):
        return ok(
            f"The port is no UART line, so any rate does; on a UART, {carried} would carry it.",
            evidence.link.baud,
            "baud",
        )
    return ok(f"It sends at {evidence.link.baud} baud; {carried} carry it with room.", evidence.link.baud, "baud")


def line_budget(evidence: DeviceEvidence) -> DeviceFinding | None:
    """How much of the line is used at this rate and frame size."""
    link, needs = evidence.link, _needs_baud(evidence)
    if not needs or not link.baud:
        return None
    frame_bytes, share = link.bytes / link.samples, needs / link.baud
    most_hz = health.BUSY * link.baud / BITS_PER_BYTE / frame_bytes
    about = f"{frame_bytes:.1f} bytes a sample at {link.rate_hz:.4g} Hz are {share:.0%} of {link.baud} baud"
    if not _has_line(evidence):
        return ok(f"{about}; this port has no such limit.", share)
    slower = f"send at most {most_hz:.0f} samples a second of this size"
    faster = min((rate for rate in USUAL_BAUDS if needs <= FULL * rate), default=None)
    do = f"Set {faster} baud in the firmware, or {slower}." if faster else f"{slower[0].upper()}{slower[1:]}."
    busy = health.line_busy(link)
    if busy is not None:
        return of_health(busy, Severity.ERROR, do, share)
    if share > FULL:
        return note(f"{about}: little room is left.", do, share)
    return ok(f"{about}; up to {most_hz:.0f} Hz fit.", share)


def damage(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Frames that failed their checksum or form."""
    if not _is_counted(evidence):
        return None
    said = health.damaged(evidence.link)
    share = evidence.link.damaged / max(evidence.link.samples + evidence.link.damaged, 1)
    if said is None:
        seen = "Every line could be read." if evidence.link.protocol in UNCHECKED else "No frame arrived damaged."
        return ok(seen, 0.0)
    return of_health(
        said,
        Severity.WARNING,
        "Shorten the cable, lay it away from motors, join the grounds, lower the baud rate; feed the sensor from a "
        "supply of its own.",
        share,
    )


def silence(evidence: DeviceEvidence) -> DeviceFinding | None:
    """A device that stopped speaking meanwhile."""
    if not evidence.is_understood or evidence.recording is not None or not evidence.link.is_open:
        return None
    said = health.silent(evidence.link, SILENT_S)
    if said is None:
        return None
    return of_health(
        said, Severity.ERROR, "Its firmware hangs, perhaps in a read of the sensor: reset it, look at wires."
    )


def unplugged(evidence: DeviceEvidence) -> DeviceFinding | None:
    """A port that went away meanwhile."""
    if evidence.recording is None and evidence.is_understood and not evidence.link.is_open:
        return error("The port went away while it was listened to.", "Look at plug, cable and hub.")
    said = health.replugged(evidence.link)
    if said is None:
        return None
    return of_health(said, Severity.WARNING, "Look at plug, cable and hub: USB power, a hub that switches ports off.")


def restarts(evidence: DeviceEvidence) -> DeviceFinding | None:
    """A device that booted, or whose clock jumped."""
    if found := of_recording("restarts", evidence):
        return found
    if not _is_counted(evidence):
        return None
    said = health.restarted(evidence.link)
    if said is None:
        return ok("The device did not begin anew.", 0)
    return of_health(
        said,
        Severity.WARNING,
        "Feed the board from a supply of its own, with a capacitor; look for a watchdog, a DTR line, or firmware "
        "that sets its clock.",
        evidence.link.device_resets,
    )


def clock_unit(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether its clock counts what it is taken for."""
    if not isinstance(evidence.failure, UnitError):
        return of_recording("clock_unit", evidence)
    return of_error(str(evidence.failure).removeprefix(f"{evidence.link.port}: "))


def rate_unit(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether its rates are in deg/s."""
    units = evidence.units
    if not units:
        return of_recording("rate_unit", evidence)
    return error(
        f"The rates are {units['unit']} rather than deg/s, at odds of {units['odds']}: {units['reason']}.",
        f"{units['hint'][0].upper()}{units['hint'][1:]}.",
    )


def of_recording(check: str, evidence: DeviceEvidence) -> DeviceFinding | None:
    """What a check of a recording found; None where it found nothing."""
    found = next((finding for finding in evidence.checked if finding.id == check), None)
    if found is None:
        return None
    severity = Severity.ERROR if found.is_error else Severity.WARNING
    return DeviceFinding(severity, sentence(found.says), sentence(found.do))


def _is_counted(evidence: DeviceEvidence) -> bool:
    """Whether the link was heard, or its counters kept; a table of other people has none."""
    return evidence.is_understood and (evidence.recording is None or evidence.link.bytes > 0)


def _has_line(evidence: DeviceEvidence) -> bool:
    return evidence.port.has_line_rate if evidence.port else evidence.recording is None


def _needs_baud(evidence: DeviceEvidence) -> float:
    """The line rate that would be used to the full; 0 where it is not known."""
    link = evidence.link
    return link.bytes / link.samples * link.rate_hz * BITS_PER_BYTE if link.samples and link.bytes else 0.0


CHECKS = (
    Check("protocol", "what is spoken, with a checksum and a clock or without", protocol),
    Check("baud", "the line rate, and which ones make sense for this stream", baud),
    Check("line_budget", "share of the line at this sample rate and frame size", line_budget),
    Check("damage", "frames that failed their checksum or form", damage),
    Check("silence", "the device stopped speaking meanwhile", silence),
    Check("unplugged", "the port went away meanwhile", unplugged),
    Check("restarts", "the device booted, or its clock jumped", restarts),
    Check("clock_unit", "a clock that counts milliseconds or seconds", clock_unit),
    Check("rate_unit", "rates in rad/s or counts", rate_unit),
    *(
        Check(name, about, partial(of_recording, name))
        for name, about in (
            ("clock_stamps", "times of a recording that stand still or are too coarse"),
            ("clock_pace", "seconds of the device beside those of the host, in a recording"),
            ("rate_sign", "the sign of the rates beside the encoder, in a recording"),
            ("rate_axis", "whether the rates of a recording follow its encoder"),
        )
    ),
)
