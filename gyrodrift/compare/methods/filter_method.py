"""The filters of this project as methods, by the kernels that have the bits of their steps."""

from dataclasses import asdict

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.plain import steps_s
from gyrodrift.evaluation.kernels.kernel import kernel_of
from gyrodrift.evaluation.reference import NOTHING_BESIDE, Beside
from gyrodrift.evaluation.space import axes_of, row_of
from gyrodrift.filters.filter import Filter, FilterParams


def filter_method(chosen: Filter, params: FilterParams | None = None, beside: Beside = NOTHING_BESIDE) -> Method:
    """A filter as a method, with these parameters or its defaults; what a run does not name has its default.

    It sees what is known beside the rate, if that is given.
    """

    def run(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        return kernel_of(chosen).yaw(steps_s(t_s), rate_dps, row_of(chosen.params(**params))[0], beside)

    def sigma(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        stated = kernel_of(chosen).sigma
        if stated is None:
            return np.full(len(t_s), np.nan)
        return stated(steps_s(t_s), rate_dps, row_of(chosen.params(**params))[0], beside)

    return Method(
        chosen.name,
        chosen.title or chosen.name,
        run,
        asdict(chosen.params() if params is None else params),
        axes_of(chosen),
        about=chosen.about,
        counts_samples=chosen.counts_samples,
        sigma=sigma,
        seeing=lambda more: filter_method(chosen, beside=more),
        colour=chosen.colour,
        dash=chosen.dash,
    )
