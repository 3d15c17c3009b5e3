"""Checks of the stream: missing samples, arrival, clock, repeated values."""

import numpy as np

from gyrodrift.columns.readings import RAIL_MIN_DPS
from gyrodrift.describe.text import JITTER_ODD
from gyrodrift.doctor.evidence import DeviceEvidence, checks_of, facts_of, rest_of
from gyrodrift.doctor.finding import DeviceFinding, Severity, error, note, of_health, ok, warning
from gyrodrift.facts.session_facts import SessionFacts, StillRate
from gyrodrift.outputs import health
from gyrodrift.values.arrays import Floats

MANY_MISSING = 0.01
CHANGED = 0.05
CHANGE_MIN_S = 2.0

TOGETHER = 0.3
"""Fraction of a period within which samples arrive together."""

BUNCH = 1.5
"""Mean number of samples that arrive together, above which they come in bursts."""

REPLAY_PPM = 100_000.0
"""Clock drift above that of any oscillator."""

STUCK_S = 1.0
STUCK_SAMPLES = 50
REPEATED = 0.01
"""Share of repeated samples beyond the share that noise and step explain."""


def gaps(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Missing samples."""
    link, missing = evidence.link, facts.gaps.missing
    lost = health.lost(link)
    if lost is None:
        return ok("No sample is missing.", 0)
    share = missing / max(missing + link.samples, 1)
    severity = Severity.WARNING if share > MANY_MISSING else Severity.NOTE
    do = "Check line_budget and damage first, then firmware that waits elsewhere, and the load of the host."
    return of_health(lost, severity, do, share)


def sample_rate(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Received sample rate, compared with the stated one."""
    if not facts.rate_hz:
        return None
    differs = health.rate_differs(evidence.link, evidence.device)
    if differs is None:
        return ok(f"{facts.rate_hz:.5g} samples per second arrive.", facts.rate_hz, "Hz")
    do = "State the true sample rate in HELLO; parameters of HDR belong to a sample rate."
    return of_health(differs, Severity.WARNING, do, facts.rate_hz, "Hz")


def rate_changes(_evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Whether the sample rate is constant."""
    steps_s = np.diff(facts.session.t_device_s)
    steps_s = steps_s[steps_s > 0.0]
    if len(steps_s) < 40 or steps_s.sum() < CHANGE_MIN_S:
        return None
    tenths = [float(np.median(part)) for part in np.array_split(steps_s, 10)]
    change = max(tenths) / min(tenths) - 1.0
    if change < CHANGED:
        return ok("The sample rate is constant.", change)
    return warning(
        f"The sample rate changes: from {1.0 / tenths[0]:.4g} to {1.0 / tenths[-1]:.4g} Hz.",
        "Look for a power saving mode, or for firmware that sets up the sensor again.",
        change,
    )


def stamps(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Whether the time stamps of the device are regular."""
    if facts.rate_hz is None or facts.jitter_s is None or not evidence.has_clock:
        return None
    share = facts.jitter_s * facts.rate_hz
    if share <= JITTER_ODD:
        return ok(
            f"The time stamps of the device are regular to {max(1e3 * facts.jitter_s, 1e-3):.2g} ms.",
            1e3 * facts.jitter_s,
            "ms",
        )
    return warning(
        f"The time stamps of the device scatter by {1e3 * facts.jitter_s:.2g} ms, {share:.0%} of a period.",
        "Take the time in the data-ready interrupt, not when the line is printed.",
        1e3 * facts.jitter_s,
        "ms",
    )


def jitter(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Jitter of the arrival."""
    if facts.host is None:
        return None
    link = evidence.link
    uneven = health.uneven(link)
    if uneven is None:
        return ok(
            f"95 % of the samples arrive with a delay below {max(link.jitter_ms, 1e-3):.2g} ms.", link.jitter_ms, "ms"
        )
    effect = (
        "Yaw does not suffer, because the device has its own clock; control by yaw does."
        if evidence.has_clock
        else "Times come from the arrival, so yaw suffers while the device turns."
    )
    return of_health(
        uneven,
        Severity.NOTE,
        f"{effect} Check bursts, latency_timer and the load of this computer.",
        link.jitter_ms,
        "ms",
    )


def bursts(_evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Whether samples arrive in bursts."""
    host_s = facts.session.t_host_s
    if host_s is None or not facts.rate_hz:
        return None
    arrivals_s = host_s[np.isfinite(host_s)]
    waits_s = np.diff(arrivals_s)
    if not waits_s.sum() > 0.0:
        return None
    together = len(arrivals_s) / (1 + int((waits_s > TOGETHER * waits_s.mean()).sum()))
    if together <= BUNCH:
        return ok("Samples arrive one by one.", together)
    return note(
        f"Samples arrive in bursts of {together:.3g}, every {1e3 * together / facts.rate_hz:.0f} ms.",
        "Send every sample at once, and check latency_timer. Bluetooth and USB hubs collect samples, too.",
        together,
    )


def clock_drift(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Drift of the device clock against the host clock."""
    if facts.host is None or not evidence.has_clock:
        return None
    ppm, rough_ppm = evidence.link.clock_ppm, facts.host.drift_ppm or 0.0
    if abs(rough_ppm) > REPLAY_PPM:
        pace = 1.0 + 1e-6 * rough_ppm
        return note(f"The device clock runs {pace:.3g} times as fast as this computer: this is a replay.")
    if ppm is None:
        return ok("The recording is too short, or its arrival too irregular, to measure the clock drift.")
    drifts = health.clock_off(evidence.link)
    if drifts is None:
        return ok(f"The device clock is {round(ppm) + 0:+d} ppm fast against this computer.", ppm, "ppm")
    return of_health(
        drifts,
        Severity.WARNING,
        f"Every turn reads {ppm * 1e-4:+.2g} % wrong because of it: use a crystal instead of an RC oscillator, or run "
        "gyrodrift calibrate, whose scale includes it.",
        ppm,
        "ppm",
    )


def stuck(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Whether the rate keeps changing."""
    if not facts.rate_hz:
        return None
    longest, value_dps = _longest_run(facts.session.rate_dps)
    seconds = longest / facts.rate_hz
    for hang, end in zip(facts.readings.fields_of("rate_hangs"), facts.readings.fields_of("rate_moves"), strict=True):
        if end["seconds"] > seconds:
            seconds, value_dps, longest = end["seconds"], hang["rate_dps"], STUCK_SAMPLES
    if seconds < STUCK_S or longest < STUCK_SAMPLES:
        return ok("The rate is never constant for long.", seconds, "s")
    if value_dps == 0.0 and evidence.holds_zero:
        return note(
            f"The rate was exactly 0 for {seconds:.1f} s: this family does so at rest, and hides its bias.",
            "Turn it: if the rate stays 0, the sensor hangs. Only yaw over an hour shows the drift.",
            seconds,
            "s",
        )
    return error(
        f"The rate was constant for {seconds:.1f} s, while everything else went on.",
        "The sensor hangs on its bus, or its step hides the noise: check wires and pull-ups, check the result of every "
        "read, set up the sensor again if one fails, or choose a finer range.",
        seconds,
        "s",
    )


def repeats(evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """Samples that repeat the previous one."""
    if not at_rest.std_dps:
        return None
    step_dps = evidence.step_dps or 0.0
    chance = step_dps / (2.0 * np.sqrt(np.pi) * at_rest.std_dps)  # that two normal values round to the same step
    share = float((np.diff(at_rest.rate_dps) == 0.0).mean())
    if chance > 0.5 or share <= 1.3 * chance + REPEATED:
        return ok("No sample repeats the previous one.", share)
    return warning(
        f"{share:.1%} of the samples repeat the previous one; chance explains {chance:.1%}.",
        "The sensor is read more often than it measures: read it at data-ready, or send fewer samples.",
        share,
    )


def _longest_run(rate_dps: Floats) -> tuple[int, float]:
    """Length and value of the longest run of equal samples; the end of the range does not count (check `clipped`)."""
    ends = np.concatenate([[-1], np.flatnonzero(np.diff(rate_dps) != 0.0), [len(rate_dps) - 1]])
    largest_dps = float(np.nanmax(np.abs(rate_dps), initial=0.0))
    is_rail = (np.abs(rate_dps[ends[1:]]) >= largest_dps) & (largest_dps > RAIL_MIN_DPS)
    runs = np.where(is_rail, 0, np.diff(ends))
    longest = int(runs.argmax())
    return int(runs[longest]), float(rate_dps[ends[longest + 1]])


CHECKS = (
    *checks_of(facts_of, gaps, sample_rate, rate_changes, stamps, jitter, bursts, clock_drift, stuck),
    *checks_of(rest_of, repeats),
)
