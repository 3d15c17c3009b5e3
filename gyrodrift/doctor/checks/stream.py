"""The stream: what is missing from it, how it arrives, and what its clock says."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.describe.text import JITTER_ODD
from gyrodrift.doctor.check import Check
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, Severity, error, note, of_health, ok, warning
from gyrodrift.doctor.still import RAIL_MIN_DPS, step_of, still_rate
from gyrodrift.outputs import health

MANY_MISSING = 0.01
CHANGED = 0.05
CHANGE_LEAST_S = 2.0

TOGETHER = 0.3
"""Part of a period within which samples arrive together."""

BUNCH = 1.5
"""Samples that arrive together, in the mean, above which they come in bunches."""

REPLAY_PPM = 100_000.0
"""No oscillator is so far off."""

STUCK_S = 1.0
STUCK_SAMPLES = 50
REPEATED = 0.01
"""Share of samples that repeat the one before, beyond what noise and step explain."""


def gaps(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Samples that never came."""
    if evidence.description is None:
        return None
    link, missing = evidence.link, evidence.description.gaps.missing
    said = health.lost(link)
    if said is None:
        return ok("No sample is missing.", 0)
    share = missing / max(missing + link.samples, 1)
    severity = Severity.WARNING if share > MANY_MISSING else Severity.NOTE
    do = "Look at line_budget and damage first; then at a firmware that waits elsewhere, or a host under full load."
    return of_health(said, severity, do, share)


def sample_rate(evidence: DeviceEvidence) -> DeviceFinding | None:
    """The rate that arrives beside the one that is stated."""
    if not evidence.link.rate_hz:
        return None
    said = health.rate_differs(evidence.link, evidence.device)
    if said is None:
        return ok(f"{evidence.link.rate_hz:.5g} samples a second arrive.", evidence.link.rate_hz, "Hz")
    do = "State in HELLO the rate that the sensor is set to; parameters of HDR belong to a rate."
    return of_health(said, Severity.WARNING, do, evidence.link.rate_hz, "Hz")


