"""Effects on values, delays and times, which are simulated size by size."""

import numpy as np

from gyrodrift.diagnose.simulate.candidate import CandidateKind, Hints, Need, SizeGrid, Touches, Variant
from gyrodrift.diagnose.simulate.grids import between, read_off, simulated, simulated_and_shown, simulated_within
from gyrodrift.diagnose.simulate.kinds.groups import COARSE_VALUES, LAG, REVERSAL, TIMES

CUTOFFS_HZ, ORDERS = (60.0, 35.0, 20.0, 12.0, 7.0, 4.0, 2.5, 1.2), (1, 2)
"""Of low-passes."""


def _time_constant_s(cutoff_hz: float) -> float:
    """And the other way round."""
    return 1.0 / (2.0 * np.pi * cutoff_hz)


def _low_passes(_: Hints) -> list[Variant]:
    """The size is the time constant of a cutoff, so that 0 is none."""
    points = 1.0 / (2.0 * np.pi * np.array(CUTOFFS_HZ))
    grid = SizeGrid(points, between(points[0], points[-1]))
    return [Variant(grid, {"order": order}) for order in ORDERS]


def _coarser_dps(hints: Hints) -> float:
    """Steps that are no coarser than the rig's are the rig's."""
    return max(hints.rate_step_dps, hints.dps_per_lsb)


def _bunches_ms(hints: Hints) -> float:
    """Quantiles of gaps jump where one sample more fits into a bunch, and lie on no curve between other intervals."""
    return 1e3 * hints.bunch_s


CURVE_AND_TIMES = (
    CandidateKind(
        "deadband",
        "width_dps",
        read_off(lambda hints: hints.least_dps),
        "rates below a width read zero",
        COARSE_VALUES,
        (Need.MOTION,),
        Touches.VALUES,
    ),
    CandidateKind(
        "quantization",
        "step_dps",
        read_off(_coarser_dps),
        "the rate comes in coarser steps than the rig says",
        COARSE_VALUES,
        (),
        Touches.VALUES,
    ),
    CandidateKind(
        "saturation",
        "limit_dps",
        read_off(lambda hints: hints.largest_dps),
        "rates beyond a limit are cut off",
        None,
        (Need.MOTION,),
        Touches.VALUES,
        is_exact=True,
    ),
    CandidateKind(
        "bandwidth",
        "cutoff_hz",
        _low_passes,
        "quick changes of the rate are smoothed away and come late",
        LAG,
        (Need.MOTION,),
        Touches.VALUES,
        of_size=_time_constant_s,
    ),
    CandidateKind(
        "latency",
        "delay_ms",
        simulated(0.3, 2.0, 8.0, 20.0, 50.0, 120.0),
        "the rate comes a fixed time later than the motion",
        LAG,
        (Need.MOTION,),
        Touches.VALUES,
        matters_from=1.0,
    ),
    CandidateKind(
        "backlash",
        "play_deg",
        simulated(0.01, 0.03, 0.1, 0.3, 1.0),
        "the encoder stays behind by a play when the motion reverses",
        REVERSAL,
        (Need.MOTION,),
        Touches.VALUES,
        matters_from=0.03,
    ),
    CandidateKind(
        "timestamp_jitter",
        "sigma_ms",
        simulated_within(0.4, 0.02, 0.06, 0.2, 0.6, 2.0, 5.0),
        "the device's time stamps scatter",
        TIMES,
        (),
        Touches.TIMES,
        matters_from=0.06,
    ),
    CandidateKind(
        "usb_batching",
        "interval_ms",
        simulated_and_shown(_bunches_ms, 1.5, 3.0, 5.0, 8.0, 12.0, 16.0, 24.0, 32.0, 48.0, 64.0, 100.0),
        "samples reach the host in bunches",
        TIMES,
        (Need.HOST,),
        Touches.TIMES,
        matters_from=2.0,
    ),
    CandidateKind(
        "sample_drop",
        "share_percent",
        simulated(0.01, 0.1, 1.0, 4.0, 16.0),
        "samples never arrive",
        None,
        (Need.COUNTER,),
        realisations=2,
        matters_from=0.02,
    ),
    CandidateKind(
        "stale_hold",
        "share_percent",
        simulated(0.02, 0.2, 2.0, 8.0, 30.0),
        "a sample repeats the one before it",
        COARSE_VALUES,
        (Need.MOTION,),
        Touches.VALUES,
        realisations=2,
        matters_from=0.05,
    ),
)
