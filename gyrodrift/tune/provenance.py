"""Read the provenance block that `tune` writes into a config."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from gyrodrift.evaluation.dataset import Split


@dataclass(frozen=True, slots=True)
class TunedSession:
    """A training or test session of a tuning, with the SHA-256 of its content."""

    name: str
    split: Split
    sha256: str


@dataclass(frozen=True, slots=True)
class TuningProvenance:
    """Provenance of the parameters of a config.

    filter
        Name of the tuned filter.
    command, seed, iterations
        As they were given; empty and None if the file does not say.
    is_default
        The parameters are the filter's defaults, which no tuned parameters beat on held-out sessions.
    """

    filter: str
    sessions: tuple[TunedSession, ...]
    command: str = ""
    seed: int | None = None
    iterations: int | None = None
    is_default: bool = False

    @property
    def training(self) -> tuple[TunedSession, ...]:
        """Sessions that the parameters depend on: the training sessions, or none for defaults."""
        if self.is_default:
            return ()
        return tuple(session for session in self.sessions if session.split is Split.TRAIN)


def read_provenance(path: Path) -> TuningProvenance | None:
    """Provenance of a checked config file; None without a tuning."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    block = content.get("provenance") if isinstance(content, dict) else None
    if not isinstance(block, dict):
        return None
    sessions = tuple(filter(None, map(_session, _list(block.get("sessions")))))
    named = block.get("filter", content.get("filter"))
    if not sessions or not isinstance(named, str):
        return None
    seed, iterations = block.get("seed"), block.get("iterations")
    return TuningProvenance(
        filter=named,
        sessions=sessions,
        command=str(block.get("command", "")),
        seed=seed if isinstance(seed, int) else None,
        iterations=iterations if isinstance(iterations, int) else None,
        is_default=block.get("parameters") == "defaults",
    )


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _session(entry: Any) -> TunedSession | None:
    """A session entry; None if it has another form."""
    if not isinstance(entry, Mapping) or entry.get("split") not in {split.value for split in Split}:
        return None
    return TunedSession(str(entry.get("name", "")), Split(entry["split"]), str(entry.get("sha256", "")))