def rate_changes(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the sample rate stays."""
    steps_s = _steps_s(evidence)
    if len(steps_s) < 40 or steps_s.sum() < CHANGE_LEAST_S:
        return None
    tenths = [float(np.median(part)) for part in np.array_split(steps_s, 10)]
    change = max(tenths) / min(tenths) - 1.0
    if change < CHANGED:
        return ok("The sample rate stays.", change)
    return warning(
        f"The sample rate changes: from {1.0 / tenths[0]:.4g} to {1.0 / tenths[-1]:.4g} Hz.",
        "Look for a power saving mode, or for firmware that sets the sensor anew.",
        change,
    )


def stamps(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the device's own times are even."""
    about = evidence.description
    if about is None or about.rate_hz is None or about.jitter_s is None or not evidence.has_clock:
        return None
    share = about.jitter_s * about.rate_hz
    if share <= JITTER_ODD:
        return ok(
            f"The times of the device are even to {max(1e3 * about.jitter_s, 1e-3):.2g} ms.", 1e3 * about.jitter_s, "ms"
        )
    return warning(
        f"The times of the device scatter by {1e3 * about.jitter_s:.2g} ms, {share:.0%} of a period.",
        "Take the time in the interrupt of data-ready, not where the line is printed.",
        1e3 * about.jitter_s,
        "ms",
    )


def jitter(evidence: DeviceEvidence) -> DeviceFinding | None:
    """How evenly samples arrive."""
    if evidence.description is None or evidence.description.host is None:
        return None
    link = evidence.link
    said = health.uneven(link)
    if said is None:
        return ok(
            f"95 of 100 samples arrive within {max(link.jitter_ms, 1e-3):.2g} ms of the soonest.", link.jitter_ms, "ms"
        )
    effect = (
        "Yaw does not suffer, since the device has a clock of its own; what you control by it does."
        if evidence.has_clock
        else "Times are taken from arrivals: yaw suffers while it turns."
    )
    return of_health(
        said,
        Severity.NOTE,
        f"{effect} Look at bursts, latency_timer and the load of this computer.",
        link.jitter_ms,
        "ms",
    )


def bursts(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether samples come in bunches."""
    session, rate_hz = evidence.session, evidence.link.rate_hz
    if session is None or session.t_host_s is None or not rate_hz:
        return None
    arrivals_s = session.t_host_s[np.isfinite(session.t_host_s)]
    waits_s = np.diff(arrivals_s)
    if not waits_s.sum() > 0.0:
        return None
    together = len(arrivals_s) / (1 + int((waits_s > TOGETHER * waits_s.mean()).sum()))
    if together <= BUNCH:
        return ok("Samples arrive one by one.", together)
    return note(
        f"Samples arrive in bunches of {together:.3g}, every {1e3 * together / rate_hz:.0f} ms.",
        "Send each sample when it is there; look at latency_timer; Bluetooth and USB hubs collect, too.",
        together,
    )


def clock_drift(evidence: DeviceEvidence) -> DeviceFinding | None:
    """The device's clock against the host's."""
    if evidence.description is None or evidence.description.host is None or not evidence.has_clock:
        return None
    ppm, rough_ppm = evidence.link.clock_ppm, evidence.description.host.drift_ppm or 0.0
    if abs(rough_ppm) > REPLAY_PPM:
        pace = 1.0 + 1e-6 * rough_ppm
        return note(f"Device time passes at {pace:.3g} times the pace of this computer: it is a replay.")
    if ppm is None:
        return ok("How fast its clock runs cannot be told from so few seconds, or so uneven arrivals.")
    said = health.clock_off(evidence.link)
    if said is None:
        return ok(f"The device's clock is {round(ppm) + 0:+d} ppm off this computer's.", ppm, "ppm")
    return of_health(
        said,
        Severity.WARNING,
        f"Every turn reads {ppm * 1e-4:+.2g} % wrong by it: clock the board by a crystal rather than an RC "
        "oscillator, or let gyrodrift calibrate take it into the scale.",
        ppm,
        "ppm",
    )


def stuck(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the rate goes on changing."""
    if evidence.session is None or not evidence.link.rate_hz:
        return None
    longest, value_dps = _longest_run(evidence.session.rate_dps)
    seconds = longest / evidence.link.rate_hz
    if seconds < STUCK_S or longest < STUCK_SAMPLES:
        return ok("The rate never stands still for long.", seconds, "s")
    if value_dps == 0.0 and evidence.holds_zero:
        return note(
            f"The rate said exactly 0 for {seconds:.1f} s: this family does so at rest, and no bias can be seen.",
            "Turn it: if the rate stays 0, the sensor hangs. Only yaw over an hour tells what drift is left.",
            seconds,
            "s",
        )
    return error(
        f"The rate said one value for {seconds:.1f} s, while everything else went on.",
        "The sensor hangs on its bus, or its step hides the noise: look at wires and pull-ups, check what each read "
        "returns, set up the sensor anew where it fails, choose a finer range.",
        seconds,
        "s",
    )


def repeats(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Samples that are the one before once more."""
    at_rest = still_rate(evidence)
    if at_rest is None or not at_rest.std_dps:
        return None
    step_dps = step_of(evidence) or 0.0
    chance = step_dps / (2.0 * np.sqrt(np.pi) * at_rest.std_dps)  # of two normal values to fall on one step
    share = float((np.diff(at_rest.rate_dps) == 0.0).mean())
    if chance > 0.5 or share <= 1.3 * chance + REPEATED:
        return ok("Every sample is a new one.", share)
    return warning(
        f"{share:.1%} of the samples repeat the one before; by chance it would be {chance:.1%}.",
        "The sensor is read more often than it measures: read it at its data-ready, or send fewer samples.",
        share,
    )


def _longest_run(rate_dps: Floats) -> tuple[int, float]:
    """Samples in a row that say one value, and it; the end of the range is not counted: a finding of its own."""
    ends = np.concatenate([[-1], np.flatnonzero(np.diff(rate_dps) != 0.0), [len(rate_dps) - 1]])
    most_dps = float(np.nanmax(np.abs(rate_dps), initial=0.0))
    is_rail = (np.abs(rate_dps[ends[1:]]) >= most_dps) & (most_dps > RAIL_MIN_DPS)
    runs = np.where(is_rail, 0, np.diff(ends))
    longest = int(runs.argmax())
    return int(runs[longest]), float(rate_dps[ends[longest + 1]])


def _steps_s(evidence: DeviceEvidence) -> Floats:
    if evidence.session is None:
        return np.empty(0)
    steps_s: Floats = np.diff(evidence.session.t_device_s)
    return steps_s[steps_s > 0.0]


CHECKS = (
    Check("gaps", "samples that never came", gaps),
    Check("sample_rate", "the rate that arrives beside the one that is stated", sample_rate),
    Check("rate_changes", "whether the sample rate stays", rate_changes),
    Check("stamps", "whether the device's own times are even", stamps),
    Check("jitter", "how evenly samples arrive", jitter),
    Check("bursts", "whether samples come in bunches", bursts),
    Check("clock_drift", "the device's clock against the host's", clock_drift),
    Check("stuck", "whether the rate goes on changing", stuck),
    Check("repeats", "samples that repeat the one before", repeats),
)
