"""Sessions as the options of a command state them: read, checked, with their damage and remarks printed."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from gyrodrift.evaluation.gaps import gaps_text
from gyrodrift.session.checks import given
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.session.session import Session
from gyrodrift.values.errors import visible


def reading(arguments: argparse.Namespace) -> ReadingOptions:
    """Columns, units and sign that the options state for sessions."""
    return ReadingOptions(
        given.columns_or_none(arguments.columns),
        arguments.rate_unit or "",
        arguments.time_unit or "",
        is_flipped=arguments.flip,
        accel_unit=arguments.accel_unit or "",
        reference=arguments.reference or "",
        sample_rate_hz=arguments.sample_rate_hz,
    )


def input_options(arguments: argparse.Namespace, outputs: Sequence[Path]) -> given.InputOptions:
    """Options for the sessions of an analysis that writes these files."""
    return given.InputOptions(reading(arguments), arguments.allow_damage, outputs, print_warning)


def print_warning(warning: str) -> None:
    """Print a warning on stderr."""
    print(visible(f"gyrodrift: warning: {warning}"), file=sys.stderr)


def print_remarks(path: Path, session: Session) -> None:
    """Print the remarks of the reader on a session."""
    if session.remarks:
        print(visible(f"gyrodrift: {path}: {'; '.join(session.remarks)}"), file=sys.stderr)


def print_gaps(path: Path, session: Session) -> None:
    """Print the gaps of a session on one clock, and what a filter makes of them."""
    if text := gaps_text(session):
        print(visible(f"gyrodrift: {path}: {text}"), file=sys.stderr)


def read_session(path: Path, stated: ReadingOptions = AS_WRITTEN, *, allow_damage: bool) -> Session:
    """Load a session in the stated units, and print its remarks and its damage.

    Raises
    ------
    DamagedError
        If it is damaged and `allow_damage` is false.
    """
    session = session_as_stated(path, stated, allow_damage=allow_damage)
    print_remarks(path, session)
    if session.damage is not None:
        print_warning(given.damage_warning(path, str(session.damage)))
    return session


def checked_session(path: Path, arguments: argparse.Namespace) -> Session:
    """Load a session in the stated units, on one clock, and print the warnings of its checks and its gaps.

    Raises
    ------
    DamagedError
        If it is damaged, without --allow-damage.
    DataError
        If its numbers contradict their column or unit.
    """
    stated = reading(arguments)
    examination = examined(read_session(path, stated, allow_damage=arguments.allow_damage), stated)
    for warning in examination.warnings:
        print_warning(f"{path}: {warning}")
    examination.refuse_errors(str(path))
    print_gaps(path, examination.session)
    return examination.session


def check_damage(paths: Sequence[Path], arguments: argparse.Namespace) -> None:
    """Check recordings for damage before long work, and print the damage that --allow-damage allows.

    Raises
    ------
    DamagedError
        With all damaged recordings, without --allow-damage.
    """
    given.InputOptions(allow_damage=arguments.allow_damage, warn=print_warning).check(paths)
