"""The rig's effects as candidate causes: in which sizes each is tried, and which of them look alike."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.design_matrix import COLUMNS
from gyrodrift.diagnose.simulate import nuisance as strangers

GROUPS: Mapping[str, str] = {
    "scale_factor": "scale",
    "clock_drift": "clock",
    "temp_bias": "slow bias",
    "warmup": "slow bias",
    "rate_random_walk": "stochastic bias",
    "bias_instability": "stochastic bias",
    "popcorn": "stochastic bias",
    "bandwidth": "lag",
    "latency": "lag",
    "scale_asymmetry": "even in rate",
    "vibration_rectification": "even in rate",
    "g_sensitivity": "once per turn",
    "encoder_eccentricity": "once per turn",
    "timestamp_jitter": "times",
    "usb_batching": "times",
    "deadband": "coarse values",
    "quantization": "coarse values",
    "stale_hold": "coarse values",
    "spikes": "outliers",
    "encoder_slip": "outliers",
    "backlash": "reversal",
}
"""Effects that are easily taken for each other; every other effect is a group of its own."""

NEEDS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(
        (
            "scale_factor",
            "scale_asymmetry",
            "nonlinearity",
            "vibration_rectification",
            "g_sensitivity",
            "encoder_eccentricity",
            "encoder_quantization",
            "encoder_slip",
            "backlash",
            "bandwidth",
            "latency",
            "saturation",
            "deadband",
            "stale_hold",
        ),
        ("motion",),
    ),
    "temp_bias": ("temperature",),
    "temp_scale": ("motion", "temperature"),
    "clock_drift": ("host",),
    "usb_batching": ("host",),
    "sample_drop": ("counter",),
}
"""What recordings have to hold for an effect to show in them: motion, temperature, host times, a counter."""

PHASES_DEG = tuple(30.0 * step for step in range(12))
WARMUP_TAUS_S = (20.0, 35.0, 60.0, 100.0, 160.0, 260.0, 450.0)
NOISE_SHARES = (1.0, 0.75, 0.6, 0.47, 0.37, 0.28, 0.2)
"""Coarse steps scatter by themselves: how much noise there is beneath them is tried out."""

PER_DECADE = 12
"""Sizes between which a fit decides, to a decade: steps of a fifth."""


@dataclass(frozen=True, slots=True)
class Hints:
    """What the recordings themselves show of a candidate's second parameter, the middle over all of them.

    line_hz, spike_dps, slip_deg
        The strongest tone at rest, heights of wild samples and of jumps of the angle.
    rate_step_dps, angle_step_deg
        The steps that rates and angles come in.
    least_dps, largest_dps
        Rates other than zero that the device put out.
    swing_s, ripple_order, angle_ripple_order
        Of what is left of the rate: the clearest period in time, and parts of a turn.
    """

    line_hz: float
    spike_dps: float
    slip_deg: float
    rate_step_dps: float
    angle_step_deg: float
    least_dps: float
    largest_dps: float
    swing_s: float
    ripple_order: int
    angle_ripple_order: int


@dataclass(frozen=True, slots=True)
class Candidate:
    """An effect with its second parameter fixed, tried at some sizes.

    make
        The effect of a size.
    parameter
        Which parameter is the size.
    nodes
        Sizes that are simulated, rising; 0 stands for none, and sizes in between are interpolated.
    sizes
        Those that a fit decides between.
    dice
        How many runs a size takes: one where chance plays no part.
    phase_deg
        Of an effect once per turn; only those of 0 and 90 degrees are simulated.
    noise_share
        What share of the scatter that the recording shows was there before this effect changed it.
    shape
        Of what is no effect of the catalogue: what is added to the rate.
    """

    name: str
    variant: str
    make: Callable[[float], Effect]
    parameter: str
    nodes: Floats
    sizes: Floats
    dice: int = 1
    phase_deg: float | None = None
    noise_share: float = 1.0
    shape: strangers.Shape | None = None

    @property
    def group(self) -> str:
        """Which effects it looks like."""
        return GROUPS.get(self.name, self.name)

    @property
    def needs(self) -> tuple[str, ...]:
        """What a recording has to hold for it."""
        return NEEDS.get(self.name, ())

    @property
    def stage(self) -> str:
        """Of the rig."""
        return CATALOGUE[self.name].stage

    @property
    def is_strange(self) -> bool:
        """Whether it is no effect of the catalogue."""
        return self.shape is not None


def candidates(hints: Hints) -> list[Candidate]:
    """All of them; turned ones (`phase`) are not simulated but composed, see `responses`."""
    found = [
        _signed("scale_factor", "error_percent", 10.0, 0.01),
        _signed("scale_asymmetry", "error_percent", 5.0, 0.005),
        _signed("nonlinearity", "error_percent_fs", 3.0, 0.003),
        _signed("vibration_rectification", "bias_dps_at_100_dps", 2.0, 0.002),
        _signed("temp_bias", "slope_dps_per_c", 0.5, 0.0005),
        _signed("temp_scale", "slope_percent_per_c", 0.5, 0.0005),
        *(_signed("warmup", "amplitude_dps", 3.0, 0.003, time_constant_s=tau_s) for tau_s in WARMUP_TAUS_S),
        _signed("clock_drift", "ppm", 50000.0, 10.0),
        *(_turned("g_sensitivity", "amplitude_dps", 1.0, 0.001, phase_deg) for phase_deg in PHASES_DEG),
        *(_turned("encoder_eccentricity", "amplitude_deg", 5.0, 0.005, phase_deg) for phase_deg in PHASES_DEG),
        _seen("deadband", "width_dps", hints.least_dps),
        *(_seen("quantization", "step_dps", hints.rate_step_dps, share) for share in NOISE_SHARES),
        _seen("saturation", "limit_dps", hints.largest_dps),
        *(_bandwidth(share) for share in (1.0, 2.0)),
        _sized("latency", "delay_ms", (0.3, 2.0, 8.0, 20.0, 50.0)),
        _sized("backlash", "play_deg", (0.01, 0.03, 0.1, 0.3, 1.0)),
        _sized("timestamp_jitter", "sigma_ms", (0.02, 0.06, 0.2, 0.6, 2.0, 5.0)),
        _sized("usb_batching", "interval_ms", (1.5, 3.0, 5.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 100.0)),
        _sized("sample_drop", "share_percent", (0.01, 0.1, 1.0, 5.0), dice=2),
        _sized("stale_hold", "share_percent", (0.02, 0.2, 2.0, 10.0), dice=2),
        _sized("bias_instability", "floor_dph", (3.0, 12.0, 50.0, 200.0), dice=4),
        _sized("rate_random_walk", "density_dps_rts", (0.0002, 0.001, 0.005, 0.02), dice=4),
        *(_sized("popcorn", "step_dps", (0.01, 0.1, 1.0), dice=4, dwell_s=dwell_s) for dwell_s in (8.0, 25.0, 80.0)),
        _sized("spikes", "share_percent", (0.003, 0.03, 0.3, 2.0), dice=2, height_dps=hints.spike_dps),
        _sized("encoder_slip", "per_hour", (6.0, 30.0, 120.0), dice=2, step_deg=hints.slip_deg),
        _sized("vibration", "amplitude_dps", (0.01, 0.03, 0.1, 0.3, 1.0, 3.0), frequency_hz=hints.line_hz),
    ]
    return [*found, _encoder_quantization(hints.angle_step_deg), *_strangers(hints)]


def _strangers(hints: Hints) -> Iterator[Candidate]:
    """Of regressors the size is in multiples of what does not matter."""
    for column in COLUMNS:
        if not column.in_catalogue:
            up = column.threshold * _between(3.0, 3000.0)
            sizes = np.concatenate([-up[::-1], up])
            shape = strangers.regressor(column.name)
            nodes = column.threshold * np.array([-100.0, 100.0])
            yield Candidate(f"?{column.name}", "", _no_effect, "size", nodes, sizes, shape=shape)
    periodic = {
        "?swing": strangers.swing(hints.swing_s),
        "?ripple": strangers.ripple(hints.ripple_order),
        "?angle_ripple": strangers.angle_ripple(hints.angle_ripple_order),
    }
    for name, shape in periodic.items():
        nodes = np.array([0.003, 0.01, 0.03, 0.1, 0.3])
        yield Candidate(name, "", _no_effect, "size", nodes, _between(0.003, 0.3), dice=4, shape=shape)


def _no_effect(_: float) -> Effect:
    raise LookupError("no effect of the catalogue does this")


def _effect(name: str, parameter: str, fixed: Mapping[str, float]) -> Callable[[float], Effect]:
    return lambda size: _made(name, {parameter: size, **fixed})


def _made(name: str, parameters: Mapping[str, float]) -> Effect:
    return CATALOGUE[name].model_validate({"name": name, **parameters})


def _variant(fixed: Mapping[str, float]) -> str:
    return ", ".join(f"{name} {value:.4g}" for name, value in fixed.items())


def _signed(name: str, parameter: str, most: float, least: float, **fixed: float) -> Candidate:
    """Exactly linear in its size: two runs say all."""
    up = _between(least, most)
    sizes = np.concatenate([-up[::-1], up])
    return Candidate(
        name,
        _variant(fixed),
        _effect(name, parameter, fixed),
        parameter,
        np.array([-most, most]) / 10.0,
        sizes,
    )


def _turned(name: str, parameter: str, most: float, least: float, phase_deg: float) -> Candidate:
    """Linear, once per turn: the runs at 0 and 90 degrees are turned to every other phase."""
    fixed = {"phase_deg": phase_deg}
    nodes = np.array([most / 10.0])
    sizes = _between(least, most)
    make = _effect(name, parameter, fixed)
    return Candidate(name, _variant(fixed), make, parameter, nodes, sizes, phase_deg=phase_deg)


def _sized(name: str, parameter: str, nodes: tuple[float, ...], dice: int = 1, **fixed: float) -> Candidate:
    sizes = _between(nodes[0], nodes[-1])
    make = _effect(name, parameter, fixed)
    return Candidate(name, _variant(fixed), make, parameter, np.array(nodes), sizes, dice)


def _bandwidth(noise_share: float) -> Candidate:
    """Its size is the time constant, so that 0 is none."""
    cutoffs_hz = np.array([60.0, 35.0, 20.0, 12.0, 7.0, 4.0, 2.5] if noise_share == 1.0 else [15.0, 7.0, 3.0])

    def make(tau_s: float) -> Effect:
        return _made("bandwidth", {"cutoff_hz": 1.0 / (2.0 * np.pi * tau_s)})

    nodes = 1.0 / (2.0 * np.pi * cutoffs_hz)
    sizes = _between(nodes[0], nodes[-1])
    return Candidate("bandwidth", _noise(noise_share), make, "cutoff_hz", nodes, sizes, noise_share=noise_share)


def _noise(share: float) -> str:
    return f"noise times {share:g}" if share != 1.0 else ""


def _seen(name: str, parameter: str, size: float, noise_share: float = 1.0) -> Candidate:
    """Of an effect whose size the recordings show outright."""
    make, sizes = _effect(name, parameter, {}), np.array([size])
    return Candidate(name, _noise(noise_share), make, parameter, sizes, sizes, noise_share=noise_share)


def _encoder_quantization(step_deg: float) -> Candidate:
    """Its size is the step of the angle, which the recordings show."""

    def make(size_deg: float) -> Effect:
        return _made("encoder_quantization", {"cpr": max(1, round(360.0 / size_deg))})

    sizes = np.array([step_deg])
    return Candidate("encoder_quantization", "", make, "cpr", sizes, sizes)


def _between(least: float, most: float) -> Floats:
    return np.geomspace(least, most, round(PER_DECADE * np.log10(most / least)) + 1)
