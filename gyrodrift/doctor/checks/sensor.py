"""Checks of the sensor: which one it is, rest, range, temperature and bias."""

import numpy as np

from gyrodrift.describe.text import NOISY_DPS
from gyrodrift.doctor.evidence import DeviceEvidence, checks_of, facts_of, rest_of
from gyrodrift.doctor.finding import DeviceFinding, Severity, error, note, of_health, ok, warning
from gyrodrift.doctor.sensors import with_step
from gyrodrift.facts.rests import RestSource
from gyrodrift.facts.session_facts import SessionFacts, StillRate
from gyrodrift.outputs import health
from gyrodrift.values.arrays import Floats

CLIPPED_MAX = 0.2
"""Share of clipped samples above which the sensor is broken or set up wrongly."""

WARMING_C_MIN = 0.2
WARMED_C = 0.2
SPAN_C = 1.0
"""A temperature is steady if its slope is below 0.2 °C/min or its whole change below 0.2 °C, and its span below 1 °C.

An MPU-6050 may change its bias by 0.16 deg/s per °C.
"""

MOVED_SIGMAS, MOVED_DPS = 6.0, 0.003
"""A bias has moved if its first and last quarter differ by more standard errors, and by more deg/s."""

SHORT_S = 6.0
"""Twice the shortest rest, so that one fits in beside the first and the last motion."""


def sensor(evidence: DeviceEvidence, _facts: SessionFacts) -> DeviceFinding | None:
    """Name of the sensor, and its data sheet."""
    step_dps = evidence.step_dps
    if evidence.sensor is not None:
        scale = evidence.sensor.range_of(step_dps) if step_dps else None
        ranged = f", set to ±{scale} deg/s" if scale else ""
        return ok(
            f"The sensor is {evidence.sensor.name}{ranged}; data sheet: {evidence.sensor.source}.", scale, "deg/s"
        )
    ranges = with_step(step_dps) if step_dps else []
    fitting = ", ".join(f"{sensor.name} at ±{scale}" for sensor, scale in ranges)
    guess = f" Its step of {step_dps:.4g} deg/s fits {fitting} deg/s." if fitting else ""
    return note(f"The device names no sensor.{guess}", "Name it with --sensor to compare it with its data sheet.")


