"""Write sessions of the simulated rig, as fast as they can be computed.

The same rig, profile and seed give the same samples here and from the simulated device. --twin reads a table of
published sessions, and simulates sessions of the same lengths with the same drift. --hard-cases writes the standard set
of difficult sessions: 13 cases, each once still at the start and once moving, a folder of ten sessions for each. With
--axes 3 these are 15 cases of motions that tilt or accelerate, with --second-sources 3 cases of headings and wheels.

A device with three axes also gets its true orientation, as NAME.truth.npz beside each session.
"""

import argparse
import sys
from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import TypeVar

from firmware_sim.measure import Motion
from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import (
    AIDS,
    Rig,
    load_rig,
    parse_aid,
    parse_effect,
    with_aids,
    with_axes,
    with_effects,
    with_own_yaw,
)
from firmware_sim.yaml_file import FileError
from gyrodrift.cli import numbers, options
from gyrodrift.cli.written import samples_text, written_words
from gyrodrift.io.files import check_inputs_kept, check_kept
from gyrodrift.io.progress import OnProgress
from gyrodrift.simulation.hard_cases import SESSIONS, hard_case_count, hard_case_paths, write_hard_cases
from gyrodrift.simulation.published_set import read_rows, twin_paths, write_twins
from gyrodrift.simulation.sessions import RIG, rig_yaml, sample_count, simulated_paths, truth_path, write_sessions
from gyrodrift.values.errors import UsageError, visible

Parsed = TypeVar("Parsed")

STAGE = "sessions"

