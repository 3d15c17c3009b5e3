"""A case of a row: what is sealed of it, and the folders that it is written to."""

from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass, field
from hashlib import blake2b
from pathlib import Path
from typing import Any, Protocol

from gyrogap.physics.dice import Path as DicePath
from gyrogap.physics.kinds import InjectedEffect


class Part(Protocol):
    """Sessions that can be written to a folder, which is made."""

    def write(self, folder: Path) -> None:
        """Write them."""


@dataclass(frozen=True, slots=True)
class Draft:
    """What a row decides of a case.

    kind
        By which rule it is judged.
    rig
        The rig file.
    parts
        Sessions by the name of their folder.
    faults
        What is put in, beside what the rig states.
    stages
        Which stage of the rig would be a right answer.
    withhold
        What a second run must do without.
    then
        Folder of a second run: `without`, `again`, or none.
    facts
        For the label: whatever the case depends on.
    yaw_cost_deg
        For the label, too, where it is asked for: what the faults cost. All sessions are made for it, twice.
    """

    kind: str
    rig: str
    parts: Mapping[str, Part]
    faults: tuple[InjectedEffect, ...] = ()
    size: str = ""
    stages: tuple[str, ...] = ()
    about: str = ""
    withhold: str = ""
    then: str = ""
    facts: Mapping[str, Any] = field(default_factory=dict)
    yaw_cost_deg: Callable[[], float] | None = None


def path_of(seed: int, row: str, number: int) -> DicePath:
    """Where the random numbers of a case are found."""
    return ("bench", seed, row, number)


def name_of(seed: int, row: str, number: int) -> str:
    """Of a case, in public: letters that tell nothing."""
    return blake2b("/".join(map(str, (*path_of(seed, row, number), "name"))).encode(), digest_size=6).hexdigest()


@dataclass(frozen=True, slots=True)
class RowCase:
    """A case, decided."""

    seed: int
    row: str
    number: int
    draft: Draft

    @property
    def name(self) -> str:
        """In public."""
        return name_of(self.seed, self.row, self.number)

    @property
    def title(self) -> str:
        """Among those who know: `single/12/latency/typical`."""
        what = "+".join(fault.name for fault in self.draft.faults) or "nothing"
        return "/".join([self.row, str(self.number), what, self.draft.size]).strip("/")

    def label(self) -> dict[str, Any]:
        """All that is sealed."""
        draft = self.draft
        costs = {} if draft.yaw_cost_deg is None else {"yaw_cost_deg": draft.yaw_cost_deg()}
        return {
            "case": self.name,
            "seed": self.seed,
            "row": self.row,
            "number": self.number,
            "kind": draft.kind,
            "size": draft.size,
            "effects": [asdict(fault) for fault in draft.faults],
            "stages": list(draft.stages),
            "about": draft.about,
            "withhold": draft.withhold,
            "then": draft.then,
            "rig": draft.rig,
            **draft.facts,
            **costs,
        }

    def write(self, folder: Path) -> None:
        """The case as files; the same case gives the same bytes."""
        folder.mkdir(parents=True)
        (folder / "rig.yaml").write_text(self.draft.rig)
        for name, part in self.draft.parts.items():
            part.write(folder / name)