def still(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Whether there was a rest to measure at."""
    if not evidence.is_in_deg_s:
        return None
    rest = facts.rest
    if rest is None and facts.duration_s < SHORT_S:
        return warning(
            f"{facts.duration_s:.1f} s are too short to find a rest: noise, bias and drift are unknown.",
            "Listen for 30 s.",
        )
    if rest is None:
        return warning(
            "It did not stand still for three seconds: noise, bias and drift are unknown.",
            "Leave it on a table and run this again.",
        )
    if rest.std_dps > NOISY_DPS:
        return warning(
            f"The rate scatters by {rest.std_dps:.3g} deg/s at rest, more than any gyro.",
            "Switch motors off, leave it on a table, and run this again.",
            rest.std_dps,
            "deg/s",
        )
    seconds = rest.seconds
    if facts.still_by is RestSource.ENCODER:
        return ok(f"It stood still for {seconds:.1f} s, by its encoder.", seconds, "s")
    return ok(f"It stood still for {seconds:.1f} s, or turned evenly: the rate alone cannot tell.", seconds, "s")


def clipped(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Rates at the end of the range."""
    readings, rate = facts.readings, facts.rate
    largest_dps = 0.0 if rate is None else max(abs(rate.min_dps), abs(rate.max_dps))
    marked = health.clipped(evidence.link)
    share = max(evidence.link.clipped, readings.clipped) / facts.samples
    do = "Choose a wider range, or turn more slowly: yaw loses the angle that is cut off."
    if marked is not None and share > CLIPPED_MAX:
        return error(marked.says, "The sensor is stuck at its limit: it is broken, or set up wrongly.", share)
    if marked is not None:
        return of_health(marked, Severity.WARNING, do, share)
    if readings.clipped:
        limit_dps = readings.fields_of("clipped")[0]["limit_dps"]
        says = f"{readings.clipped} samples read exactly {limit_dps:.5g} deg/s: the range ends there."
        return warning(says, do, share)
    return ok(f"All rates are inside the range; the largest was {largest_dps:.4g} deg/s.", 0.0)


def impossible(_evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Single readings that cannot be."""
    readings = facts.readings
    if not readings.impossible:
        return None
    first = readings.fields_of("impossible_reading")[0]
    return warning(
        f"{readings.impossible} readings cannot be, such as {first['rate_dps']:.4g} deg/s: it jumped and returned.",
        "They are left out. Check wires and supply of the sensor, and the result of every read in the firmware.",
        readings.impossible / facts.samples,
    )


def temperature(evidence: DeviceEvidence, facts: SessionFacts) -> DeviceFinding | None:
    """Whether the temperature changes."""
    session = facts.session
    if session.temp_c is None:
        return ok("The device sends no temperature.")
    is_valid = np.isfinite(session.temp_c) & np.isfinite(session.t_device_s)
    t_s, temp_c = session.t_device_s[is_valid], session.temp_c[is_valid]
    if len(t_s) < 3 or t_s[-1] <= t_s[0]:
        return None
    slope_c_min = 60.0 * float(np.polyfit(t_s - t_s[0], temp_c, 1)[0])
    minutes = float(t_s[-1] - t_s[0]) / 60.0
    low_c, high_c = (float(value) for value in np.percentile(temp_c, [1.0, 99.0]))
    is_level = abs(slope_c_min) < WARMING_C_MIN or abs(slope_c_min) * minutes < WARMED_C
    if is_level and high_c - low_c < SPAN_C:
        return ok(f"The temperature is steady at {temp_c[-1]:.1f} °C.", slope_c_min, "°C/min")
    return note(
        f"The temperature changes: {_course(temp_c)} within {minutes:.1f} min{_bias_change(evidence, high_c - low_c)}.",
        "The bias changes with it: wait until it is steady before you calibrate, or run calibrate --temperature 20.",
        slope_c_min,
        "°C/min",
    )


def _course(temp_c: Floats) -> str:
    """First, extreme and last temperature, °C: `25.0 to 33.0 °C`, `25.0 to 33.0 to 28.0 °C`."""
    first, last = temp_c[0], temp_c[-1]
    extreme = max(temp_c.min(), temp_c.max(), key=lambda value: min(abs(value - first), abs(value - last)))
    is_turning = min(abs(extreme - first), abs(extreme - last)) >= SPAN_C
    stations = (first, extreme, last) if is_turning else (first, last)
    return " to ".join(f"{value:.1f}" for value in stations) + " °C"


def _bias_change(evidence: DeviceEvidence, span_c: float) -> str:
    per_c = evidence.sensor.zero_rate_dps_c if evidence.sensor else None
    return f", a bias change of up to {per_c * span_c:.2g} deg/s by the data sheet" if per_c else ""


def bias(evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """The bias now, compared with the data sheet."""
    says = f"The bias is {at_rest.bias_dps:+.4f} ± {at_rest.bias_sigma_dps:.4f} deg/s"
    limit_dps = evidence.sensor.zero_rate_dps if evidence.sensor else None
    if evidence.sensor is None or limit_dps is None:
        return ok(f"{says}.", at_rest.bias_dps, "deg/s")
    allowed = f"the {evidence.sensor.name} may have ±{limit_dps:g}"
    if abs(at_rest.bias_dps) > limit_dps:
        return warning(
            f"{says}; {allowed}.",
            "If it stood still, it is damaged, badly supplied, or its counts are scaled wrongly.",
            at_rest.bias_dps,
            "deg/s",
        )
    return ok(f"{says}; {allowed}.", at_rest.bias_dps, "deg/s")


def bias_moves(_evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """Whether the bias is constant."""
    if len(at_rest.rate_dps) < 40:
        return None
    quarter = len(at_rest.rate_dps) // 4
    moved_dps = float(at_rest.rate_dps[-quarter:].mean() - at_rest.rate_dps[:quarter].mean())
    sigma_dps = at_rest.noise_dps_rthz * np.sqrt(8.0 / at_rest.seconds)
    if abs(moved_dps) < max(MOVED_SIGMAS * sigma_dps, MOVED_DPS):
        return ok(f"The bias is constant within {at_rest.seconds:.0f} s of rest.", moved_dps, "deg/s")
    return note(
        f"The bias moved by {moved_dps:+.3f} deg/s within {at_rest.seconds:.0f} s.",
        "Let it warm up. A start calibration soon gets outdated; a filter that uses rests does not.",
        moved_dps,
        "deg/s",
    )


CHECKS = (*checks_of(facts_of, sensor, still, clipped, impossible, temperature), *checks_of(rest_of, bias, bias_moves))
