"""Restlevel with the second sources of a session, as `serve` runs it; the row without them is that of restlevel."""

from dataclasses import asdict, replace
from functools import cache

import numpy as np

from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.evaluation.attitude import AttitudeHistory, filter_history
from gyrodrift.evaluation.auxiliary import Auxiliary, InertialColumns
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.session.aids import RowAids
from gyrodrift.values.arrays import Floats


def missing_aids(_t_s: Floats, _rate_dps: Floats, _params: Params) -> Floats:
    """No yaw for a session without second sources."""
    raise ValueError("the method needs second sources")


def aided(axes: InertialColumns | None, auxiliary: Auxiliary, aids: RowAids) -> Method:
    """The method for the data of a session."""

    @cache
    def history(times: bytes, rates: bytes, values: tuple[float, ...]) -> AttitudeHistory:
        """One run gives yaw and its sigma."""
        params = RESTLEVEL.params(*values)
        return filter_history(np.frombuffer(times), np.frombuffer(rates), axes, auxiliary, params, aids)

    def run(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        return history(t_s.tobytes(), rate_dps.tobytes(), tuple(params.values())).yaw_deg

    def sigma(t_s: Floats, rate_dps: Floats, params: Params) -> Floats:
        return history(t_s.tobytes(), rate_dps.tobytes(), tuple(params.values())).yaw_sigma_deg

    return replace(AIDED, run=run, sigma=sigma)


AIDED = Method(
    "restlevel-aided",
    "restlevel with second sources",
    missing_aids,
    asdict(RESTLEVEL.params()),
    about="Restlevel at its defaults with the second sources of the recording: headings, turn rates, wheels, speed.",
    needs_aids=True,
    with_aids=aided,
    color=RESTLEVEL.color,
    dash="--",
)
