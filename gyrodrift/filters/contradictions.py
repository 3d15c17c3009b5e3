"""Doubt about an external rest sensor: how far a rate may be from the bias, and how many blocks refute the sensor.

`w` is the state of such a sensor, with the fields `contradictions`, `is_believed` and `refuted`.
"""

from typing import Any

FIT_SIGMAS = 6.0
"""Distance of a block mean from the bias, in sigmas, that contradicts a report of rest. Chosen."""

MOST_CONTRADICTIONS = 5.0
"""Number of contradicting blocks that refutes the sensor. Chosen: 1.5 s of a turn at the default `window_s`."""

FIT_CREDIT = 0.1
"""Number of contradictions that a block which fits removes. Chosen."""

MOST_FIRST = 20.0
"""Largest first bias, in sigmas of the turn-on bias. Chosen: a larger level is a turn."""


def count_fit(w: Any) -> None:
    """Count a block whose rate fits a report of rest."""
    w.contradictions = max(0.0, w.contradictions - FIT_CREDIT)


def count_contradiction(w: Any) -> bool:
    """Count a block whose rate contradicts a report of rest; whether it refutes the sensor."""
    w.contradictions += 1.0
    if w.contradictions < MOST_CONTRADICTIONS:
        return False
    w.is_believed, w.refuted = False, w.refuted + 1
    w.contradictions = MOST_CONTRADICTIONS - 1.0
    return True
