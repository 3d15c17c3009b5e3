"""All that is drawn of rate errors: over time, against what they may depend on, as spectra."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.predictive_checks.dependences import Dependence, dependences_of
from gyrodrift.diagnose.predictive_checks.residual_series import ResidualSeries, residual_series_of
from gyrodrift.diagnose.predictive_checks.spectra import Spectra, pooled
from gyrodrift.diagnose.simulate.twin import Subject

MAX_SESSIONS = 6
"""With more of them the page would be long and say no more."""


@dataclass(frozen=True, slots=True, eq=False)
class ResidualChecks:
    """Rate errors of some sessions, real and simulated.

    spectra
        Of all of them in one, below and above half a hertz, where there are any.
    """

    sessions: tuple[ResidualSeries, ...]
    dependences: tuple[Dependence, ...]
    spectra: tuple[Spectra, ...]


def residual_checks_of(subjects: Sequence[Subject], causes: tuple[NamedCause, ...]) -> ResidualChecks:
    """Of at most MAX_SESSIONS, evenly chosen."""
    count = min(len(subjects), MAX_SESSIONS)
    chosen = np.unique(np.linspace(0, len(subjects) - 1, count).round().astype(int)).tolist()
    sessions = tuple(residual_series_of(subjects[at], causes, at + 1) for at in chosen)
    both = pooled([one.slow for one in sessions]), pooled([one.quick for one in sessions])
    return ResidualChecks(
        sessions=sessions,
        dependences=dependences_of(sessions, [subjects[at] for at in chosen]),
        spectra=tuple(one for one in both if len(one.hz)),
    )
