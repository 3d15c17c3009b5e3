"""x-io Fusion's bias estimation, by its own package `imufusion`, a sample at a time, as it is offered there."""

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import mean_step_s, steps_s
from gyrodrift.evaluation.integration import trapezium


def run_fusion(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the rates that `imufusion.Bias` gives back for (0, 0, rate), deg, shape (n,)."""
    from imufusion import Bias, BiasSettings  # noqa: PLC0415 - not everybody has it

    settings = BiasSettings(1.0 / mean_step_s(t_s), params["stationary_threshold"], params["stationary_period"])
    bias = Bias().set_settings(settings)
    axes = np.zeros((len(rate_dps), 3))
    axes[:, 2] = rate_dps
    # It answers in 32-bit floats: what it took off is small, so that is kept, and the rate keeps its digits.
    taken_off_dps = np.array([given[2] - float(bias.update(given)[2]) for given in axes])
    return trapezium(steps_s(t_s), rate_dps - taken_off_dps)
