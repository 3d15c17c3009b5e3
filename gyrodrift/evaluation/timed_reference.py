"""A session to be compared on: its course as tuning sees it, with the times, and the folder it belongs to."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.dataset import About, Source, course_and_about
from gyrodrift.evaluation.reference import Course, accepted
from gyrodrift.session.files import load_session


@dataclass(frozen=True, slots=True)
class TimedReference:
    """What a method is run on and judged by.

    t_s
        Device times of the course's samples, s, shape (n,).
    """

    t_s: Floats
    course: Course
    about: About


def load_timed_reference(source: Source) -> TimedReference:
    """Read a session; the first sample is the first one with a reference, as in `Course`.

    Raises
    ------
    DataError
        With its path, where it cannot be read or has no reference.
    """
    session = load_session(source.path)
    course, about = course_and_about(source, session)
    taken_s = session.t_device_s[accepted(session.t_device_s, session.rate_dps)]
    return TimedReference(taken_s[-len(course.dt_s) :], course, about)


def folder_names(paths: Sequence[Path]) -> list[str]:
    """The folder that each session lies in, by as little of its path as tells it from the others."""
    parents = [path.resolve().parent for path in paths]
    different = set(parents)
    for parts in range(1, max((len(parent.parts) for parent in parents), default=1) + 1):
        short = {parent: "/".join(parent.parts[-parts:]) for parent in different}
        if len(set(short.values())) == len(different):
            break
    return [short[parent] for parent in parents]
