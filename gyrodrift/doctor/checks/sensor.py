"""The sensor: its data sheet beside what is measured of it at rest."""

from math import sqrt

import numpy as np

from gyrodrift.describe.text import NOISY_DPS
from gyrodrift.describe.values import RestSource
from gyrodrift.doctor.check import Check
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.doctor.finding import DeviceFinding, Severity, error, note, of_health, ok, warning
from gyrodrift.doctor.sensors import with_step
from gyrodrift.doctor.spectrum import spectrum_of
from gyrodrift.doctor.still import RAIL_LEAST_DPS, step_of, still_rate
from gyrodrift.outputs import health

RAIL_SAMPLES = 5
"""So many samples at exactly the largest rate, and no small one, are a range that has ended."""

MOST_CLIPPED = 0.2
NOISY, QUIET = 2.0, 0.4
"""Measured noise over that of the data sheet."""

COARSE = 1.0
"""Step over noise above which the noise no longer rounds the step out."""

FLAT = 0.5
WARM_C_MIN, WARM_C = 0.2, 0.2
MOVED_SIGMAS, MOVED_DPS = 6.0, 0.003


def sensor(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Which sensor it is, as far as anybody says."""
    if evidence.session is None:
        return None
    step_dps = step_of(evidence)
    if evidence.sensor is not None:
        scale = evidence.sensor.range_of(step_dps) if step_dps else None
        ranged = f", set to ±{scale} deg/s" if scale else ""
        return ok(
            f"The sensor is {evidence.sensor.name}{ranged}; data sheet: {evidence.sensor.source}.", scale, "deg/s"
        )
    fitting = with_step(step_dps) if step_dps else []
    alike = ", ".join(f"{each.name} at ±{scale}" for each, scale in fitting)
    guess = f" Its step of {step_dps:.4g} deg/s is that of {alike} deg/s." if fitting else ""
    return note(f"The device names no sensor.{guess}", "Name it with --sensor to compare it with its data sheet.")


def still(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether there was a rest to measure at."""
    if evidence.description is None or not evidence.is_in_deg_s:
        return None
    rest = evidence.rest
    if rest is None:
        return warning(
            "It did not stand still for three seconds: noise, bias and drift are not known.",
            "Leave it on a table and run this again.",
        )
    if rest.std_dps > NOISY_DPS:
        return warning(
            f"What passes for rest scatters by {rest.std_dps:.3g} deg/s, more than any gyro.",
            "Switch motors off, leave it on a table, and run this again.",
            rest.std_dps,
            "deg/s",
        )
    seconds = rest.end_s - rest.start_s
    if evidence.description.still_by is RestSource.ENCODER:
        return ok(f"It stood still for {seconds:.1f} s, by its encoder.", seconds, "s")
    return ok(f"It stood still for {seconds:.1f} s, or turned evenly, which looks the same.", seconds, "s")


def clipped(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether rates leave the range."""
    session = evidence.session
    if session is None:
        return None
    rates = np.abs(session.rate_dps[np.isfinite(session.rate_dps)])
    most_dps = float(rates.max(initial=0.0))
    at_most = int((rates >= most_dps * (1.0 - 1e-9)).sum())
    said = health.clipped(evidence.link)
    share = max(evidence.link.clipped, at_most if said is None else 0) / len(session.rate_dps)
    do = "Choose a wider range, or turn more slowly: what is cut off is missing from yaw for good."
    if said is not None:
        if share > MOST_CLIPPED:
            return error(said.says, "The sensor stands at its rail: it is broken, or not set up.", share)
        return of_health(said, Severity.WARNING, do, share)
    if at_most >= RAIL_SAMPLES and most_dps > RAIL_LEAST_DPS:
        return warning(f"{at_most} samples say exactly {most_dps:.5g} deg/s: the range ends there.", do, share)
    return ok(f"No rate left the range; the largest was {most_dps:.4g} deg/s.", 0.0)


def noise(evidence: DeviceEvidence) -> DeviceFinding | None:
    """White noise, beside the data sheet."""
    at_rest = still_rate(evidence)
    if at_rest is None:
        return None
    density = sqrt(2.0) * at_rest.noise_dps_rthz
    says = f"At rest the noise is {density:.2g} deg/s/√Hz"
    if evidence.sensor is None:
        return ok(f"{says}; {at_rest.std_dps:.2g} deg/s from sample to sample.", density, "deg/s/√Hz")
    ratio = density / evidence.sensor.noise_dps_rthz
    beside = f"{says}, {ratio:.2g} times the {evidence.sensor.noise_dps_rthz:g} of the {evidence.sensor.name}"
    if ratio > NOISY:
        return warning(
            f"{beside}.",
            "Something shakes it, or its supply is noisy, or samples are taken slower than its low-pass is wide: "
            f"mount it on foam, decouple its supply, set its low-pass ({evidence.sensor.bandwidth_by}).",
            density,
            "deg/s/√Hz",
        )
    if ratio < QUIET:
        return note(f"{beside}: something averages.", "A low-pass or a mean delays the rate.", density, "deg/s/√Hz")
    return ok(f"{beside}.", density, "deg/s/√Hz")


def resolution(evidence: DeviceEvidence) -> DeviceFinding | None:
    """The step of the rate beside its noise, and the range beside its turns."""
    at_rest, step_dps = still_rate(evidence), step_of(evidence)
    if at_rest is None or evidence.session is None or not step_dps:
        return None
    says = f"The step of the rate is {step_dps:.3g} deg/s"
    if step_dps > COARSE * at_rest.std_dps:
        return warning(
            f"{says}, more than its noise of {at_rest.std_dps:.2g} deg/s: the bias shows to a part of a step only.",
            "Choose a finer range, print more digits, or send counts.",
            step_dps,
            "deg/s",
        )
    turned_dps = float(np.abs(evidence.session.rate_dps).max())
    finer = [scale for scale, lsb in evidence.sensor.ranges if 1.0 / lsb < 0.9 * step_dps] if evidence.sensor else []
    if finer and step_dps > 0.5 * at_rest.std_dps:
        return note(
            f"{says}, about its noise; the fastest turn was {turned_dps:.3g} deg/s.",
            f"A range of ±{min(finer)} deg/s is finer, if you never turn faster.",
            step_dps,
            "deg/s",
        )
    return ok(f"{says}, below its noise of {at_rest.std_dps:.2g} deg/s.", step_dps, "deg/s")


def aliasing(evidence: DeviceEvidence) -> DeviceFinding | None:
    """A tone at rest, and whether it may stand for one above half the sample rate."""
    at_rest, rate_hz = still_rate(evidence), evidence.link.rate_hz
    seen = spectrum_of(at_rest.rate_dps, rate_hz) if at_rest is not None else None
    if seen is None:
        return None
    is_flat = seen.upper_share > FLAT
    if seen.tone_hz is None or seen.tone_dps is None:
        if not is_flat:
            return ok("The noise falls towards half the sample rate: a low-pass is at work.", seen.upper_share)
        return ok(
            f"No vibration is seen; nothing filters below {rate_hz / 2.0:.4g} Hz, so one above it would fold.",
            seen.upper_share,
        )
    tone = f"A tone of {seen.tone_hz:.3g} Hz shakes the rate by {seen.tone_dps:.2g} deg/s at rest"
    mount = "Mount the sensor on foam, away from motors and fans"
    if not is_flat:
        return note(f"{tone}: vibration.", f"{mount}.", seen.tone_hz, "Hz")
    folded = ", ".join(f"{hz:.3g}" for hz in (rate_hz - seen.tone_hz, rate_hz + seen.tone_hz))
    where = evidence.sensor.bandwidth_by if evidence.sensor else "see its data sheet"
    return warning(
        f"{tone}; nothing filters below half the sample rate, so it may be aliased, from {folded} Hz or more.",
        f"Set the low-pass of the sensor below {rate_hz / 2.0:.4g} Hz ({where}), or sample faster. {mount}.",
        seen.tone_hz,
        "Hz",
    )


def temperature(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether it is still warming up."""
    session = evidence.session
    if session is None:
        return None
    if session.temp_c is None:
        return ok("It sends no temperature.")
    known = np.isfinite(session.temp_c) & np.isfinite(session.t_device_s)
    t_s, temp_c = session.t_device_s[known], session.temp_c[known]
    if len(t_s) < 3 or t_s[-1] <= t_s[0]:
        return None
    slope_c_min = 60.0 * float(np.polyfit(t_s - t_s[0], temp_c, 1)[0])
    moved_c = abs(slope_c_min) / 60.0 * float(t_s[-1] - t_s[0])
    now = f"{temp_c[-1]:.1f} °C"
    if abs(slope_c_min) < WARM_C_MIN or moved_c < WARM_C:
        return ok(f"The temperature stays: {now}.", slope_c_min, "°C/min")
    per_c = evidence.sensor.zero_rate_dps_c if evidence.sensor else None
    bias = f", by up to {per_c * abs(slope_c_min):.2g} deg/s a minute by the data sheet" if per_c else ""
    return note(
        f"The temperature moves by {slope_c_min:+.2g} °C a minute, now {now}: the bias moves with it{bias}.",
        "Wait until it has settled before you calibrate; give a filter rests meanwhile.",
        slope_c_min,
        "°C/min",
    )


def bias(evidence: DeviceEvidence) -> DeviceFinding | None:
    """The bias now."""
    at_rest = still_rate(evidence)
    if at_rest is None:
        return None
    says = f"The bias is {at_rest.bias_dps:+.4f} ± {at_rest.bias_sigma_dps:.4f} deg/s"
    limit_dps = evidence.sensor.zero_rate_dps if evidence.sensor else None
    if evidence.sensor is None or limit_dps is None:
        return ok(f"{says}.", at_rest.bias_dps, "deg/s")
    within = f"the {evidence.sensor.name} may have ±{limit_dps:g}"
    if abs(at_rest.bias_dps) > limit_dps:
        return warning(
            f"{says}; {within}.",
            "Did it stand still? If so, it is damaged, badly fed, or its counts are scaled wrongly.",
            at_rest.bias_dps,
            "deg/s",
        )
    return ok(f"{says}; {within}.", at_rest.bias_dps, "deg/s")


def bias_moves(evidence: DeviceEvidence) -> DeviceFinding | None:
    """Whether the bias stays over the rest."""
    at_rest = still_rate(evidence)
    if at_rest is None or len(at_rest.rate_dps) < 40:
        return None
    quarter = len(at_rest.rate_dps) // 4
    moved_dps = float(at_rest.rate_dps[-quarter:].mean() - at_rest.rate_dps[:quarter].mean())
    sigma_dps = at_rest.noise_dps_rthz * sqrt(8.0 / at_rest.seconds)
    if abs(moved_dps) < max(MOVED_SIGMAS * sigma_dps, MOVED_DPS):
        return ok(f"The bias stays, as far as {at_rest.seconds:.0f} s show.", moved_dps, "deg/s")
    return note(
        f"The bias moved by {moved_dps:+.3f} deg/s within {at_rest.seconds:.0f} s.",
        "Let it warm up; a start calibration is soon out of date, a filter with rests is not.",
        moved_dps,
        "deg/s",
    )


CHECKS = (
    Check("sensor", "which sensor it is, and its data sheet", sensor),
    Check("still", "whether there was a rest to measure at", still),
    Check("clipped", "rates at the end of the range", clipped),
    Check("noise", "white noise beside the data sheet", noise),
    Check("resolution", "the step of the rate beside its noise", resolution),
    Check("aliasing", "a tone at rest, and whether it may be folded", aliasing),
    Check("temperature", "whether the sensor is warming up", temperature),
    Check("bias", "the bias now, beside the data sheet", bias),
    Check("bias_moves", "whether the bias stays", bias_moves),
)
