"""Where the parameters of a config come from: what `tune` wrote beside them, read back."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml

from gyrodrift.evaluation.dataset import Split


@dataclass(frozen=True, slots=True)
class TunedSession:
    """A session that a config was tuned on or tested with, and the SHA-256 of its content."""

    name: str
    split: Split
    sha256: str


@dataclass(frozen=True, slots=True)
class TuningProvenance:
    """What a config says of the tuning that found its parameters.

    filter
        Name of the filter that was tuned.
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
    """Of a config file that has been checked; None where no tuning is told of."""
    content = yaml.safe_load(path.read_text(encoding="utf-8"))
    told = content.get("provenance") if isinstance(content, dict) else None
    if not isinstance(told, dict):
        return None
    sessions = tuple(filter(None, map(_session, _list(told.get("sessions")))))
    named = told.get("filter", content.get("filter"))
    if not sessions or not isinstance(named, str):
        return None
    seed, iterations = told.get("seed"), told.get("iterations")
    return TuningProvenance(
        filter=named,
        sessions=sessions,
        command=str(told.get("command", "")),
        seed=seed if isinstance(seed, int) else None,
        iterations=iterations if isinstance(iterations, int) else None,
        is_default=told.get("parameters") == "defaults",
    )


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []


def _session(told: Any) -> TunedSession | None:
    """None of what a person has written in another form."""
    if not isinstance(told, Mapping) or told.get("split") not in {split.value for split in Split}:
        return None
    return TunedSession(str(told.get("name", "")), Split(told["split"]), str(told.get("sha256", "")))
