"""Values that recordings lack beside others: what only one of two sets has is no difference between them.

Sessions of another simulator often have neither arrival times nor a counter nor a temperature, and exact angles.
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
"""Columns that a session may lack, and whether a recording has them."""

STEPS: Mapping[str, Callable[[Recording], bool]] = MappingProxyType(
    {
        "steps of the rate": lambda recording: has_steps(recording.rate_dps),
        "steps of the encoder": lambda recording: has_steps(recording.encoder_deg),
    }
)
"""Steps in which values come; numbers of a simulator have none."""


@dataclass(frozen=True, slots=True)
class LackingValues:
    """Values that some of the sessions, or some of the baseline, do not have."""

    sessions: tuple[str, ...]
    baseline: tuple[str, ...]

    @property
    def of_one_set(self) -> frozenset[str]:
        """Columns that only one of both sets has in each recording; they are not compared."""
        return (frozenset(self.sessions) ^ frozenset(self.baseline)) & HAS.keys()

    @property
    def remarks(self) -> list[str]:
        """A sentence on the columns that are left out."""
        left_out = [name for name in HAS if name in self.of_one_set]
        if not left_out:
            return []
        return [f"baseline: only one of both sets has {' and '.join(left_out)}: this is no gap, and not compared"]


def lacking_values(sessions: Sequence[Recording], baseline: Sequence[Recording]) -> LackingValues:
    """Values that each set lacks."""
    return LackingValues(_lacking(sessions), _lacking(baseline))


def _lacking(recordings: Sequence[Recording]) -> tuple[str, ...]:
    return tuple(name for name, has in {**HAS, **STEPS}.items() if not all(map(has, recordings)))
