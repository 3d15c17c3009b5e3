"""The sessions of a tuning: which there are, whether they can be used, and which are kept apart."""

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

import numpy as np

from gyrodrift.errors import DataError
from gyrodrift.evaluation.reference import Course, course_of
from gyrodrift.session.files import load_session
from gyrodrift.session.session import Session

FEW = 5
"""Up to so many sessions none is kept apart: each is tested with parameters tuned on the others."""

TEST_SHARE = 0.3
RATE_TOLERANCE = 0.02
MISSING_SHARE = 0.01

MOVES_DPS = 3.0
"""A device whose rate, averaged over a second, varies by more than this did move."""


class Split(Enum):
    """What a session was used for."""

    TRAIN = "train"
    TEST = "test"


@dataclass(frozen=True, slots=True)
class Source:
    """A session that is to be used; `split` is None where nobody has said for what."""

    path: Path
    is_still: bool = False
    split: Split | None = None


@dataclass(frozen=True, slots=True)
class About:
    """What is known of a session without holding it.

    odd
        What is strange about it, a sentence each.
    """

    name: str
    digest: str
    minutes: float
    sample_rate_hz: float
    odd: tuple[str, ...] = ()


def load_course(source: Source) -> tuple[Course, About]:
    """A session as a course.

    Raises
    ------
    DataError
        With its path, where it cannot be read or has no reference.
    """
    return course_and_about(source, load_session(source.path))


def course_and_about(source: Source, session: Session) -> tuple[Course, About]:
    """The course of a session that has been read from a source.

    Raises
    ------
    DataError
        With its path, where it has no reference.
    """
    try:
        course = course_of(session, is_still=source.is_still)
    except DataError as error:
        raise DataError(f"{source.path}: {str(error).removeprefix(f'{session.name}: ')}") from error
    odd = () if source.is_still else tuple(_oddities(source, session, course))
    return course, About(course.name, digest_of(source.path), course.minutes, course.sample_rate_hz, odd)


def digest_of(path: Path) -> str:
    """SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def _oddities(source: Source, session: Session, course: Course) -> Iterator[str]:
    missing = float(np.mean(~np.isfinite(course.reference_deg)))
    if missing > MISSING_SHARE:
        yield f"{session.name}: {missing:.0%} of its encoder values are no numbers; they do not count"
    if np.nanmax(course.reference_deg) == np.nanmin(course.reference_deg):
        if _has_moved(course):
            raise DataError(
                f"{source.path}: its encoder never moves while the rate says that the device does; "
                "is the encoder connected? A still goes with --still"
            )
        yield f"{session.name}: its encoder never moves, so it counts as a still"


def _has_moved(course: Course) -> bool:
    size = max(1, round(course.sample_rate_hz))
    seconds = course.rate_dps[: len(course.rate_dps) // size * size].reshape(-1, size).mean(axis=1)
    return len(seconds) > 1 and float(np.ptp(seconds)) > MOVES_DPS


def rates_differ(rates_hz: Sequence[float]) -> bool:
    """Whether sample rates differ by more than crystals do."""
    return max(rates_hz) > min(rates_hz) * (1.0 + RATE_TOLERANCE)


def check_rates(sessions: Sequence[About]) -> list[str]:
    """A warning where sample rates differ, for parameters that count samples: they belong to one rate."""
    rates = [about.sample_rate_hz for about in sessions]
    if not rates_differ(rates):
        return []
    low, high = sessions[int(np.argmin(rates))], sessions[int(np.argmax(rates))]
    ends = f"from {min(rates):.4g} Hz ({low.name}) to {max(rates):.4g} Hz ({high.name})"
    why = "i_c_dps and the attenuator count samples, so these parameters fit none of them; tune each rate by itself"
    return [f"sample rates differ, {ends}: {why}"]


def split_sources(sources: Sequence[Source], seed: int) -> list[Source]:
    """Each source with what it is used for.

    Where some are said to be tests, the others train. Otherwise a share drawn by the seed is kept apart, and of a few
    none is.

    Raises
    ------
    DataError
        Where none is left to train with, or one session alone.
    """
    said = [source for source in sources if source.split is Split.TEST]
    free = [source for source in sources if source.split is None]
    if not free:
        raise DataError("there are no sessions to tune with; all are kept apart by --test")
    if said:
        return [Source(s.path, s.is_still, s.split or Split.TRAIN) for s in sources]
    if len(free) == 1:
        raise DataError(
            f"{free[0].path}: is the only session, so none can be kept apart to show what the parameters are worth; "
            "record another one, or give one with --test"
        )
    if len(free) <= FEW:
        return [Source(s.path, s.is_still, Split.TRAIN) for s in sources]
    tests = np.random.default_rng(seed).permutation(len(free))[: round(TEST_SHARE * len(free))]
    splits = [Split.TEST if number in tests else Split.TRAIN for number in range(len(free))]
    return [Source(s.path, s.is_still, split) for s, split in zip(free, splits, strict=True)]
