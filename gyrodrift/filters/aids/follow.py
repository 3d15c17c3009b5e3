"""The second sources of a running filter: each measurement is taken once the samples have reached its time.

Until all sources have been right for long, the filter runs a second time without them. If one has to be left out
before, the filter goes on from there: what it had believed of that source is gone.
"""

from copy import deepcopy
from math import inf, isfinite, isnan, nan
from typing import Any

from gyrodrift.filters.aids.errors import ScaleError
from gyrodrift.filters.aids.heading import HeadingSource
from gyrodrift.filters.aids.motion import HISTORY_S, RecentMotion
from gyrodrift.filters.aids.reading import AidedFilter
from gyrodrift.filters.aids.standing import RestReports
from gyrodrift.filters.aids.turn_rate import RateSource
from gyrodrift.values.aid import Aid, AidStatus

MOST_WAITING = 1000
"""Largest number of measurements that wait for the samples of their time. Chosen."""


class Aids:
    """Second sources of one filter.

    scale
        Scale error of the gyro; the filter gets its rates without it.
    plain, plain_scale
        State of the filter without the sources, and the scale error of its rates; None while all sources are proven.
    is_contradicted
        A source that may have misled the filter is left out: the filter has to go on from `plain`.
    """

    def __init__(self) -> None:
        self.scale = ScaleError()
        self.plain: Any = None
        self.plain_scale = 0.0
        self.is_contradicted = False
        self._heard_s: dict[str, float] = {}
        self._sources: dict[str, HeadingSource | RateSource] = {}
        self._rests: dict[str, RestReports] = {}
        self._waiting: list[Aid] = []
        self._motion = RecentMotion()
        self._yaw_deg, self._now_s = nan, -inf

    @property
    def status(self) -> dict[str, AidStatus]:
        """How each source agrees, by its name."""
        result = {}
        for name, heard_s in self._heard_s.items():
            age_s, source = max(0.0, self._now_s - heard_s), self._sources.get(name)
            trust = None if source is None else source.trust
            weight = 1.0 if trust is None else 0.0 if trust.differs else trust.weight
            result[name] = AidStatus(age_s, weight, "" if trust is None else trust.differs)
        return result

    def take(self, aid: Aid) -> None:
        """Add a measurement."""
        if not isfinite(aid.value):
            return
        aid = aid if isfinite(aid.t_s) else aid._replace(t_s=self._now_s)
        self._heard_s[aid.name] = max(aid.t_s, self._heard_s.get(aid.name, -inf))
        if aid.kind in ("standing", "speed", "wheels"):
            self._rests.setdefault(aid.name, RestReports()).hear(aid)
        if aid.kind not in ("standing", "speed"):
            self._waiting = [*self._waiting[1 - MOST_WAITING :], aid]

    def still(self, t_s: float) -> float:
        """Report of rest at a time: 1, 0 in motion, NaN if unknown."""
        reports = [source.report_at(t_s) for source in self._rests.values()]
        return 0.0 if 0.0 in reports else 1.0 if 1.0 in reports else nan

    def follow(self, aided: AidedFilter | None, c: Any, s: Any, t_s: float) -> None:
        """Follow the filter after a sample, and let it take the measurements whose time has come."""
        step_s, self._now_s = t_s - self._now_s, t_s
        if aided is None:
            self._waiting = []
            return
        if step_s < 0.0:  # the clock has restarted
            self._waiting = [aid._replace(t_s=t_s) for aid in self._waiting]
            self.scale.motion_deg = 0.0
        turn_deg = 0.0 if isnan(self._yaw_deg) else s.yaw_deg - self._yaw_deg - s.correction_deg
        self._motion.add(t_s, aided.rate_dps(s), turn_deg, is_gap=step_s > s.watch.longest_step_s)
        self._yaw_deg = s.yaw_deg
        if self._waiting and aided.has_block_ended(s):
            self._measure_all(aided, c, s)

    def forget(self) -> None:
        """Forget what sources have learned from a filter that was misled; it goes on from `plain`."""
        self.is_contradicted, self._yaw_deg = False, self.plain.yaw_deg
        self.scale = ScaleError(self.plain_scale, motion_deg=self._motion.turn_deg)
        self.plain = None
        for source in self._sources.values():
            if source.trust.differs == "":
                source.forget()

    def _measure_all(self, aided: AidedFilter, c: Any, s: Any) -> None:
        """Measure all that is due; what is older than the known motion is lost."""
        now_s, from_s = self._now_s, self._motion.from_s
        due = [aid for aid in self._waiting if aid.t_s <= now_s]
        self._waiting = [aid for aid in self._waiting if now_s < aid.t_s <= now_s + HISTORY_S]
        if self.plain is None and (self._has_trial or not all(aid.name in self._sources for aid in due)):
            self.plain, self.plain_scale = deepcopy(s), self.scale.mean
        for aid in due:
            if aid.t_s == -inf or aid.t_s >= from_s:
                self._measure(aided, c, s, aid._replace(t_s=max(aid.t_s, from_s)))
        self._yaw_deg = s.yaw_deg
        if not (self._has_trial or self.is_contradicted):
            self.plain = None

    @property
    def _has_trial(self) -> bool:
        return any(source.trust.is_on_trial for source in self._sources.values())

    def _measure(self, aided: AidedFilter, c: Any, s: Any, aid: Aid) -> None:
        is_heading = aid.kind == "heading"
        source = self._sources.setdefault(
            aid.name, HeadingSource() if is_heading else RateSource(is_wheels=aid.kind == "wheels")
        )
        was_on_trial = source.trust.is_on_trial
        if isinstance(source, HeadingSource) and is_heading:
            source.measure(aided, c, s, aid, self._motion, self.scale)
        elif isinstance(source, RateSource) and not is_heading:
            source.measure(aided, c, s, aid, self._motion)
        self.is_contradicted = self.is_contradicted or (was_on_trial and source.trust.differs != "")
