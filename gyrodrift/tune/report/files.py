"""The files of a tuning: the config that `serve` hot-loads, and its numbers as JSON."""

import json
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

import yaml

from gyrodrift import __version__
from gyrodrift.evaluation.dataset import Split
from gyrodrift.evaluation.tunables import Tunable
from gyrodrift.files import write_whole
from gyrodrift.tune.result import Run, Tuning

HEAD = "# Found by gyrodrift tune. serve --config follows this file while it runs."


def write_config(path: Path, tuning: Tuning, command: str) -> None:
    """Write the config with its provenance, whole or not at all; the same tuning gives the same bytes.

    Raises
    ------
    UsageError
        Where the place cannot be written to.
    """
    content = {
        "filter": tuning.tunable.filter.name,
        "sample_rate_hz": float(f"{tuning.sample_rate_hz:.6g}"),
        tuning.tunable.filter.name: asdict(tuning.run.params),
        "provenance": {
            "command": command,
            "version": __version__,
            "method": tuning.method,
            "seed": tuning.run.seed,
            "iterations": len(tuning.run.history),
            "pi_deg2": {
                "train_before": _number(tuning.euler.train),
                "train_after": _number(tuning.run.pi.train),
                "test_before": _number(tuning.euler.test),
                "test_after": _number(tuning.run.pi.test),
            },
            "test": "each session by parameters tuned on the others" if tuning.left_out else "sessions kept apart",
            "sessions": [
                {"name": score.name, "split": score.split.value, "sha256": score.digest} for score in tuning.scores
            ],
            "warnings": list(tuning.warnings),
        },
    }
    lines = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).splitlines()
    head = [HEAD, f"# {tuning.tunable.note}", *(_explained(tuning.tunable, line) for line in lines)]
    write_whole(path, [f"{line}\n" for line in head])


def _explained(tunable: Tunable, line: str) -> str:
    """A line of the config, with what it means where it is a parameter."""
    meaning = tunable.meanings.get(line.strip().partition(":")[0]) if line.startswith("  ") else None
    return f"{line:34} # {meaning.line}" if meaning else line


def write_json(path: Path, tuning: Tuning) -> None:
    """Write the numbers, whole or not at all; what is infinite or not there is null.

    Raises
    ------
    UsageError
        Where the place cannot be written to.
    """
    content = {
        "pi_train": _number(tuning.run.pi.train),
        "pi_test": _number(tuning.run.pi.test),
        "euler_pi_train": _number(tuning.euler.train),
        "euler_pi_test": _number(tuning.euler.test),
        "few_pi_train": _number(tuning.few.train),
        "few_pi_test": _number(tuning.few.test),
        "parameters": asdict(tuning.run.params),
        "few_parameters": asdict(tuning.few_params),
        "filter": tuning.tunable.filter.name,
        "method": tuning.method,
        "seed": tuning.run.seed,
        "sample_rate_hz": tuning.sample_rate_hz,
        "seconds": round(tuning.seconds, 3),
        "sessions": [
            {
                "name": score.name,
                "split": score.split.value,
                "minutes": score.minutes,
                "e_euler_deg": _number(score.e_euler_deg),
                "ne_euler": _number(score.ne_euler),
                "e_hdr_deg": _number(score.e_tuned_deg),
                "ne_hdr": _number(score.ne_tuned),
                "e_few_deg": _number(score.e_few_deg),
                "sha256": score.digest,
            }
            for score in tuning.scores
        ],
        "left_out": {name: _number(e_deg) for name, e_deg in tuning.left_out.items()},
        "seeds": [_seed(run) for run in (tuning.run, *tuning.others)],
        "warnings": list(tuning.warnings),
        "history": [_number(cost) for cost in tuning.run.history.tolist()],
    }
    write_whole(path, [json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False), "\n"])


def summary(tuning: Tuning) -> list[str]:
    """What a person wants to know at the end, a line each."""
    lines = []
    for split, name in ((Split.TRAIN, "tuned on"), (Split.TEST, "kept apart")):
        euler_deg, tuned_deg = tuning.mean_e_deg(split)
        if isfinite(euler_deg):
            count = sum(score.split is split for score in tuning.scores)
            lines.append(
                f"mean E of {count} sessions {name}: {tuned_deg:.4g} deg, plain integration {euler_deg:.4g} deg"
            )
    if tuning.left_out:
        left_out_deg = sum(tuning.left_out.values()) / len(tuning.left_out)
        lines.append(f"mean E of each under parameters tuned on the others: {left_out_deg:.4g} deg")
    lines += [f"{name} = {value:.6g}" for name, value in asdict(tuning.run.params).items()]
    return lines


def _seed(run: Run) -> dict[str, Any]:
    pi = {"pi_train": _number(run.pi.train), "pi_test": _number(run.pi.test)}
    return {"seed": run.seed, **pi, "parameters": asdict(run.params)}


def _number(value: float | None) -> float | None:
    return value if value is not None and isfinite(value) else None
