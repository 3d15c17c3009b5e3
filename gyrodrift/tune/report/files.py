"""The files of a tuning: the config that `serve` hot-loads, and its numbers as JSON."""

import json
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

import yaml

from gyrodrift import __version__
from gyrodrift.evaluation.dataset import Split
from gyrodrift.files import write_whole
from gyrodrift.filters.filter import Filter
from gyrodrift.tune.result import Run, SessionScore, Tuning

HEAD = "# Found by gyrodrift tune. serve --config follows this file while it runs."


def write_config(path: Path, tuning: Tuning, command: str) -> None:
    """Write the config with its provenance, whole or not at all; the same tuning gives the same bytes.

    Raises
    ------
    UsageError
        Where the place cannot be written to.
    """
    content = {
        "filter": tuning.filter.name,
        "sample_rate_hz": float(f"{tuning.sample_rate_hz:.6g}"),
        tuning.filter.name: asdict(tuning.run.params),
        "provenance": _provenance(tuning, command),
    }
    lines = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).splitlines()
    head = [HEAD, f"# {tuning.filter.rate_note}", *(_explained(tuning.filter, line) for line in lines)]
    write_whole(path, [f"{line}\n" for line in head])


def config_text(tuning: Tuning) -> str:
    """What `serve` takes of the config, without where it comes from."""
    content = {"filter": tuning.filter.name, tuning.filter.name: asdict(tuning.run.params)}
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).strip()


def _provenance(tuning: Tuning, command: str) -> dict[str, Any]:
    """Where the parameters come from, and what they were worth; `serve` passes it by."""
    return {
        "command": command,
        "version": __version__,
        "filter": tuning.filter.name,
        "method": tuning.method,
        "seed": tuning.run.seed,
        "iterations": len(tuning.run.history),
        "pi_deg2": {
            "train_before": _number(tuning.euler.train),
            "train_after": _number(tuning.run.pi.train),
            "test_before": _number(tuning.euler.test),
            "test_after": _number(tuning.run.pi.test),
        },
        "test": "each session by parameters tuned on the others" if tuning.cross_validation else "sessions kept apart",
        "sessions": [
            {"name": score.session.name, "split": score.split.value, "sha256": score.session.digest}
            for score in tuning.scores
        ],
        "warnings": list(tuning.warnings),
    }


def _explained(chosen: Filter, line: str) -> str:
    """A line of the config, with what it means where it is a parameter."""
    key = line.strip().partition(":")[0]
    return f"{line:34} # {chosen.parameter(key).line}" if line.startswith("  ") and key in chosen.names else line


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
        "reduced_pi_train": _number(tuning.reduced.train),
        "reduced_pi_test": _number(tuning.reduced.test),
        "parameters": asdict(tuning.run.params),
        "reduced_parameters": asdict(tuning.reduced_params),
        "filter": tuning.filter.name,
        "method": tuning.method,
        "seed": tuning.run.seed,
        "sample_rate_hz": tuning.sample_rate_hz,
        "seconds": round(tuning.seconds, 3),
        "sessions": [_session(score) for score in tuning.scores],
        "left_out": {name: _number(score.e_deg) for name, score in tuning.cross_validation.items()},
        "seeds": [_seed(run) for run in (tuning.run, *tuning.others)],
        "warnings": list(tuning.warnings),
        "history": [_number(cost) for cost in tuning.run.history.tolist()],
    }
    write_whole(path, [json.dumps(content, indent=1, allow_nan=False, ensure_ascii=False), "\n"])


def _session(score: SessionScore) -> dict[str, Any]:
    return {
        "name": score.session.name,
        "split": score.split.value,
        "minutes": score.session.minutes,
        "e_euler_deg": _number(score.euler.e_deg),
        "ne_euler": _number(score.euler.ne),
        "e_hdr_deg": _number(score.tuned.e_deg),
        "ne_hdr": _number(score.tuned.ne),
        "e_reduced_deg": _number(score.reduced.e_deg),
        "sha256": score.session.digest,
    }


def summary(tuning: Tuning) -> list[str]:
    """What a person wants to know at the end, a line each."""
    lines = []
    for split, name in ((Split.TRAIN, "tuned on"), (Split.TEST, "held out")):
        euler_deg, tuned_deg = tuning.mean_e_deg(split)
        if isfinite(euler_deg):
            count = len(tuning.scores_on(split))
            lines.append(
                f"mean E of {count} sessions {name}: {tuned_deg:.4g} deg, plain integration {euler_deg:.4g} deg"
            )
    if tuning.cross_validation:
        held_out_deg = sum(one.e_deg for one in tuning.cross_validation.values()) / len(tuning.cross_validation)
        lines.append(f"mean E of each under parameters tuned on the others: {held_out_deg:.4g} deg")
    lines += [f"{name} = {value:.6g}" for name, value in asdict(tuning.run.params).items()]
    return lines


def _seed(run: Run) -> dict[str, Any]:
    pi = {"pi_train": _number(run.pi.train), "pi_test": _number(run.pi.test)}
    return {"seed": run.seed, **pi, "parameters": asdict(run.params)}


def _number(value: float | None) -> float | None:
    return value if value is not None and isfinite(value) else None
