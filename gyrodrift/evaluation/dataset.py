"""Sessions of an evaluation: loading, checks, the split into training and test, and thinned curves for figures."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

import numpy as np

from gyrodrift.evaluation.gaps import gaps_text
from gyrodrift.evaluation.integration import start_calibrated, trapezium
from gyrodrift.evaluation.reference import Reference, timed_reference_of
from gyrodrift.evaluation.score import Score, score_of
from gyrodrift.facts.arrays import blocks_of, true_runs
from gyrodrift.session.calibrated import calibrated
from gyrodrift.session.checks.examine import examined
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError

STEP_S = 1.0
REST_DEG = 0.5
"""A second is a rest if the reference angle changes by less than REST_DEG: chosen, above the scatter of encoders."""

CROSS_VALIDATED = 5
"""Most sessions for leave-one-out cross-validation; with more sessions, a share is held out: chosen."""

TEST_SHARE = 0.3
"""Share of the sessions that is held out: chosen."""

RATE_TOLERANCE = 0.02
"""Relative difference of sample rates that is ignored, above the tolerance of oscillators: chosen."""

MISSING_SHARE = 0.01
"""Share of missing encoder values above which a warning is given: chosen."""

MOVES_DPS = 3.0
"""Range of the one-second means of the rate, deg/s, above which the device has moved: chosen."""


def longest_motion_s(t_s: Floats, reference_deg: Floats) -> float:
    """Longest motion without a rest, s.

    Parameters
    ----------
    t_s
        Times of the samples, s, increasing, shape (n,).
    reference_deg
        Unwrapped reference angle, deg, NaN if unknown, shape (n,).
    """
    is_known = np.isfinite(reference_deg)
    known_s = t_s[is_known]
    if not len(known_s):
        return 0.0
    seconds, first = np.unique((known_s - known_s[0]) // STEP_S, return_index=True)
    start_s, angle_deg = known_s[first], reference_deg[is_known][first]
    is_moving = np.abs(np.diff(angle_deg)) >= REST_DEG * np.diff(seconds)
    return max((float(start_s[end] - start_s[first]) for first, end in true_runs(is_moving)), default=0.0)


class Split(Enum):
    """Use of a session."""

    TRAIN = "train"
    TEST = "test"


@dataclass(frozen=True, slots=True)
class Source:
    """A session to load.

    split
        Its use; None if not chosen yet.
    reading
        Options for columns and units.
    """

    path: Path
    is_still: bool = False
    split: Split | None = None
    reading: ReadingOptions = AS_WRITTEN


@dataclass(frozen=True, slots=True)
class SessionSummary:
    """Description of a session without its samples.

    digest
        SHA-256 of its content.
    minutes, sample_rate_hz
        Duration by device time, and sample rate from the median step.
    warnings : tuple of str
        Sentences about suspect data.
    plain, start
        Scores of plain integration and of a start calibration; None if they were not computed.
    longest_motion_s
        Longest motion without a rest, by the reference; None if it was not computed.
    """

    name: str
    digest: str
    minutes: float
    sample_rate_hz: float
    warnings: tuple[str, ...] = ()
    plain: Score | None = None
    start: Score | None = None
    longest_motion_s: float | None = None


@dataclass(frozen=True, slots=True)
class LoadedSession:
    """A session with its reference.

    t_s
        Device times of the samples of the reference, s, shape (n,).
    """

    reference: Reference
    description: SessionSummary
    t_s: Floats


def load_with_reference(source: Source) -> LoadedSession:
    """Load a session with calibrated rates, from its first sample with a reference on.

    Of a damaged session the undamaged part is loaded; call `session.files.damages_of` first to find damage.

    Raises
    ------
    DataError
        With its path, if it cannot be read, has no reference, or contradicts its options.
    """
    whole = session_as_stated(source.path, source.reading)
    checked = examined(whole, source.reading, is_still=source.is_still)
    checked.refuse_errors(str(source.path))
    session = calibrated(checked.session)
    try:
        t_s, reference = timed_reference_of(session, is_still=source.is_still)
    except DataError as error:
        raise DataError(f"{source.path}: {str(error).removeprefix(f'{session.name}: ')}") from error
    remarks = (*session.remarks, *checked.warnings, *filter(None, [gaps_text(session)]))
    read = [f"{session.name}: {remark}" for remark in remarks]
    warnings = (*read, *([] if source.is_still else _warnings(source, reference)))
    digest = digest_of(source.path)
    described = SessionSummary(
        reference.name,
        digest,
        reference.minutes,
        reference.sample_rate_hz,
        warnings,
        plain=score_of(reference, trapezium(reference.dt_s, reference.rate_dps)),
        start=score_of(reference, start_calibrated(t_s, reference.rate_dps)),
        longest_motion_s=longest_motion_s(t_s, reference.reference_deg),
    )
    return LoadedSession(reference, described, t_s)


def folder_names(paths: Sequence[Path]) -> list[str]:
    """Shortest unique name of the folder of each session."""
    parents = [path.resolve().parent for path in paths]
    different = set(parents)
    for parts in range(1, max((len(parent.parts) for parent in parents), default=1) + 1):
        short = {parent: "/".join(parent.parts[-parts:]) for parent in different}
        if len(set(short.values())) == len(different):
            break
    return [short[parent] for parent in parents]


def digest_of(path: Path) -> str:
    """SHA-256 of the content of a file."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _warnings(source: Source, reference: Reference) -> Iterator[str]:
    missing = float(np.mean(~np.isfinite(reference.reference_deg)))
    if missing > MISSING_SHARE:
        yield f"{reference.name}: {missing:.0%} of its encoder values are not numbers and are ignored"
    if np.nanmax(reference.reference_deg) == np.nanmin(reference.reference_deg):
        if _has_moved(reference):
            raise DataError(
                f"{source.path}: its encoder never moves, but its rate shows motion; "
                "connect the encoder, or give --still if the device did not move"
            )
        yield f"{reference.name}: its encoder never moves, so the device is assumed to be still"


