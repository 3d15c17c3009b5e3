"""Cases: a bench, flaws of its "real" side, and which effects are right answers."""

from collections.abc import Mapping
from dataclasses import dataclass

from simulators import flaws
from simulators.flaws import Flaw


@dataclass(frozen=True, slots=True)
class SimulatorCase:
    """A gap between two sets of sessions of one simulator.

    dynamics, readout
        Flaws before and after the noise.
    effect
        The effect of the catalog that the flaw is; empty without a gap.
    real_noise, sim_noise
        White noise, deg/s/√Hz; a simulator may have none.
    has_host
        Whether both sides have arrival times; `sim_has_host` whether the simulator has them.
    """

    bench: str
    effect: str = ""
    dynamics: tuple[Flaw, ...] = ()
    readout: tuple[Flaw, ...] = ()
    real_noise: float = 0.006
    sim_noise: float = 0.006
    has_host: bool = False
    sim_has_host: bool = False


def _of_rate(bench: str, effect: str, *readout: Flaw) -> SimulatorCase:
    return SimulatorCase(bench, effect, (), readout)


def _of_motion(bench: str, effect: str, *dynamics: Flaw) -> SimulatorCase:
    return SimulatorCase(bench, effect, dynamics)


def _of_link(bench: str, effect: str, *readout: Flaw) -> SimulatorCase:
    return SimulatorCase(bench, effect, (), readout, has_host=True, sim_has_host=True)


CASES: Mapping[str, SimulatorCase] = {
    "gain": _of_rate("rover", "scale_factor", flaws.gain(-2.0)),
    "gain, Bullet": _of_rate("bullet", "scale_factor", flaws.gain(0.8)),
    "direction": _of_rate("rover", "scale_asymmetry", flaws.direction_gain(-0.8)),
    "compression": _of_rate("turntable", "nonlinearity", flaws.compression(0.01)),
    "square": _of_rate("bullet", "vibration_rectification", flaws.square(0.25)),
    "tilt bias": _of_rate("turntable", "g_sensitivity", flaws.tilt_bias(0.15)),
    "suppression": _of_rate("rover", "deadband", flaws.suppression(0.6)),
    "steps": _of_rate("turntable", "quantization", flaws.steps(0.25)),
    "limit": _of_rate("bullet", "saturation", flaws.limit(125.0)),
    "late": _of_motion("turntable", "latency", flaws.late(0.03)),
    "one pole": _of_motion("turntable", "bandwidth", flaws.one_pole(4.0)),
    "walk": _of_rate("rover", "rate_random_walk", flaws.bias_walk(0.02)),
    "flicker": _of_rate("turntable", "bias_instability", flaws.flicker(300.0)),
    "two levels": _of_rate("bullet", "popcorn", flaws.two_levels(0.4, 15.0)),
    "warm-up": _of_rate("rover", "warmup", flaws.warm_up(0.6, 50.0)),
    "hum": _of_rate("turntable", "vibration", flaws.hum(0.5, 23.0)),
    "glitches": _of_rate("rover", "spikes", flaws.glitches(40.0, 0.2)),
    "repeats": _of_rate("turntable", "stale_hold", flaws.repeats(4.0)),
    "off center": _of_rate("turntable", "encoder_eccentricity", flaws.off_center(0.6)),
    "gear play": _of_rate("turntable", "backlash", flaws.gear_play(0.4)),
    "slips": _of_rate("bullet", "encoder_slip", flaws.slips(2.0, 40.0)),
    "fast clock": _of_link("turntable", "clock_drift", flaws.fast_clock(6000.0)),
    "shaky stamps": _of_rate("rover", "timestamp_jitter", flaws.shaky_stamps(1.5)),
    "polled bus": _of_link("bullet", "usb_batching", flaws.polled(40.0)),
    "nothing, turntable": SimulatorCase("turntable"),
    "nothing, rover": SimulatorCase("rover"),
    "nothing, Bullet": SimulatorCase("bullet"),
    "nothing, ideal simulator": SimulatorCase("turntable", sim_noise=0.0),
    "nothing, both ideal": SimulatorCase("bullet", real_noise=0.0, sim_noise=0.0),
    "nothing, arrivals of one side": SimulatorCase("rover", has_host=True),
}

LOOPED = (
    "gain", "direction", "compression", "square", "steps", "late", "two levels", "warm-up", "hum", "repeats",
)  # fmt: skip
"""Cases whose exported effects are put back into the simulator."""
