"""`gyrodrift diagnose` on a data set of gyrogap: run the command on each case, and turn its `gap.json` into an answer.

    python -m benchmark evaluate.gyrogap_methods.diagnose DATA ANSWERS

The command gets the sessions and the file of the simulator, and nothing else.
"""

import json
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic
from typing import Any

from this_tree import run_gyrodrift


def answer_of(gap: dict[str, Any]) -> dict[str, Any]:
    """Answer from a `gap.json`; a verdict without causes gives them no parameters."""
    causes = [
        {
            "effect": cause["effect"],
            "probability": cause["probability"],
            "parameters": _translated({name: stated["value"] for name, stated in cause["parameters"].items()}),
        }
        for cause in gap["causes"]
    ]
    return {"causes": causes, "none": gap["probability_of_no_gap"], "unknown": gap["probability_of_unknown"]}


def _translated(parameters: dict[str, float]) -> dict[str, float]:
    """Parameters in the words of the benchmark: the curve of a temperature slope is stated relative to it.

    The benchmark knows no spread and no handover of bunches.
    """
    for name in ("spread_percent", "handover_ms"):
        parameters.pop(name, None)
    curve_per_c = parameters.pop("curve_per_c", None)
    curve = {} if curve_per_c is None else {"curve_dps_per_c2": curve_per_c * parameters["slope_dps_per_c"]}
    return parameters | curve


def diagnose(case: Path) -> dict[str, Any]:
    """Run the command on the folder of a case."""
    with TemporaryDirectory(prefix="gyrogap-") as folder:
        words = ["diagnose", str(case / "sessions"), "--rig", str(case / "simulator.yaml"), "--out", folder]
        run_gyrodrift(*words, "--jobs", "1")
        gap: dict[str, Any] = json.loads((Path(folder) / "gap.json").read_text())
    return gap


def main(data: Path, answers: Path) -> None:
    """Answer all cases that have no answer."""
    answers.mkdir(parents=True, exist_ok=True)
    for case in sorted(path.name for path in (data / "cases").iterdir()):
        target = answers / f"{case}.json"
        if target.exists():
            continue
        started_s = monotonic()
        try:
            gap = diagnose(data / "cases" / case)
        except subprocess.CalledProcessError as error:
            print(f"{case}: {error.stderr[-500:]}", flush=True)
            continue
        seconds = round(monotonic() - started_s, 1)
        target.write_text(json.dumps(answer_of(gap) | {"seconds": seconds, "verdict": gap["verdict"]}) + "\n")
        print(f"{case}: {gap['verdict']} {[c['effect'] for c in gap['causes']]} {seconds} s", flush=True)


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