def _has_moved(reference: Reference) -> bool:
    size = max(1, round(reference.sample_rate_hz))
    seconds = blocks_of(reference.rate_dps, size).mean(axis=1)
    return len(seconds) > 1 and float(np.ptp(seconds)) > MOVES_DPS


def rates_differ(rates_hz: Sequence[float]) -> bool:
    """Whether sample rates differ by more than `RATE_TOLERANCE`."""
    return max(rates_hz) > min(rates_hz) * (1.0 + RATE_TOLERANCE)


def check_rates(sessions: Sequence[SessionSummary], sample_counted: str) -> list[str]:
    """Warning if sample rates differ, since some parameters count samples; empty if they are equal."""
    rates = [session.sample_rate_hz for session in sessions]
    if not rates_differ(rates):
        return []
    low, high = sessions[int(np.argmin(rates))], sessions[int(np.argmax(rates))]
    ends = f"from {min(rates):.4g} Hz ({low.name}) to {max(rates):.4g} Hz ({high.name})"
    why = f"{sample_counted} count samples, so the tuned parameters fit none of these rates; tune each rate separately"
    return [f"sample rates differ, {ends}: {why}"]


def split_sources(sources: Sequence[Source], seed: int) -> list[Source]:
    """Sources with their use: training or test.

    With test sessions, all other sessions are for training. Without test sessions, a random share is held out, drawn
    with the seed. Of at most `CROSS_VALIDATED` sessions none is held out.

    Raises
    ------
    DataError
        If no session is left to train with, or there is only one session.
    """
    given = [source for source in sources if source.split is Split.TEST]
    free = [source for source in sources if source.split is None]
    if not free:
        raise DataError("there are no sessions to tune on; --test holds out all of them")
    if given:
        return [replace(s, split=s.split or Split.TRAIN) for s in sources]
    if len(free) == 1:
        raise DataError(
            f"{free[0].path}: is the only session, so none can be held out to test the parameters; "
            "record another session, or give one with --test"
        )
    if len(free) <= CROSS_VALIDATED:
        return [replace(s, split=Split.TRAIN) for s in sources]
    tests = np.random.default_rng(seed).permutation(len(free))[: round(TEST_SHARE * len(free))]
    splits = [Split.TEST if index in tests else Split.TRAIN for index in range(len(free))]
    return [replace(s, split=split) for s, split in zip(free, splits, strict=True)]


@dataclass(frozen=True, slots=True)
class YawCurves:
    """Times in minutes and reference in deg, shape (m,), and yaw of k methods in deg, shape (k, m)."""

    minutes: Floats
    reference_deg: Floats
    yaw_deg: Floats

    @property
    def errors_deg(self) -> Floats:
        """Yaw minus reference, deg, shape (k, m)."""
        return self.yaw_deg - self.reference_deg


def yaw_curves(loaded: LoadedSession, yaws_deg: Sequence[Floats], max_samples: int) -> YawCurves:
    """Yaws of a session, of shape (n,), thinned to at most `max_samples` samples."""
    rows = loaded.reference.thinned(max_samples)
    minutes = (loaded.t_s[rows] - loaded.t_s[0]) / 60.0
    return YawCurves(minutes, loaded.reference.reference_deg[rows], np.array([yaw_deg[rows] for yaw_deg in yaws_deg]))
