"""Real recordings whose cause is known (real_causes.py): `gyrodrift diagnose` on each, against its labels."""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from blind.rows.recordings import read_rows
from gyrogap.answer import SURE_ABOVE
from gyrogap.physics.rig_text import rig_text
from recordings_support import Recordings, further_recordings, packed_names

from evaluate.baseline import first_or_tied, gap_of, group_of, run_diagnose, words_of
from evaluate.figures import Figure, share_figure
from evaluate.real_causes import CASES, DEVICES, OUTSIDE, LabeledCase
from gyrodrift.session.files import load_session

Say = Callable[[str], None]


def measure(_seed: int, count: int, folder: Path, say: Say) -> list[Figure]:
    """Shares over the cases whose recordings are there; `count` cases of each device at most.

    Raises
    ------
    RuntimeError
        No recording is there.
    """
    done = [(case, diagnosed(case, folder, say)) for case in chosen(count) if has_files(case, say)]
    if not done:
        raise RuntimeError("there are no recordings: set GYRODRIFT_RECORDINGS to their folder")
    named = [(case, gap) for case, gap in done if not is_outside(case)]
    figures = [
        _share("group of a known cause first", [names_label_first(case, gap) for case, gap in named]),
        _share("the same, by the expected share of the gap", [names_label_by_share(case, gap) for case, gap in named]),
        _share("the same, or tied with the first", [names_label_or_ties(case, gap) for case, gap in named]),
        _share("outside the catalog: unknown or partly", [is_left_open(gap) for case, gap in done if is_outside(case)]),
        _share("no cause above 0.8 beside the known ones", [not unlabeled_sure(case, gap) for case, gap in done]),
    ]
    for device in dict.fromkeys(case.device for case, _ in named):
        hits = [names_label_by_share(case, gap) for case, gap in named if case.device == device]
        figures.append(_share(f"{device}: group of a known cause first, by the expected share", hits))
    return figures


def _share(name: str, hits: Sequence[bool]) -> Figure:
    return share_figure(name, sum(hits), len(hits))


def chosen(count: int) -> list[LabeledCase]:
    """The first `count` cases of each device."""
    taken: Counter[str] = Counter()
    cases = []
    for case in CASES:
        taken[case.device] += 1
        if taken[case.device] <= count:
            cases.append(case)
    return cases


def has_files(case: LabeledCase, say: Say) -> bool:
    """Whether all recordings of a case are there; says which one is not."""
    folder = further_recordings()
    lacking = [name for name in case.files if not (name in packed_names() or _lies_in(folder, name))]
    if lacking:
        say(f"{case.name}: skipped, {lacking[0]} is not in tests/data or in the folder of further recordings")
    return not lacking


def _lies_in(folder: Path | None, name: str) -> bool:
    return folder is not None and next(folder.rglob(f"{name}.csv"), None) is not None


def is_outside(case: LabeledCase) -> bool:
    """Whether no effect of the catalog describes what is known."""
    return case.labels == (OUTSIDE,)


def is_left_open(gap: dict[str, Any]) -> bool:
    """Whether the verdict says that something is not explained."""
    return gap["verdict"] in {"unknown", "partly"}


def names_label_first(case: LabeledCase, gap: dict[str, Any]) -> bool:
    """Whether the first cause is of a labeled group."""
    causes = gap["causes"]
    return bool(causes) and group_of(causes[0]["effect"]) in case.labels


def names_label_by_share(case: LabeledCase, gap: dict[str, Any]) -> bool:
    """Whether the first cause of the report is of a labeled group: that of the largest expected share of the gap."""
    causes = sorted(gap["causes"], key=lambda cause: -cause["group_probability"] * cause["gap_share"])
    return bool(causes) and group_of(causes[0]["effect"]) in case.labels


def names_label_or_ties(case: LabeledCase, gap: dict[str, Any]) -> bool:
    """Whether the first cause, or one that is tied with it, is of a labeled group."""
    first = {group_of(effect) for effect in first_or_tied(gap)} if gap["causes"] else set()
    return not first.isdisjoint(case.labels)


def unlabeled_sure(case: LabeledCase, gap: dict[str, Any]) -> list[str]:
    """Causes above 0.8 of groups that are neither labeled nor documented."""
    groups = {*case.labels, *case.also}
    sure = [cause["effect"] for cause in gap["causes"] if cause["probability"] > SURE_ABOVE]
    return [effect for effect in sure if group_of(effect) not in groups]


def diagnosed(case: LabeledCase, folder: Path, say: Say) -> dict[str, Any]:
    """`gap.json` of a case; an interrupted evaluation continues."""
    own = folder / case.name.replace(" ", "_").replace(",", "")
    if not (own / "out" / "gap.json").exists():
        own.mkdir(parents=True, exist_ok=True)
        _diagnose(case, [_written(case, name, own) for name in case.files], own)
    gap = gap_of(own / "out")
    say(f"{case.name}: {_words(case, gap)}")
    return gap


def _words(case: LabeledCase, gap: dict[str, Any]) -> str:
    is_hit = is_left_open(gap) if is_outside(case) else names_label_first(case, gap)
    score = "hit" if is_hit else "MISS"
    unlabeled = [f"not labeled: {name}" for name in unlabeled_sure(case, gap)]
    return ", ".join([f"{score} {'/'.join(case.labels)}", words_of(gap), *unlabeled])


def _written(case: LabeledCase, name: str, folder: Path) -> Path:
    path = Recordings(folder).path(name)
    return path if case.pieces == 1 else write_piece(path, case, folder / "piece.csv")


def write_piece(path: Path, case: LabeledCase, out: Path) -> Path:
    """One of the equal parts of a recording, from time 0."""
    rows = read_rows(path)
    length = len(rows.t_s) // case.pieces
    first = case.piece * length
    out.write_text(rows.only(np.arange(first, first + length)).from_zero().text())
    return out


def _diagnose(case: LabeledCase, paths: Sequence[Path], folder: Path) -> None:
    rig = folder / "rig.yaml"
    rig.write_text(rig_of_case(case, paths))
    run_diagnose([*map(str, paths), "--rig", str(rig), "--out", str(folder / "out")])


def rig_of_case(case: LabeledCase, paths: Sequence[Path]) -> str:
    """A rig file with the rate of the recordings, and the steps of the device."""
    device = DEVICES[case.device]
    times_s = [load_session(path).t_device_s for path in paths]
    rate_hz = sum(len(t_s) - 1 for t_s in times_s) / sum(float(t_s[-1] - t_s[0]) for t_s in times_s)
    base = {
        "sample_rate_hz": round(rate_hz, 2),
        "dps_per_lsb": round(device.dps_per_lsb, 5),
        "noise_dps_rthz": 0.005,
        "bias_dps": 0.0,
        "encoder_cpr": device.encoder_cpr,
        "host_delay_s": 0.002,
    }
    return rig_text(base)
