"""Differences of two sets of recordings: sample rates, columns and steps. A missing column is no gap.

Sessions of another simulator often lack arrival times, a counter and a temperature, and have exact angles.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from gyrodrift.diagnose.recording.levels import has_steps
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.session.checks.stated import COUNTER, HOST_TIMES, TEMPERATURE

HAS: Mapping[str, Callable[[Recording], bool]] = MappingProxyType(
    {
        COUNTER: lambda recording: recording.has_counter,
        HOST_TIMES: lambda recording: recording.host_s is not None,
        TEMPERATURE: lambda recording: recording.temp_c is not None,
    }
)
"""Optional columns of a session, with a test whether a recording has them."""

STEPS: Mapping[str, Callable[[Recording], bool]] = MappingProxyType(
    {
        "steps of the rate": lambda recording: has_steps(recording.rate_dps),
        "steps of the encoder": lambda recording: has_steps(recording.encoder_deg),
    }
)
"""Steps of rate and angle, with a test whether a recording has them. Exact values of a simulator have none."""


SAME_RATE = 0.1
"""Largest relative difference of the sample rates, and of the measured steps, of a device from day to day. Chosen: a
PLL is good to 1 %, but a radio that loses some samples is not."""


def is_same_rate(first: Sequence[Recording], second: Sequence[Recording]) -> bool:
    """Whether the median sample rates of two sets agree within SAME_RATE."""
    before_hz, after_hz = rates_hz(first, second)
    return abs(before_hz / after_hz - 1.0) <= SAME_RATE


def rates_hz(*sets: Sequence[Recording]) -> list[float]:
    """Median sample rate of each set, Hz."""
    return [1.0 / float(np.median([recording.period_s for recording in recordings])) for recordings in sets]


@dataclass(frozen=True, slots=True)
class LackingValues:
    """Names of columns and steps that at least one recording of a set lacks, for the sessions and the baseline."""

    sessions: tuple[str, ...]
    baseline: tuple[str, ...]

    @property
    def of_one_set(self) -> frozenset[str]:
        """Columns that are complete in exactly one of the two sets and are not compared."""
        differ = (frozenset(self.sessions) ^ frozenset(self.baseline)) & HAS.keys()
        return differ - {TEMPERATURE} if self.has_constant_temperature else differ

    @property
    def has_constant_temperature(self) -> bool:
        """Whether the baseline lacks the temperature of the sessions, as that of any simulator: it is constant then."""
        return TEMPERATURE in self.baseline and TEMPERATURE not in self.sessions

    @property
    def remarks(self) -> list[str]:
        """Sentences on the columns that are not compared, and on a temperature that counts as constant."""
        remarks = []
        if self.has_constant_temperature:
            remarks.append("baseline: it has no temperature, which counts as constant, as in a simulator")
        for of_set, says in ((self.baseline, "the baseline lacks it"), (self.sessions, "the sessions lack it")):
            names = " and ".join(name for name in HAS if name in self.of_one_set & frozenset(of_set))
            if names:
                remarks.append(f"baseline: only one of both sets has {names}: this is no gap, and not compared; {says}")
        return remarks

    def lacks_in_baseline(self, name: str) -> bool:
        """Whether only the baseline lacks a column that is not compared."""
        return name in self.of_one_set and name in self.baseline


def lacking_values(sessions: Sequence[Recording], baseline: Sequence[Recording]) -> LackingValues:
    """Columns and steps that the sessions, and the baseline, lack."""
    return LackingValues(_lacking(sessions), _lacking(baseline))


def _lacking(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Columns and steps that at least one of some recordings lacks."""
    return tuple(name for name, has in {**HAS, **STEPS}.items() if not all(map(has, recordings)))
