"""The encoder's angle by itself: the steps that it comes in, its scatter, its jumps."""

from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.features.design_matrix import DesignMatrix
from gyrodrift.diagnose.features.feature import ResponseLaw, Statistic
from gyrodrift.diagnose.features.spreads import turning_spread
from gyrodrift.diagnose.features.units import AMPLITUDE_DEG, COUNTS, JUMPS
from gyrodrift.diagnose.recording.outliers import Cleaned

LEAST_SHOWN = 40
"""Samples that are one step from the one before, and different distances of those that are more: so many together are
no chance, nor the arithmetic of an even ramp."""


@dataclass(frozen=True, slots=True)
class AngleValues:
    """An angle beside a motion; `count_deg` is the step that the rig states."""

    seen: Cleaned
    design: DesignMatrix
    count_deg: float


def _log2_step(angle: AngleValues) -> float:
    times = angle.seen.step_deg / angle.count_deg
    return float(np.log2(times)) if times > 1.0 and _is_shown(angle.seen) else 0.0


def _is_shown(seen: Cleaned) -> bool:
    """Whether a motion would have come by the counts between two steps, were there any.

    At an even speed of a whole number of counts per sample it comes by the same ones again and again.
    """
    moved = np.abs(np.diff(seen.recording.encoder_deg)) / seen.step_deg
    steps = np.rint(moved[np.isfinite(moved)])
    return bool(np.count_nonzero(steps == 1.0) + len(np.unique(steps[steps > 1.0])) >= LEAST_SHOWN)


def _log_scatter(angle: AngleValues) -> float:
    """Rounding to counts is a noise that is always there."""
    spread = turning_spread(angle.seen.encoder_deg, angle.design.spread_places)
    return float(np.log(spread + angle.count_deg**2 / 12.0))


# fmt: off
ANGLE_VALUES: tuple[Statistic[AngleValues], ...] = (
    Statistic(
        "angle_step", "encoder", "always", "the angle comes in coarser steps than the rig says", 0.15,
        "0.15 of a doubling: a ninth of the step", reading=COUNTS, compute=_log2_step,
    ),
    Statistic(
        "angle_noise", "encoder", "moving", "the angle scatters from sample to sample", 0.2,
        "0.2 in ln of a variance: a tenth of the amplitude", reading=AMPLITUDE_DEG, response=ResponseLaw.LOG_VARIANCE,
        compute=_log_scatter,
    ),
    Statistic(
        "slip_count", "encoder", "always", "the angle jumps", 0.4, "a root of 0.4: less than one jump", reading=JUMPS,
        compute=lambda angle: float(np.sqrt(len(angle.seen.slips_deg))),
    ),
)
# fmt: on
