"""Checks of the noise at rest: white noise, bias instability, resolution, and tones that may be aliased."""

from math import sqrt

import numpy as np

from gyrodrift.doctor.evidence import DeviceEvidence, checks_of, rest_of
from gyrodrift.doctor.finding import DeviceFinding, note, ok, warning
from gyrodrift.facts.session_facts import StillRate
from gyrodrift.facts.spectrum import RestSpectrum
from gyrodrift.values.noise import FLICKER_WORDS, hourly_rate_text, random_walk_text

NOISY, AVERAGED = 2.0, 0.4
"""Measured noise density over the data sheet: above, something shakes the sensor; below, something averages."""

COARSE = 1.0
"""Step over noise above which the noise no longer dithers the step."""

FLAT = 0.5
"""Share of the noise that is left next to half the sample rate, below which a low-pass is at work."""

LONG_S = 600
"""Rest in which the Allan deviation of a cheap gyro reaches its minimum, s."""


def noise(evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """White noise, compared with the data sheet."""
    density = sqrt(2.0) * at_rest.noise_dps_rthz  # data sheets state one-sided densities
    says = f"White noise at rest: {random_walk_text(at_rest.noise_dps_rthz)} angle random walk, {density:.2g} deg/s/√Hz"
    if evidence.sensor is None:
        return ok(f"{says}.", density, "deg/s/√Hz")
    ratio = density / evidence.sensor.noise_dps_rthz
    compared = f"{says}, {ratio:.2g} times the {evidence.sensor.noise_dps_rthz:g} of the {evidence.sensor.name}"
    if ratio > NOISY:
        return warning(
            f"{compared}.",
            f"Mount it on foam, decouple its supply, and set its low-pass ({evidence.sensor.bandwidth_by}) below half "
            "the sample rate.",
            density,
            "deg/s/√Hz",
        )
    if ratio < AVERAGED:
        return note(f"{compared}: something averages.", "A low-pass or a mean delays the rate.", density, "deg/s/√Hz")
    return ok(f"{compared}.", density, "deg/s/√Hz")


def bias_instability(evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """Flicker noise of the bias, compared with the data sheet."""
    in_run_dps = evidence.sensor.in_run_dps if evidence.sensor else None
    sheet = f" The data sheet states {hourly_rate_text(in_run_dps)}." if in_run_dps else ""
    if at_rest.instability_dps is not None:
        says = f"Bias instability: {hourly_rate_text(at_rest.instability_dps)}, {FLICKER_WORDS}."
        return ok(f"{says}{sheet}", at_rest.instability_dps, "deg/s")
    longer = f"--duration {LONG_S}" if evidence.recording is None else f"A recording of {LONG_S} s"
    return ok(
        f"Bias instability: not visible in {at_rest.seconds:.0f} s of rest.{sheet}",
        do=f"{longer} at rest shows it." if at_rest.seconds < LONG_S else "",
    )


def resolution(evidence: DeviceEvidence, at_rest: StillRate) -> DeviceFinding | None:
    """Step of the rate, compared with its noise."""
    step_dps = evidence.step_dps
    if evidence.facts is None or not step_dps:
        return None
    says = f"The step of the rate is {step_dps:.3g} deg/s"
    if step_dps > COARSE * at_rest.std_dps:
        return warning(
            f"{says}, larger than its noise of {at_rest.std_dps:.2g} deg/s: a bias below one step is invisible.",
            "Choose a finer range, print more digits, or send counts.",
            step_dps,
            "deg/s",
        )
    fastest_dps = float(np.abs(evidence.facts.session.rate_dps).max())
    finer = [scale for scale, lsb in evidence.sensor.ranges if 1.0 / lsb < 0.9 * step_dps] if evidence.sensor else []
    if finer and step_dps > 0.5 * at_rest.std_dps:
        return note(
            f"{says}, about as large as its noise; the fastest turn was {fastest_dps:.3g} deg/s.",
            f"Choose ±{min(finer)} deg/s if you never turn faster: that range is finer.",
            step_dps,
            "deg/s",
        )
    return ok(f"{says}, smaller than its noise of {at_rest.std_dps:.2g} deg/s.", step_dps, "deg/s")


def _spectrum(evidence: DeviceEvidence) -> RestSpectrum | None:
    return evidence.facts.spectrum if evidence.facts is not None and evidence.is_in_deg_s else None


def aliasing(evidence: DeviceEvidence, spectrum: RestSpectrum) -> DeviceFinding | None:
    """A tone at rest, and whether it may be an alias."""
    rate_hz, is_flat = evidence.link.rate_hz, spectrum.upper_share > FLAT
    if spectrum.tone_hz is None or spectrum.tone_dps is None:
        low_pass = "No low-pass acts" if is_flat else "A low-pass acts"
        return ok(f"No vibration. {low_pass} below {rate_hz / 2.0:.4g} Hz.", spectrum.upper_share)
    tone = f"A tone of {spectrum.tone_hz:.3g} Hz with {spectrum.tone_dps:.2g} deg/s at rest"
    mount = "Mount the sensor on foam, away from motors and fans"
    if not is_flat:
        return note(f"{tone}: vibration.", f"{mount}.", spectrum.tone_hz, "Hz")
    aliases = ", ".join(f"{hz:.3g}" for hz in (rate_hz - spectrum.tone_hz, rate_hz + spectrum.tone_hz))
    setting = evidence.sensor.bandwidth_by if evidence.sensor else "see its data sheet"
    return warning(
        f"{tone}. No low-pass acts below {rate_hz / 2.0:.4g} Hz, so it may be an alias of {aliases} Hz or more.",
        f"Set the low-pass of the sensor below {rate_hz / 2.0:.4g} Hz ({setting}), or sample faster. {mount}.",
        spectrum.tone_hz,
        "Hz",
    )


CHECKS = (*checks_of(rest_of, noise, bias_instability, resolution), *checks_of(_spectrum, aliasing))
