"""Columns and steps that one of two sets of recordings lacks. A missing column is no gap, so it is not compared.

Sessions of another simulator often lack arrival times, a counter and a temperature, and have exact angles.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

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


@dataclass(frozen=True, slots=True)
class LackingValues:
    """Names of columns and steps that at least one recording of a set lacks, for the sessions and the baseline."""

    sessions: tuple[str, ...]
    baseline: tuple[str, ...]

    @property
    def of_one_set(self) -> frozenset[str]:
        """Columns that are complete in exactly one of the two sets; they are not compared."""
        return (frozenset(self.sessions) ^ frozenset(self.baseline)) & HAS.keys()

    @property
    def remarks(self) -> list[str]:
        """Sentence on the columns that are not compared; empty without such a column."""
        not_compared = [name for name in HAS if name in self.of_one_set]
        if not not_compared:
            return []
        return [f"baseline: only one of both sets has {' and '.join(not_compared)}: this is no gap, and not compared"]


def lacking_values(sessions: Sequence[Recording], baseline: Sequence[Recording]) -> LackingValues:
    """Columns and steps that the sessions, and the baseline, lack."""
    return LackingValues(_lacking(sessions), _lacking(baseline))


def _lacking(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Columns and steps that at least one of some recordings lacks."""
    return tuple(name for name, has in {**HAS, **STEPS}.items() if not all(map(has, recordings)))
