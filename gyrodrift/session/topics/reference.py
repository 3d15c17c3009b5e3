"""A session with the reference angle of another topic of its recording."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from gyrodrift.session.session import Session
from gyrodrift.session.topics.messages import JOINTS, AngleReading
from gyrodrift.session.topics.recordings import angle_readings, angle_topics, is_with_topics
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError, UsageError

LEAST_READINGS = 3
"""Least number of readings that tell the rate at which a reading is moved to its sample."""


def with_reference(session: Session, path: Path, topic: str) -> Session:
    """A session with the angle of a topic of its recording, in each sample that is the nearest to a reading.

    The angle is moved from the time of the reading to that of the sample, by half a sample at most. Samples without a
    reading have no angle. The stamps of both topics count, or the times of logging if the stamps are of two clocks.
    A table keeps the angle that it has.

    Parameters
    ----------
    session, path
        The session, and the recording that it comes from.
    topic
        Name of the topic, and of a joint behind a colon.

    Raises
    ------
    UsageError
        The recording is a table without an angle, and has no topics.
    DataError
        The topic has no reference angle, or none at the time of the samples.
    """
    if not is_with_topics(path) and session.encoder_deg is None:
        raise UsageError(f"--reference: {path} has no topics; name the angle of a table with --columns")
    if not is_with_topics(path):
        return replace(session, remarks=(*session.remarks, f"it has no topic {topic}: its own angle is the reference"))
    name, _, joint = topic.partition(":")
    kind, readings = angle_readings(path, name, joint)
    if len(readings) < LEAST_READINGS:
        raise DataError(f"{path}: has {len(readings)} messages on {name}; a reference needs {LEAST_READINGS}")
    t_s, remark = _times_of(session, readings)
    t_s, first = np.unique(t_s, return_index=True)
    angle_deg = np.array([reading.angle_deg for reading in readings])[first]
    if kind != JOINTS:  # a heading ends at 180 degrees, and the position of a joint counts its turns
        angle_deg = np.unwrap(angle_deg, period=360.0)
    encoder_deg = at_samples(session.t_device_s, t_s, angle_deg) if len(t_s) >= LEAST_READINGS else np.array([np.nan])
    if not np.isfinite(encoder_deg).any():
        raise DataError(f"{path}: the messages on {name} are not from the time of its samples")
    what = f"its reference angle is that of {topic} ({kind})"
    return replace(session, encoder_deg=encoder_deg, remarks=(*session.remarks, what + remark))


def at_samples(t_s: Floats, read_s: Floats, angle_deg: Floats) -> Floats:
    """(n,) angles at the times of samples, from (k,) rising times of readings; NaN without a reading so near."""
    period_s = float(np.median(np.diff(t_s))) if len(t_s) > 1 else 0.0
    after = np.clip(np.searchsorted(read_s, t_s), 1, len(read_s) - 1)
    nearest = np.where(t_s - read_s[after - 1] < read_s[after] - t_s, after - 1, after)
    since_s = t_s - read_s[nearest]
    moved_deg = angle_deg[nearest] + np.gradient(angle_deg, read_s)[nearest] * since_s
    sample_deg: Floats = np.where(np.abs(since_s) <= 0.5 * period_s, moved_deg, np.nan)
    return sample_deg


def question_of(path: Path) -> str:
    """How to name the reference of a recording: its topics with an angle; empty without any."""
    topics = angle_topics(path) if is_with_topics(path) else []
    return f"choose its reference with --reference TOPIC: {', '.join(topics)}" if topics else ""


def _times_of(session: Session, readings: Sequence[AngleReading]) -> tuple[Floats, str]:
    """Times of the readings by the clock of the samples, s, and a remark if they are not their stamps."""
    stamp_s = np.array([reading.stamp_s for reading in readings])
    if (stamp_s.max() > session.t_device_s[0] and stamp_s.min() < session.t_device_s[-1]) or session.t_host_s is None:
        return stamp_s, ""
    logged_s = np.array([reading.logged_s for reading in readings])
    is_inside = (logged_s >= session.t_host_s[0]) & (logged_s <= session.t_host_s[-1])
    t_s = np.where(is_inside, np.interp(logged_s, session.t_host_s, session.t_device_s), stamp_s)
    return t_s, ", by the times of logging: its stamps are of another clock"
