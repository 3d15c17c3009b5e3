"""Bias estimation of x-io Fusion by its package `imufusion`, sample by sample."""

import numpy as np

from gyrodrift.compare.methods.method import Params
from gyrodrift.compare.methods.plain import mean_step_s, steps_s
from gyrodrift.evaluation.integration import trapezium
from gyrodrift.values.arrays import Floats


def run_fusion(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
    """Yaw of the rates that `imufusion.Bias` returns for (0, 0, rate), deg, shape (n,)."""
    from imufusion import Bias, BiasSettings

    settings = BiasSettings(1.0 / mean_step_s(t_s), params["stationary_threshold"], params["stationary_period"])
    bias = Bias().set_settings(settings)
    axes = np.zeros((len(rate_dps), 3))
    axes[:, 2] = rate_dps
    # The package returns 32-bit floats. Only the small bias comes from them, so the rate keeps its precision.
    bias_dps = np.array([given[2] - float(bias.update(given)[2]) for given in axes])
    return trapezium(steps_s(t_s), rate_dps - bias_dps)
