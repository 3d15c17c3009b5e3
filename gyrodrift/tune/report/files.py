"""Files of a tuning: the config for `serve`, and the numbers as JSON."""

from dataclasses import asdict
from math import isnan, nan
from pathlib import Path
from typing import Any

import yaml

from gyrodrift import __version__
from gyrodrift.evaluation.dataset import Split
from gyrodrift.filters.filter import Filter
from gyrodrift.io.files import write_whole
from gyrodrift.io.json_numbers import finite_values
from gyrodrift.report.numbers import aligned, significant
from gyrodrift.tune.result import Alternative, Pi, Run, SessionScore, Tuning
from gyrodrift.values.words import counted

HEAD = "# Written by gyrodrift tune. serve --config reloads this file when it changes."


def write_config(path: Path, tuning: Tuning, command: str) -> None:
    """Write the config with its provenance, whole or not at all; the same tuning gives the same bytes.

    Raises
    ------
    UsageError
        If the path cannot be written.
    """
    content = {
        "filter": tuning.filter.name,
        "sample_rate_hz": float(f"{tuning.sample_rate_hz:.6g}"),
        tuning.filter.name: asdict(tuning.params),
        "provenance": _provenance(tuning, command),
    }
    lines = yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).splitlines()
    head = [HEAD, f"# {tuning.filter.rate_note}", *(_explained(tuning.filter, line) for line in lines)]
    write_whole(path, [f"{line}\n" for line in head])


def config_text(tuning: Tuning) -> str:
    """The config without its provenance."""
    content = {"filter": tuning.filter.name, tuning.filter.name: asdict(tuning.params)}
    return yaml.safe_dump(content, sort_keys=False, allow_unicode=True, width=120).strip()


def _provenance(tuning: Tuning, command: str) -> dict[str, Any]:
    """Provenance and scores of the parameters; `serve` ignores this block."""
    after = tuning.run.pi if tuning.written is None else tuning.written.pi
    return {
        "command": command,
        "version": __version__,
        "filter": tuning.filter.name,
        "method": tuning.method,
        "seed": tuning.run.seed,
        "iterations": len(tuning.run.history),
        "parameters": "defaults" if tuning.is_default_written else "tuned",
        "pi_deg2": finite_values(
            {
                "train_before": tuning.euler.train,
                "train_after": after.train,
                "test_before": tuning.euler.test,
                "test_after": after.test,
            }
        ),
        "test": "each session by parameters tuned on the other sessions"
        if tuning.cross_validation
        else "held-out sessions",
        "sessions": [
            {"name": score.session.name, "split": score.split.value, "sha256": score.session.digest}
            for score in tuning.scores
        ],
        "warnings": list(tuning.warnings),
    }


def _explained(chosen: Filter, line: str) -> str:
    """A line of the config, with the meaning of a parameter."""
    key = line.strip().partition(":")[0]
    return f"{line:34} # {chosen.parameter(key).line}" if line.startswith("  ") and key in chosen.names else line


def content(tuning: Tuning) -> dict[str, Any]:
    """Content of `tune.json`."""
    return {
        "pi_train": tuning.run.pi.train,
        "pi_test": tuning.run.pi.test,
        "euler_pi_train": tuning.euler.train,
        "euler_pi_test": tuning.euler.test,
        "reduced_pi_train": tuning.reduced.train,
        "reduced_pi_test": tuning.reduced.test,
        "parameters": asdict(tuning.params),
        "parameters_from": "defaults" if tuning.is_default_written else "tuning",
        "filters": _filters(tuning),
        "alternatives": [_alternative(way) for way in tuning.alternatives],
        "reduced_parameters": asdict(tuning.reduced_params),
        "filter": tuning.filter.name,
        "method": tuning.method,
        "seed": tuning.run.seed,
        "sample_rate_hz": tuning.sample_rate_hz,
        "seconds": round(tuning.seconds, 3),
        "sessions": [_session(score) for score in tuning.scores],
        "left_out": {name: score.e_deg for name, score in tuning.cross_validation.items()},
        "seeds": [_seed(run) for run in (tuning.run, *tuning.other_runs)],
        "warnings": list(tuning.warnings),
        "history": tuning.run.history.tolist(),
    }


