"""Frozen sensor: a sensor with noise that repeats a single value.

The repeated value is no measurement, so noise, bias and rests stay unchanged. The device may have stopped with the
first repetition. So the sigma of yaw grows by the whole angle of the repeated rate.
"""

from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.noise import FINE_DPS

NOISE_STEPS = 2.0
"""Smallest noise at rest, in steps of the sensor, with which a repeated value shows a freeze.

Chosen: at this noise two samples are equal with probability 1/(2·√π·NOISE_STEPS), one in seven. All six samples of the
shortest block are equal once in 18 000 blocks."""


def detect_freeze(s: RestlevelState) -> None:
    """Set whether the sensor was frozen through the present block.

    A sensor of coarser steps than FINE_DPS may rest between two steps. Zeros are no freeze if the bias is at most the
    noise: some devices subtract their bias and send zero at rest.
    """
    noise = s.noise
    step_dps = noise.resolution_dps
    is_noisy = noise.is_walk_measured and noise.sample_var > NOISE_STEPS * NOISE_STEPS * step_dps * step_dps
    is_zero = s.rate_dps == 0.0 and s.bias_dps * s.bias_dps <= noise.sample_var
    noise.is_frozen = s.block.sum_squares == 0.0 and is_noisy and 0.0 < step_dps <= FINE_DPS and not is_zero
    if noise.is_frozen:
        noise.has_dropped = False
        noise.last_block_var = noise.sample_var
    else:
        noise.frozen_deg = 0.0


def widen_yaw(s: RestlevelState, seconds: float) -> None:
    """Add the angle of a frozen sensor since its first repetition to the sigma of yaw, as a single error."""
    noise = s.noise
    if not noise.is_frozen:
        return
    before_deg = noise.frozen_deg
    noise.frozen_deg += abs(s.block.angle_deg - s.bias_dps * seconds)
    more_var = noise.frozen_deg * noise.frozen_deg - before_deg * before_deg
    for h in s.hypotheses:
        if h.weight > 0.0:
            h.yaw_var += more_var
