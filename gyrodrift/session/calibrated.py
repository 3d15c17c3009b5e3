"""Sessions with calibrated rates, by their own calibration or by another one, applied once.

A session has the rates as measured, so that a better calibration, or none, can still be applied later.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Floats
from gyrodrift.values.calibration import Calibration, calibration_of_table, device_identity
from gyrodrift.values.errors import DataError

KEPT, APPLIED = "calibration", "calibration applied"
"""Names of the calibration table in the metadata, before and after it is applied."""


def calibration_of(session: Session) -> Calibration | None:
    """Calibration in a session, if it belongs to its device; None without one, or if it is already applied.

    Raises
    ------
    DataError
        The table is invalid.
    """
    table = session.metadata.get(KEPT)
    if not table:
        return None
    try:
        calibration = calibration_of_table(table)
    except ValueError as error:
        raise DataError(f"{session.name}: its calibration is invalid: {error}") from error
    return calibration if calibration.is_for(device_of(session)) else None


def device_of(session: Session) -> str:
    """Identity of the device of a session; empty if unknown."""
    device_id = session.metadata.get("device", {}).get("device_id")
    return device_identity(device_id, session.metadata.get("recording", {}).get("port", ""))


def calibrated(session: Session) -> Session:
    """The session with its own calibration applied, if it has one.

    Raises
    ------
    DataError
        Its calibration is invalid.
    """
    calibration = calibration_of(session)
    return session if calibration is None else with_calibration(session, calibration)


def with_calibration(session: Session, calibration: Calibration) -> Session:
    """The session with calibrated rates and accelerations; its metadata say so, so that it is done only once."""
    tables: Mapping[str, Mapping[str, str]] = {n: t for n, t in session.metadata.items() if n != KEPT}
    rate_dps = true_rates_dps(session.rate_dps, session.temp_c, calibration)
    corrected = session
    if session.gyro_dps is not None:
        corrected = _with_true_axes(session, session.gyro_dps, calibration)
        z_dps = _scaled_dps(corrected.filled("gyro_z_dps"), calibration)
        rate_dps = np.where(np.isnan(z_dps), rate_dps, z_dps)  # a sample may lack its axes
    upright = corrected.upside_down() if calibration.sign < 0 else corrected
    return replace(upright.with_yaw_rate(rate_dps), metadata={**tables, APPLIED: calibration.table()})


def _with_true_axes(session: Session, gyro_dps: Floats, calibration: Calibration) -> Session:
    """The session with calibrated axes before the sign, bit by bit as `Calibration.inertial`."""
    true_dps = true_gyro_dps(gyro_dps, session.temp_c, calibration)
    accel_mps2 = None if session.accel_mps2 is None else true_accel_mps2(session.accel_mps2, calibration)
    return replace(session, gyro_dps=true_dps, accel_mps2=accel_mps2)


def true_gyro_dps(measured_dps: Floats, temp_c: Floats | None, calibration: Calibration) -> Floats:
    """Rates in the frame of the accelerometer, before sign and scale of z, deg/s; shape (n, 3)."""
    x_dps, y_dps = measured_dps[:, 0], measured_dps[:, 1]
    z_dps = measured_dps[:, 2] - _bias_dps(temp_c, calibration)
    if calibration.gyro_bias_xy_dps is not None:
        x_dps, y_dps = x_dps - calibration.gyro_bias_xy_dps[0], y_dps - calibration.gyro_bias_xy_dps[1]
    if calibration.gyro_matrix is None:
        return np.column_stack([x_dps, y_dps, z_dps])
    return np.column_stack([row[0] * x_dps + row[1] * y_dps + row[2] * z_dps for row in calibration.gyro_matrix])


def true_accel_mps2(measured_mps2: Floats, calibration: Calibration) -> Floats:
    """Accelerations without offset and with scale, m/s²; shape (n, 3)."""
    accel_mps2 = measured_mps2
    if calibration.accel_offset_mps2 is not None:
        accel_mps2 = accel_mps2 - np.array(calibration.accel_offset_mps2)
    return accel_mps2 if calibration.accel_scale is None else accel_mps2 * np.array(calibration.accel_scale)


def applied_scale_sigmas(session: Session) -> tuple[float | None, float | None]:
    """Standard errors of the scales that were applied to a session, as shares: of z alone, and of three axes.

    None if the scale was not measured.
    """
    table = session.metadata.get(APPLIED)
    applied = calibration_of_table(table) if table else None
    return (None, None) if applied is None else (applied.scale_sigma, applied.axes_scale_sigma)


def with_config(session: Session, given: Calibration | None) -> Session:
    """The session with the calibration of a config, if it belongs to its device; without one, with its own.

    Raises
    ------
    DataError
        Its own calibration is invalid.
    """
    if given is None:
        return calibrated(session)
    return with_calibration(session, given) if given.is_for(device_of(session)) else session


def true_rates_dps(measured_dps: Floats, temp_c: Floats | None, calibration: Calibration) -> Floats:
    """Calibrated rates, deg/s, bit by bit as `Calibration.rate_dps`; arrays of shape (n,), temperature in °C."""
    return _scaled_dps(measured_dps - _bias_dps(temp_c, calibration), calibration)


def _scaled_dps(rest_dps: Floats, calibration: Calibration) -> Floats:
    """Rates with sign and scale of their direction, deg/s."""
    signed_dps = calibration.sign * rest_dps
    scaled: Floats = signed_dps * np.where(signed_dps >= 0.0, calibration.scale_ccw, calibration.scale_cw)
    return scaled


def _bias_dps(temp_c: Floats | None, calibration: Calibration) -> Floats | float:
    if temp_c is None or not calibration.bias_dps_per_c or calibration.temp_c is None:
        return calibration.bias_dps
    low_c, high_c = calibration.temp_low_c, calibration.temp_high_c
    inside_c = np.clip(temp_c, -np.inf if low_c is None else low_c, np.inf if high_c is None else high_c)
    bias_dps: Floats = calibration.bias_dps + calibration.bias_dps_per_c * (inside_c - calibration.temp_c)
    return np.where(np.isnan(temp_c), calibration.bias_dps, bias_dps)
