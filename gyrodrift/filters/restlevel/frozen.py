"""A sensor that hangs: it repeats one value, though it is known to have noise.

Such a value measures nothing. Noise, bias and rests stay what was known of them, and yaw is uncertain by as much as the
value turns it meanwhile: the device may have stopped with the first repetition.
"""

from gyrodrift.filters.restlevel.model import RestlevelState
from gyrodrift.filters.restlevel.noise import FINE_DPS

NOISE_STEPS = 2.0
"""Where the noise at rest is known to be so many steps of the sensor, two samples are alike one time in seven
(1/(2·√π·NOISE_STEPS)), and the six of the shortest block one time in 18 000."""


def detect_freeze(s: RestlevelState) -> None:
    """Whether the sensor has hung all through the block that has just ended.

    Parts of coarser steps than FINE_DPS may stand still between two of them. Zeros are no freeze of a device whose bias
    is no larger than its noise: some take their bias out and say zero at rest.
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
    """What the hanging sensor has turned yaw by is not known, all of it together."""
    noise = s.noise
    if not noise.is_frozen:
        return
    before_deg = noise.frozen_deg
    noise.frozen_deg += abs(s.block.angle_deg - s.bias_dps * seconds)
    more_var = noise.frozen_deg * noise.frozen_deg - before_deg * before_deg
    for h in s.hypotheses:
        if h.weight > 0.0:
            h.yaw_var += more_var
