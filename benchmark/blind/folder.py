"""The folder of a set: where plan, hashes, seals, results and the log of openings are."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from gyrogap.json_files import write_json
from gyrogap.seals import HASHES, open_seal


@dataclass(frozen=True, slots=True)
class PlannedCase:
    """What is public of a case: its name, and what a second run is to withhold or is of (empty: there is none)."""

    name: str
    withhold: str
    then: str = ""


@dataclass(frozen=True, slots=True)
class Plan:
    """The seed of the set, and the cases in the order of their names."""

    seed: int
    cases: tuple[PlannedCase, ...]


@dataclass(frozen=True, slots=True)
class SetFolder:
    """Paths, and JSON that is written whole or not at all."""

    root: Path

    @property
    def seals(self) -> Path:
        """Labels and salts, a file for each case."""
        return self.root / "seals"

    def result(self, case: str, run: str) -> Path:
        """What came of one run."""
        return self.root / "results" / f"{case}-{run}.json"

    def kept(self, case: str) -> Path:
        """Where the sessions go that are to be kept."""
        return self.root / "kept" / case

    def open_seal(self, case: str, why: str) -> dict[str, Any]:
        """Label of a case; the opening is logged."""
        return open_seal(self.root, self.seals, case, why)

    def hashes(self) -> dict[str, str]:
        """Hash of salt and label by case; none before anything is sealed."""
        path = self.root / HASHES
        read: dict[str, str] = json.loads(path.read_text()) if path.is_file() else {}
        return read

    def is_planned(self) -> bool:
        """Whether the set has been sealed: the plan is written last."""
        return (self.root / "plan.json").is_file()

    def plan(self) -> Plan:
        """Read it."""
        read = json.loads((self.root / "plan.json").read_text())
        cases = tuple(PlannedCase(case["case"], case["withhold"], case["then"]) for case in read["cases"])
        return Plan(read["seed"], cases)

    def write_plan(self, plan: Plan) -> None:
        """Write it."""
        cases = [{"case": case.name, "withhold": case.withhold, "then": case.then} for case in plan.cases]
        self.write("plan.json", {"seed": plan.seed, "cases": cases})

    def write(self, name: str, value: Any) -> None:
        """JSON under a name."""
        write_json(self.root / name, value)
