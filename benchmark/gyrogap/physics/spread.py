"""Devices as people own them: encoders from a motor's 512 counts to 65 536, gyros from very quiet to noisy."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log

import numpy as np

from gyrogap.physics.device import DrawnDevice, RigFile
from gyrogap.physics.dice import Rng
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.sizes import draw_fault

COUNTS = (512, 1024, 2048, 4096, 8192, 16384, 36000, 65536)
STEPS_DPS = (0.0076, 0.0152, 0.0305, 0.061)
"""±250 to ±2000 deg/s over 16 bits."""
RATES_HZ = (50, 100, 200, 400)
NOISES_DPS_RTHZ = (0.0015, 0.02)
JITTERS_S = (0.00003, 0.0006)
LOW_PASS_HZ = 45.0
WITH_LOW_PASS = 0.3


@dataclass(frozen=True, slots=True)
class DeviceFacts:
    """Figures of the data sheet of a device; the rig file holds all of them."""

    sample_hz: int
    dps_per_lsb: float
    noise_dps_rthz: float
    encoder_cpr: int
    encoder_absolute: bool
    host_jitter_s: float


def log_uniform(rng: Rng, low: float, high: float) -> float:
    """Every octave is as likely."""
    return exp(rng.uniform(log(low), log(high)))


def draw_facts(rng: Rng, rates_hz: Sequence[int] = RATES_HZ) -> DeviceFacts:
    """Any combination of them."""
    return DeviceFacts(
        sample_hz=int(rng.choice(rates_hz)),
        dps_per_lsb=float(rng.choice(STEPS_DPS)),
        noise_dps_rthz=float(f"{log_uniform(rng, *NOISES_DPS_RTHZ):.3g}"),
        encoder_cpr=int(rng.choice(COUNTS)),
        encoder_absolute=bool(rng.random() < 0.5),
        host_jitter_s=round(log_uniform(rng, *JITTERS_S), 6),
    )


def draw_spread(rng: Rng, facts: DeviceFacts, sessions: int) -> tuple[DrawnDevice, RigFile]:
    """A device of these facts and its rig, which knows noise, bias, rate and delay roughly."""
    low_pass_hz = LOW_PASS_HZ if rng.random() < WITH_LOW_PASS else 0.0
    rig = RigFile(
        noise_dps_rthz=facts.noise_dps_rthz,
        bias_dps=round(rng.uniform(-0.6, 0.6), 3),
        host_delay_s=0.002,
        sample_rate_hz=facts.sample_hz,
        encoder_absolute=facts.encoder_absolute,
        effects=(InjectedEffect("bandwidth", {"cutoff_hz": low_pass_hz}),) if low_pass_hz else (),
    )
    device = DrawnDevice(
        sample_hz=round(facts.sample_hz * rng.uniform(0.988, 1.012), 3),
        dps_per_lsb=facts.dps_per_lsb,
        noise_dps_rthz=facts.noise_dps_rthz * rng.uniform(0.8, 1.3),
        bias_dps=draw_biases(rng, rig.bias_dps, sessions),
        encoder_cpr=facts.encoder_cpr,
        host_delay_s=rng.uniform(0.001, 0.008),
        host_scatter_s=facts.host_jitter_s,
        stamp_scatter_s=2e-6,
        clock_ppm=rng.uniform(-3.0, 3.0),
        encoder_absolute=facts.encoder_absolute,
        low_pass_hz=low_pass_hz,
    )
    return device, rig


def draw_biases(rng: Rng, about_dps: float, sessions: int) -> tuple[float, ...]:
    """One for each time that the device is switched on."""
    drawn = about_dps + rng.normal(0.0, 0.3) + rng.uniform(0.05, 0.5) * rng.standard_normal(sessions)
    return tuple(np.round(drawn, 4).tolist())


def draw_fault_for(
    rng: Rng, facts: DeviceFacts, name: str, size: str, way: float | None = None, strength: float | None = None
) -> InjectedEffect:
    """An effect of the catalogue on such a device: coarser steps are coarser than those that the device has."""
    fault = draw_fault(rng, name, size, way, strength)
    parameters = dict(fault.parameters)
    if name == "quantization":
        parameters["step_dps"] = max(parameters["step_dps"], 2.5 * facts.dps_per_lsb)
    if name == "encoder_quantization":
        parameters["cpr"] = min(parameters["cpr"], round(0.4 * facts.encoder_cpr))
    return InjectedEffect(name, parameters)
