"""Sessions as the options of a command state them: read, checked, with their damage and remarks printed."""

import argparse
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from gyrodrift.values.errors import visible

if TYPE_CHECKING:
    from gyrodrift.config.model import Config
    from gyrodrift.session.checks.stated import ReadingOptions
    from gyrodrift.session.session import Session


def reading(arguments: argparse.Namespace) -> "ReadingOptions":
    """Columns, units and sign that the options state for sessions."""
    from gyrodrift.columns.spec import columns_of
    from gyrodrift.session.checks.stated import ReadingOptions

    columns = None if arguments.columns is None else columns_of(arguments.columns)
    return ReadingOptions(
        columns,
        arguments.rate_unit or "",
        arguments.time_unit or "",
        is_flipped=arguments.flip,
        accel_unit=arguments.accel_unit or "",
        reference=arguments.reference or "",
    )


def print_remarks(path: Path, session: "Session") -> None:
    """Print the remarks of the reader on a session."""
    if session.remarks:
        print(visible(f"gyrodrift: {path}: {'; '.join(session.remarks)}"), file=sys.stderr)


def read_session(path: Path, stated: "ReadingOptions | None" = None, *, allow_damage: bool) -> "Session":
    """Load a session in the stated units, and print its remarks and its damage.

    Raises
    ------
    DamagedError
        If it is damaged and `allow_damage` is false.
    """
    from gyrodrift.session.checks.stated import AS_WRITTEN, session_as_stated

    session = session_as_stated(path, stated or AS_WRITTEN, allow_damage=allow_damage)
    print_remarks(path, session)
    if session.damage is not None:
        _print_damage(path, str(session.damage))
    return session


def checked_session(path: Path, arguments: argparse.Namespace) -> "Session":
    """Load a session in the stated units, on one clock, and print the warnings of its checks.

    Raises
    ------
    DamagedError
        If it is damaged, without --allow-damage.
    DataError
        If its numbers contradict their column or unit.
    """
    from gyrodrift.session.checks.examine import examined

    stated = reading(arguments)
    examination = examined(read_session(path, stated, allow_damage=arguments.allow_damage), stated)
    for warning in examination.warnings:
        print(visible(f"gyrodrift: warning: {path}: {warning}"), file=sys.stderr)
    examination.refuse_errors(str(path))
    return examination.session


def check_damage(paths: Iterable[Path], *, allow_damage: bool) -> None:
    """Check recordings for damage before long work, and print the damage if it is allowed.

    Raises
    ------
    DamagedError
        With all damaged recordings, if `allow_damage` is false.
    """
    from gyrodrift.session.damage import DamagedError
    from gyrodrift.session.files import damages_of

    damages = damages_of(paths)
    if damages and not allow_damage:
        raise DamagedError(damages)
    for path, damage in damages:
        _print_damage(path, str(damage))


def _print_damage(path: Path, damage: str) -> None:
    print(visible(f"gyrodrift: warning: {path}: is damaged: {damage}"), file=sys.stderr)


def calibrated_session(arguments: argparse.Namespace, config: "Config") -> "Session":
    """Load and check a session, and apply the calibration of the config, or else its own, to its rates.

    Raises
    ------
    DataError
        If its numbers contradict their column or unit.
    """
    from gyrodrift.session.calibrated import device_of, with_config

    path, calibration = arguments.session, config.calibration
    session = checked_session(path, arguments)
    if calibration is not None and not calibration.is_for(device_of(session)):
        reason = f"the calibration is for {calibration.device_id} and is not applied"
        print(f"gyrodrift: warning: {path}: is from device {device_of(session)}; {reason}", file=sys.stderr)
    return with_config(session, calibration)