def _filters(tuning: Tuning) -> dict[str, Any]:
    """Results of each filter that was tuned."""
    defaults = {way.key: way.pi for way in tuning.alternatives if not way.is_tuned}
    return {
        way.key: {
            "pi_train": way.pi.train,
            "pi_test": way.pi.test,
            "pi_train_default": defaults[way.key].train,
            "pi_test_default": defaults[way.key].test,
            "parameters": None if way.params is None else asdict(way.params),
        }
        for way in tuning.alternatives
        if way.is_tuned
    }


def _alternative(way: Alternative) -> dict[str, Any]:
    return {
        "name": way.title,
        "filter": None if way.filter is None else way.filter.name,
        "tuned": way.is_tuned,
        "pi_train": way.pi.train,
        "pi_test": way.pi.test,
        "e_train_deg": way.e_deg.train,
        "e_test_deg": way.e_deg.test,
        "crps_train_deg": None if way.crps_deg is None else way.crps_deg.train,
        "crps_test_deg": None if way.crps_deg is None else way.crps_deg.test,
    }


def _session(score: SessionScore) -> dict[str, Any]:
    return {
        "name": score.session.name,
        "split": score.split.value,
        "minutes": score.session.minutes,
        "e_euler_deg": score.euler.e_deg,
        "ne_euler": score.euler.ne,
        "e_hdr_deg": score.tuned.e_deg,
        "ne_hdr": score.tuned.ne,
        "e_reduced_deg": score.reduced.e_deg,
        "sha256": score.session.digest,
    }


def summary(tuning: Tuning) -> list[str]:
    """The result as lines for a terminal: every alternative, the best one, and its parameters."""
    lines = [f"mean yaw error E, and CRPS, the error with its stated sigma, in deg; {_held_out_words(tuning)}"]
    head = ["", "E training", "E held out", "CRPS training", "CRPS held out"]
    lines += aligned([head, *(_summary_row(tuning, way) for way in tuning.alternatives)])
    lines += [f"* {verdict_words(tuning)}", *_motion_words(tuning)]
    return lines + [f"{name} = {value:.6g}" for name, value in asdict(tuning.params).items()]


def _motion_words(tuning: Tuning) -> list[str]:
    """A line with the longest motion that the tuned parameters were tested on; no line for defaults."""
    motions_s = [score.session.longest_motion_s for score in tuning.scores]
    tested_s = [motion_s for motion_s in motions_s if motion_s is not None]
    if tuning.is_default_written or not tested_s:
        return []
    limit = f"Longest motion without a rest in these sessions: {max(tested_s):.0f} s"
    return [f"{limit}; the parameters are not tested on longer motion"]


def _held_out_words(tuning: Tuning) -> str:
    if tuning.cross_validation:
        return f"{len(tuning.scores)} sessions, each held out in turn"
    train, test = (len(tuning.scores_on(split)) for split in Split)
    return f"{counted(train, 'training session')}, {test} held out"


def _summary_row(tuning: Tuning, way: Alternative) -> list[str]:
    mark = "* " if way is tuning.written else "  "
    means = [way.e_deg, way.crps_deg or Pi(nan, None)]
    values = [value for mean in means for value in (mean.train, mean.test)]
    return [mark + way.title, *("–" if value is None or isnan(value) else significant(value, 3) for value in values)]


def verdict_words(tuning: Tuning) -> str:
    """Sentence with the filter in the config and the reason."""
    written = tuning.written
    tuned = [way for way in tuning.alternatives if way.is_tuned]
    if written is None or (len(tuned) < 2 and written.is_tuned):
        return f"in the config: {tuning.filter.title or tuning.filter.name}, tuned"
    where = "training sessions" if written.pi.test is None else "held-out sessions"
    return f"in the config: {written.title}, the best filter on {where}"


def _seed(run: Run) -> dict[str, Any]:
    pi = {"pi_train": run.pi.train, "pi_test": run.pi.test}
    return {"seed": run.seed, **pi, "parameters": asdict(run.params)}
