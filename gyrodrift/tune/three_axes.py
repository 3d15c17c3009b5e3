"""Parameters of restlevel, tuned on the rate of the heading, on sessions of three axes.

There restlevel is the attitude filter. The search cannot run it: an evaluation takes seconds. Its other use of the
parameters may make the best ones of the rate worse than the defaults.
"""

from collections.abc import Sequence
from math import sqrt

import numpy as np

from gyrodrift.evaluation.attitude import attitude_history
from gyrodrift.evaluation.dataset import LoadedSession
from gyrodrift.evaluation.score import score_of
from gyrodrift.filters.filter import FilterParams
from gyrodrift.filters.restlevel_filter import RESTLEVEL

CHECKED = 3
"""Sessions that are compared: 3 of 30 min at 100 Hz take some minutes. Chosen."""


def worse_on_three_axes(params: FilterParams, sessions: Sequence[LoadedSession]) -> str:
    """Warning if the attitude filter is worse with these parameters than with its defaults; empty if it is better."""
    with_axes = [session for session in sessions if session.reference.axes is not None]
    if not with_axes:
        return ""
    tuned_deg, default_deg = (_rms_deg(candidate, with_axes) for candidate in (params, RESTLEVEL.params()))
    if tuned_deg < default_deg:
        return ""
    return (
        f"the parameters found on the rate of the heading are worse on three axes: {tuned_deg:.3g} against "
        f"{default_deg:.3g} deg RMS; the config has the defaults"
    )


def _rms_deg(params: FilterParams, sessions: Sequence[LoadedSession]) -> float:
    """Root of the mean PI over the sessions, deg."""
    return sqrt(float(np.mean([_pi_deg2(params, session) for session in sessions])))


def _pi_deg2(params: FilterParams, session: LoadedSession) -> float:
    reference = session.reference
    if reference.axes is None:
        raise ValueError(f"{reference.name} has one axis")
    history = attitude_history(session.t_s, reference.axes, reference.auxiliary, params)
    return float(score_of(reference, history.yaw_deg).pi_deg2)
