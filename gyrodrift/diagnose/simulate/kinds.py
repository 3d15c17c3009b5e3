"""Records of the effects as candidate causes, in the order in which they are tried."""

import numpy as np

from gyrodrift.diagnose.simulate.candidate import Need, Touches
from gyrodrift.diagnose.simulate.candidate_kind import CandidateKind, Hints, SizeGrid, Variant
from gyrodrift.diagnose.simulate.grids import (
    also_with,
    between,
    hinted,
    linear,
    linear_grid,
    once_per_turn,
    one_of,
    read_off,
    simulated,
    simulated_and_shown,
    simulated_grid,
    simulated_within,
)

WARMUP_TAUS_S, SLOW_TAUS_S = (20.0, 35.0, 60.0, 100.0, 160.0, 260.0, 450.0), (100.0, 160.0, 260.0)
"""Time constants of warm-ups, s. Chosen: from seconds of a die to minutes of a package, by factors of about 1.7."""

WARMUPS = [
    *({"time_constant_s": tau_s} for tau_s in WARMUP_TAUS_S),
    *({"time_constant_s": tau_s, "fast_share": 0.35, "fast_time_constant_s": tau_s / 5.0} for tau_s in SLOW_TAUS_S),
]
"""Second parameters of `warmup`: one exponential, or two. Chosen: 35 % with the time constant of the die, and the rest
with that of the package, which is five times longer."""

CURVES: tuple[dict[str, float], ...] = ({}, {"curve_per_c": -0.01}, {"curve_per_c": 0.01})
"""Second parameters of `temp_bias`: a line, and curves. Chosen: 10 % off the line at a distance of 10 °C from 25 °C."""

MOST_CURVE = 0.5
"""Bound of `curve_per_c`, 1/°C. Derived: that of the effect in the simulator."""

CUTOFFS_HZ, ORDERS = (60.0, 30.0, 15.0, 7.0, 3.0, 1.2, 0.5), (1, 2)
"""Cutoffs and orders of the low-passes that are simulated. Chosen: factors of about two, from above the motion of
tables to far below it."""

LEAST_SPREAD_PERCENT = 5.0
"""Minimum spread of ticks that is simulated. Chosen: for a tick of 50 ms it is as large as usual host jitter."""

LEAST_HANDOVER = 0.06
"""Minimum distance of samples in a bunch that is simulated, in sample periods. Derived: relevance threshold of arrival
gaps."""

REALISATIONS = 12
"""Random draws for each size of an effect whose simulation takes milliseconds. Chosen: about fifty in all sessions
together."""

LAG = "lag"
"""Group of effects and out-of-catalog models that delay the rate."""


def _time_constant_s(cutoff_hz: float) -> float:
    """Time constant of a low-pass, which is its size; the same formula turns the size into the cutoff."""
    return 1.0 / (2.0 * np.pi * cutoff_hz)


def _low_passes(_: Hints) -> list[Variant]:
    """One variant per order; the size is the time constant, so that size 0 means no low-pass."""
    points = 1.0 / (2.0 * np.pi * np.array(CUTOFFS_HZ))
    grid = SizeGrid(points, between(points[0], points[-1]))
    return [Variant(grid, {"order": order}) for order in ORDERS]


def _coarser_dps(hints: Hints) -> float:
    """Step of the rate that the recordings show, at least that of the rig, deg/s."""
    return max(hints.rate_step_dps, hints.dps_per_lsb)


def _bunches_ms(hints: Hints) -> float:
    """Interval of bunches that the recordings show, ms.

    It is simulated, not interpolated: quantiles of arrival gaps jump where one more sample fits into a bunch.
    """
    return 1e3 * hints.bunch_s


