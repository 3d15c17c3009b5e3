"""Sessions with their true rates: the calibration that stands beside the samples, or another one, applied once.

A session keeps what the device sent, so that a better calibration, or none, can still be taken later.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.calibration import Calibration, calibration_of_table, device_identity
from gyrodrift.errors import DataError
from gyrodrift.session.session import Session

KEPT, APPLIED = "calibration", "calibration applied"
"""Names of the table in the metadata: before, and where the rates are put right already."""


def calibration_of(session: Session) -> Calibration | None:
    """The calibration that a session keeps and that is one of its device; None where there is none, or it is applied.

    Raises
    ------
    DataError
        Where the table makes no sense.
    """
    table = session.metadata.get(KEPT)
    if not table:
        return None
    try:
        found = calibration_of_table(table)
    except ValueError as error:
        raise DataError(f"{session.name}: its calibration makes no sense: {error}") from error
    return found if found.is_for(device_of(session)) else None


def device_of(session: Session) -> str:
    """What the device of a session is known by; empty where it is not."""
    device_id = session.metadata.get("device", {}).get("device_id")
    return device_identity(device_id, session.metadata.get("recording", {}).get("port", ""))


def calibrated(session: Session) -> Session:
    """A session as a filter takes it: under the calibration that it keeps, or as it is where there is none.

    Raises
    ------
    DataError
        Where its calibration makes no sense.
    """
    found = calibration_of(session)
    return session if found is None else with_calibration(session, found)


def with_calibration(session: Session, calibration: Calibration) -> Session:
    """A session with its rates put right; its metadata say so, and it is not done again."""
    rate_dps = true_rates_dps(session.rate_dps, session.temp_c, calibration)
    others: Mapping[str, Mapping[str, str]] = {n: t for n, t in session.metadata.items() if n != KEPT}
    return replace(session, rate_dps=rate_dps, metadata={**others, APPLIED: calibration.table()})


def applied_scale_sigma(session: Session) -> float | None:
    """Standard error of the scale that was applied to a session, as a share; None without a calibration."""
    table = session.metadata.get(APPLIED)
    return calibration_of_table(table).scale_sigma if table else None


def with_config(session: Session, given: Calibration | None) -> Session:
    """A session under the calibration of a config where that is one of its device; without one under its own.

    Raises
    ------
    DataError
        Where its own calibration makes no sense.
    """
    if given is None:
        return calibrated(session)
    return with_calibration(session, given) if given.is_for(device_of(session)) else session


def true_rates_dps(measured_dps: Floats, temp_c: Floats | None, calibration: Calibration) -> Floats:
    """As `Calibration.rate_dps`, bit by bit, for arrays of the shape (n,), deg/s and °C."""
    rest_dps = calibration.sign * (measured_dps - _bias_dps(temp_c, calibration))
    scaled: Floats = rest_dps * np.where(rest_dps >= 0.0, calibration.scale_ccw, calibration.scale_cw)
    return scaled


def _bias_dps(temp_c: Floats | None, calibration: Calibration) -> Floats | float:
    if temp_c is None or not calibration.bias_dps_per_c or calibration.temp_c is None:
        return calibration.bias_dps
    low_c, high_c = calibration.temp_low_c, calibration.temp_high_c
    inside_c = np.clip(temp_c, -np.inf if low_c is None else low_c, np.inf if high_c is None else high_c)
    bias_dps: Floats = calibration.bias_dps + calibration.bias_dps_per_c * (inside_c - calibration.temp_c)
    return np.where(np.isnan(temp_c), calibration.bias_dps, bias_dps)