EXAMPLES = """\
gyrodrift simulate --out sessions --sessions 6 --duration 8min --seed 1
gyrodrift simulate --axes 3 --profile hand --out tilting --effect warmup --effect accel_bias:x_mps2=0.3
gyrodrift simulate --hard-cases --out hard --seed 1
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    options.load_effects()
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the sessions")
    parser.add_argument("--rig", type=Path, metavar="FILE", help="rig (default: the shipped config/rig.yaml)")
    parser.add_argument(
        "--profile",
        type=options.profile,
        metavar="PROFILE",
        help="motion: a shipped profile or a file (default: turntable)",
    )
    parser.add_argument(
        "--sessions", type=numbers.whole(10**6), metavar="N", help="number of sessions (default 1; 10 per hard case)"
    )
    length = "length of a session, such as 90 (s), 8min or 1h (default 10min)"
    options.add_duration_option(parser, 10.0, length, older="minutes")
    parser.add_argument("--seed", type=numbers.seed, default=0, metavar="S", help="seed of all randomness (default 0)")
    parser.add_argument(
        "--effect",
        type=partial(_parsed, parse_effect),
        action="append",
        default=[],
        metavar="NAME[:param=value,...]",
        help="add an effect to the rig (default: none); a missing parameter has its typical value; repeatable",
    )
    parser.add_argument(
        "--aid",
        type=partial(_parsed, parse_aid),
        action="append",
        default=[],
        metavar="NAME[:param=value,...]",
        help=f"add a second source with its flaws (repeatable; default: none): {', '.join(AIDS)}",
    )
    parser.add_argument(
        "--axes",
        choices=("1", "3"),
        help="gyro axes: 1, or 3 with an accelerometer (default: as the rig file says; 1 for the hard cases)",
    )
    parser.add_argument(
        "--own-yaw",
        choices=("hdr", "restlevel", "attitude"),
        help="run this filter in the device too, and write its yaw, sigma and drift; attitude is restlevel on three "
        "axes (default: as the rig file says)",
    )
    parser.add_argument("--format", default="mcap", choices=("mcap", "csv"), help="file format (default mcap)")
    parser.add_argument(
        "--twin", type=Path, metavar="TABLE.csv", help="table of published sessions to imitate (default: none)"
    )
    parser.add_argument("--hard-cases", action="store_true", help="write the standard set of difficult sessions")
    parser.add_argument(
        "--second-sources", action="store_true", help="with --hard-cases: the cases that have second sources with flaws"
    )
    options.add_force_option(parser)


def run(arguments: argparse.Namespace) -> int:
    """Simulate; 0 when all sessions are written."""
    if arguments.hard_cases and (
        arguments.twin or arguments.rig or arguments.effect or arguments.aid or arguments.profile or arguments.own_yaw
    ):
        raise UsageError(
            "--hard-cases has its own rigs and motions: leave out --rig, --profile, --effect, --aid, --own-yaw, --twin"
        )
    if arguments.second_sources and (not arguments.hard_cases or arguments.axes == "3"):
        raise UsageError("--second-sources chooses among --hard-cases of one axis; for other sessions give --aid")
    if arguments.twin is not None and arguments.axes == "3":
        raise UsageError("--twin imitates sessions of one axis: leave out --axes 3")
    with options.progress_of(arguments) as progress:
        progress.report(options.PACKAGES, 0, 0)
        rig, profile = _rig_and_profile(arguments)
        _check_kept(arguments, rig)
        try:
            for text in _written(arguments, rig, profile, progress.report):
                if not arguments.quiet:
                    print(visible(f"gyrodrift: {text}"), file=sys.stderr)
        except OSError as error:
            raise UsageError(f"{arguments.out}: cannot be written: {error.strerror}") from error
    return 0


def _axes(arguments: argparse.Namespace) -> int | None:
    """Number of axes of `--axes`; None to take that of the rig."""
    return None if arguments.axes is None else int(arguments.axes)


def _rig_and_profile(arguments: argparse.Namespace) -> tuple[Rig, Motion]:
    try:
        rig = with_effects(with_axes(load_rig(arguments.rig), _axes(arguments)), arguments.effect)
        rig = with_aids(rig, arguments.aid)
        return with_own_yaw(rig, arguments.own_yaw), load_motion(arguments.profile or "turntable")
    except FileError as error:
        raise UsageError(str(error)) from error


def _check_kept(arguments: argparse.Namespace, rig: Rig) -> None:
    """Protect the files that are read, and the sessions and the rig of another simulation."""
    paths = _paths(arguments)
    is_set = arguments.hard_cases or arguments.twin is not None
    rigs = [path.with_suffix(".rig.yaml") for path in paths] if is_set else [arguments.out / RIG]
    profile = None if arguments.profile is None else Path(arguments.profile)
    inputs = [path for path in (arguments.rig, arguments.twin, profile) if path is not None]
    check_inputs_kept(rigs, inputs)
    has_truth = arguments.axes == "3" if arguments.hard_cases else rig.base.three_axes is not None
    truths = [truth_path(path) for path in paths] if has_truth else []
    check_kept([*paths, *truths], inputs, force=arguments.force)
    if not is_set and not arguments.force and rigs[0].is_file() and rigs[0].read_bytes() != rig_yaml(rig).encode():
        raise UsageError(f"{rigs[0]}: differs from the rig to simulate; --force replaces it")


def _paths(arguments: argparse.Namespace) -> list[Path]:
    """Files that will be written, without the rigs."""
    if arguments.twin is not None:
        return twin_paths(read_rows(arguments.twin), arguments.out, arguments.format)
    if arguments.hard_cases:
        words = (arguments.out, arguments.sessions or SESSIONS, arguments.format, _axes(arguments) or 1)
        return hard_case_paths(*words, is_aided=arguments.second_sources)
    return simulated_paths(arguments.out, arguments.sessions or 1, arguments.format)


def _written(arguments: argparse.Namespace, rig: Rig, profile: Motion, progress: OnProgress) -> Iterator[str]:
    """A line per session, as soon as it is written."""
    if arguments.twin is not None:
        return _twins(arguments, rig, progress)
    if arguments.hard_cases:
        return _hard_cases(arguments, progress)

    numbers = (arguments.seed, arguments.sessions or 1, arguments.minutes)
    contents = samples_text(sample_count(rig, arguments.minutes))
    paths = write_sessions(rig, profile, arguments.out, *numbers, arguments.format, progress)
    return (written_words(path, contents) for path in paths)


def _twins(arguments: argparse.Namespace, rig: Rig, progress: OnProgress) -> Iterator[str]:
    rows = read_rows(arguments.twin)
    progress(STAGE, 0, len(rows))
    for done, twin in enumerate(write_twins(rows, rig, arguments.out, arguments.seed, arguments.format), 1):
        progress(STAGE, done, len(rows))
        error = f"E {twin.e_euler_deg:.4f} deg, published {twin.row.e_euler_deg:.4f} deg"
        yield f"{written_words(twin.path, samples_text(sample_count(rig, twin.row.minutes)))}; {error}"


def _hard_cases(arguments: argparse.Namespace, progress: OnProgress) -> Iterator[str]:
    sessions = arguments.sessions or SESSIONS
    axes = _axes(arguments) or 1
    is_aided = arguments.second_sources
    total = hard_case_count(sessions, axes, is_aided=is_aided)
    contents = samples_text(sample_count(Rig(), arguments.minutes))
    progress(STAGE, 0, total)
    numbers = (arguments.seed, sessions, arguments.minutes)
    written = write_hard_cases(arguments.out, *numbers, arguments.format, axes, is_aided=is_aided)
    for done, path in enumerate(written, 1):
        progress(STAGE, done, total)
        yield written_words(path, contents)


def _parsed(parse: Callable[[str], Parsed], text: str) -> Parsed:
    """Value of an argument of `--aid` or `--effect`; without parameters it has its typical size.

    Raises
    ------
    UsageError
        If the name or a parameter does not exist, or a value is out of range.
    """
    try:
        return parse(text)
    except FileError as error:
        raise UsageError(str(error)) from error