def _uneven_bunches(hints: Hints) -> dict[str, float]:
    """Spread and handover of bunches, if the recordings show relevant values; empty for even ticks."""
    shown = {"spread_percent": 100.0 * min(hints.bunch_spread, 1.0), "handover_ms": 1e3 * hints.handover_s}
    least = {"spread_percent": LEAST_SPREAD_PERCENT, "handover_ms": LEAST_HANDOVER * 1e3 * hints.sample_period_s}
    return {name: value for name, value in shown.items() if value >= least[name]}


def _shown_curves(hints: Hints) -> list[dict[str, float]]:
    """Curve that a temperature sweep shows, limited to the bounds of the effect; empty without a sweep."""
    return [{"curve_per_c": max(-MOST_CURVE, min(hints.curve_per_c, MOST_CURVE))}] if hints.curve_per_c else []


def _counts_per_turn(step_deg: float) -> int:
    return max(1, round(360.0 / step_deg))


# fmt: off
EFFECTS = (
    # Linear effects: two simulations give all sizes.
    CandidateKind(
        "scale_factor", "error_percent", linear(0.01, 10.0),
        "scale", (Need.MOTION,), Touches.SLOW_RATE, is_exact=True, matters_from=0.06,
    ),
    CandidateKind(
        "scale_asymmetry", "error_percent", linear(0.005, 5.0),
        "even in rate", (Need.MOTION,), Touches.SLOW_RATE, is_exact=True, matters_from=0.03,
    ),
    CandidateKind(
        "nonlinearity", "error_percent_fs", linear(0.003, 3.0),
        None, (Need.MOTION,), Touches.SLOW_RATE, matters_from=0.02,
    ),
    CandidateKind(
        "vibration_rectification", "bias_dps_at_100_dps", linear(0.002, 2.0),
        "even in rate", (Need.MOTION,), Touches.SLOW_RATE, matters_from=0.006,
    ),
    CandidateKind(
        "temp_bias", "slope_dps_per_c", one_of(linear_grid(0.0005, 0.5), CURVES, _shown_curves),
        "slow bias", (Need.TEMPERATURE,), Touches.SLOW_RATE, matters_from=0.0012,
    ),
    CandidateKind(
        "temp_scale", "slope_percent_per_c", linear(0.0005, 0.5),
        None, (Need.MOTION, Need.TEMPERATURE), Touches.SLOW_RATE, matters_from=0.006,
    ),
    CandidateKind(
        "warmup", "amplitude_dps", one_of(linear_grid(0.003, 3.0), WARMUPS),
        "slow bias", (), Touches.SLOW_RATE, matters_from=0.012,
    ),
    CandidateKind(
        "clock_drift", "ppm", linear(10.0, 50000.0),
        "clock", (Need.HOST,), Touches.TIMES, is_exact=True, matters_from=30.0,
    ),
    CandidateKind(
        "g_sensitivity", "amplitude_dps", once_per_turn(0.001, 1.0),
        "once per turn", (Need.MOTION,), Touches.SLOW_RATE, is_exact=True, matters_from=0.004,
    ),
    CandidateKind(
        "encoder_eccentricity", "amplitude_deg", once_per_turn(0.005, 5.0),
        "once per turn", (Need.MOTION,), Touches.VALUES, is_exact=True, matters_from=0.02,
    ),
    # Effects on values, delays and times: every size of the grid is simulated.
    CandidateKind(
        "misalignment", "tilt_deg",
        hinted("about_deg", lambda hints: hints.lean_deg - 90.0, 1.5, 3.0, 5.0, 8.0, 12.0, 17.0, 23.0, 30.0),
        "scale", (Need.MOTION, Need.AXES), Touches.VALUES, is_exact=True, matters_from=2.0,
        acts_like="scale_factor",
    ),
    CandidateKind(
        "deadband", "width_dps", read_off(lambda hints: hints.least_dps),
        "coarse values", (Need.MOTION,), Touches.VALUES, is_read_off=True,
    ),
    CandidateKind(
        "quantization", "step_dps", read_off(_coarser_dps),
        "coarse values", (), Touches.VALUES, is_read_off=True,
    ),
    CandidateKind(
        "saturation", "limit_dps", read_off(lambda hints: hints.largest_dps),
        None, (Need.MOTION,), Touches.VALUES, is_exact=True, less_is_more=True, is_read_off=True,
    ),
    CandidateKind(
        "bandwidth", "cutoff_hz", _low_passes,
        LAG, (Need.MOTION,), Touches.VALUES, of_size=_time_constant_s, less_is_more=True,
    ),
    CandidateKind(
        "latency", "delay_ms", simulated(0.3, 2.0, 8.0, 20.0, 50.0, 120.0, 400.0),
        LAG, (Need.MOTION,), Touches.VALUES, matters_from=1.0,
    ),
    CandidateKind(
        "backlash", "play_deg", simulated(0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0),
        "reversal", (Need.MOTION,), Touches.VALUES, matters_from=0.03,
    ),
    CandidateKind(
        "timestamp_jitter", "sigma_ms", simulated_within(0.4, 0.02, 0.06, 0.2, 0.6, 2.0, 5.0),
        "times", (), Touches.TIMES, matters_from=0.06,
    ),
    CandidateKind(
        "usb_batching", "interval_ms",
        also_with(
            simulated_and_shown(_bunches_ms, 1.5, 3.0, 5.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 100.0, 250.0),
            _uneven_bunches,
        ),
        "times", (Need.HOST,), Touches.TIMES, matters_from=2.0,
    ),
    CandidateKind(
        "sample_drop", "share_percent", simulated(0.01, 0.1, 1.0, 4.0, 16.0, 40.0),
        None, (Need.COUNTER,), realisations=2, matters_from=0.02,
    ),
    CandidateKind(
        "stale_hold", "share_percent", simulated(0.02, 0.2, 2.0, 8.0, 30.0, 50.0),
        "coarse values", (Need.MOTION,), Touches.VALUES, realisations=2, matters_from=0.05,
    ),
    # Random effects, tones, and the steps of the encoder.
    CandidateKind(
        "bias_instability", "floor_dph", simulated(3.0, 50.0, 1000.0),
        "stochastic bias", (), Touches.RATE, realisations=REALISATIONS, matters_from=3.0,
    ),
    CandidateKind(
        "rate_random_walk", "density_dps_rts", simulated(0.0002, 0.005, 0.1),
        "stochastic bias", (), Touches.SLOW_RATE, realisations=REALISATIONS, matters_from=0.0003,
    ),
    CandidateKind(
        "popcorn", "step_dps",
        one_of(simulated_grid(0.01, 0.2, 5.0), [{"dwell_s": dwell_s} for dwell_s in (8.0, 25.0, 80.0)]),
        "stochastic bias", (), Touches.SLOW_RATE, realisations=REALISATIONS, matters_from=0.01,
    ),
    CandidateKind(
        "spikes", "share_percent",
        hinted("height_dps", lambda hints: hints.spike_dps, 0.003, 0.02, 0.07, 0.3, 2.0),
        "outliers", (), Touches.VALUES, realisations=3, is_read_off=True,
    ),
    CandidateKind(
        "encoder_slip", "per_hour", hinted("step_deg", lambda hints: hints.slip_deg, 6.0, 30.0, 120.0, 600.0),
        "outliers", (Need.MOTION,), Touches.VALUES, realisations=3, is_read_off=True,
    ),
    CandidateKind(
        "vibration", "amplitude_dps",
        hinted("frequency_hz", lambda hints: hints.line_hz, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 20.0),
        None, (), Touches.VALUES, matters_from=0.02,
    ),
    CandidateKind(
        "encoder_quantization", "cpr", read_off(lambda hints: hints.angle_step_deg),
        None, (Need.MOTION,), Touches.VALUES, of_size=_counts_per_turn, less_is_more=True, is_read_off=True,
        realisations=4,  # which counts a motion passes is random
    ),
)
# fmt: on
