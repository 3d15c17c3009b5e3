"""A case after its seal was opened: the truth beside what was said."""

from dataclasses import dataclass
from typing import Any

from gyrogap.catalogue import EFFECTS

from blind.folder import SetFolder
from blind.gap import Outcome, load_json, read_outcome

RUNS = ("blind", "withheld", "without", "again", "oracle")


@dataclass(frozen=True, slots=True)
class Tried:
    """One case.

    truths
        Effects of the catalogue that are in it, with their parameters.
    stages
        Where a right answer may say it is.
    outcomes
        By run; one that was never made is a failure.
    row, number
        Of a set that has rows, else empty.
    yaw_cost_deg
        Mean absolute yaw that what is in it costs; None where that was not asked for.
    """

    name: str
    kind: str
    size: str
    about: str
    truths: dict[str, dict[str, float]]
    stages: tuple[str, ...]
    withhold: str
    put_in: str
    outcomes: dict[str, Outcome]
    row: str = ""
    seed: int = 0
    number: int = 0
    yaw_cost_deg: float | None = None

    @property
    def id(self) -> str:
        """What to ask for it by, and in a set of rows where it comes from."""
        return f"{self.name} (seed {self.seed}, {self.row}/{self.number})" if self.row else self.name

    @property
    def blind(self) -> Outcome:
        """The run that knew nothing and could name anything."""
        return self.outcomes["blind"]

    @property
    def truth(self) -> str:
        """The only effect of a case that has one."""
        return next(iter(self.truths))

    @property
    def strength(self) -> dict[str, float]:
        """Its parameters."""
        return self.truths[self.truth]


def tried_of(label: dict[str, Any], outcomes: dict[str, Outcome]) -> Tried:
    """A case from its label."""
    effects = label["effects"]
    texts = [
        f"{effect['name']} ({', '.join(f'{key} {value:g}' for key, value in effect['parameters'].items())})"
        for effect in effects
    ]
    return Tried(
        name=label["case"],
        kind=label["kind"],
        size=label["size"],
        about=label["about"],
        truths={effect["name"]: effect["parameters"] for effect in effects if effect["name"] in EFFECTS},
        stages=tuple(label["stages"]),
        withhold=label["withhold"],
        put_in=" and ".join(texts) or "no gap",
        outcomes=outcomes,
        row=label.get("row", ""),
        seed=label.get("seed", 0),
        number=label.get("number", 0),
        yaw_cost_deg=label.get("yaw_cost_deg"),
    )


def open_all(folder: SetFolder) -> list[Tried]:
    """Open every seal of a set and put the results beside the labels."""
    tried = []
    for case in folder.plan().cases:
        label = folder.open_seal(case.name, "score")
        outcomes = {run: read_outcome(load_json(folder.result(case.name, run))) for run in RUNS}
        tried.append(tried_of(label, outcomes))
    return tried
