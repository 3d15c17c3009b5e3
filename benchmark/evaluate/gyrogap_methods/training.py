"""Training cases for methods that learn: features and labels of cases of other seeds, drawn by the benchmark itself.

    python -m benchmark evaluate.gyrogap_methods.training FILE --seeds 9001,9002

This favors the methods: they learn from the generator that makes the test cases. FILE grows by a line per case.
"""

import argparse
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import yaml
from gyrogap.rows import ROWS, draw_case

from evaluate.gyrogap_methods.cases import Features, case_features


@dataclass(frozen=True, slots=True)
class TrainingCase:
    """Features of a case, with its row and its effects."""

    row: str
    effects: dict[str, dict[str, float]]
    features: Features


def read_training(path: Path) -> list[TrainingCase]:
    """All cases of a file."""
    lines = (json.loads(line) for line in path.read_text().splitlines())
    return [TrainingCase(line["row"], line["effects"], line["features"]) for line in lines]


def training_line(seed: int, row: str, number: int) -> dict[str, Any]:
    """Row, effects and features of a case; nothing is written to disk."""
    case = draw_case(seed, row, number)
    batch = case.recorded()
    sessions = [batch.columns(index) for index in range(len(batch.plans))]
    features = case_features(sessions, yaml.safe_load(case.stand.rig_text))
    effects = {effect.name: effect.parameters for effect in case.effects}
    return {"seed": seed, "row": row, "number": number, "effects": effects, "features": features}


def main() -> None:
    """Add the cases of all rows of each seed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("file", type=Path)
    parser.add_argument("--seeds", required=True, help="seeds, with commas; not those of the test")
    arguments = parser.parse_args()
    with arguments.file.open("a") as file:
        for seed in map(int, arguments.seeds.split(",")):
            for row, content in ROWS.items():
                for number in range(content.count):
                    print(json.dumps(training_line(seed, row, number)), file=file, flush=True)


if __name__ == "__main__":
    main()
