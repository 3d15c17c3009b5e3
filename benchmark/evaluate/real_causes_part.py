"""Real recordings whose cause is known (real_causes.py): `gyrodrift diagnose` on each, against its labels."""

from collections import Counter
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from blind.rows.recordings import Rows, read_rows
from gyrogap.answer import SURE_ABOVE
from gyrogap.physics.rig_text import rig_text
from recordings_support import Recordings, further_recordings, packed_names

from evaluate.baseline import first_or_tied, gap_of, group_of, run_diagnose, words_of
from evaluate.figures import Figure, share_figure
from evaluate.real_causes import CASES, DEVICES, NOTHING, OUTSIDE, LabeledCase, Piece
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
    named = [(case, gap) for case, gap in done if not (is_outside(case) or is_nothing(case))]
    figures = [
        _share("right: a known cause first in the report, left open, or none", [is_right(*one) for one in done]),
        _share("group of a known cause first", [names_label_first(case, gap) for case, gap in named]),
        _share("the same, by the expected share of the gap", [names_label_by_share(case, gap) for case, gap in named]),
        _share("the same, or tied with the first", [names_label_or_ties(case, gap) for case, gap in named]),
        _share("outside the catalog: unknown or partly", [is_left_open(gap) for case, gap in done if is_outside(case)]),
        _share("nothing changed: none", [gap["verdict"] == "none" for case, gap in done if is_nothing(case)]),
        _share("no cause above 0.8 beside the known ones", [not unlabeled_sure(case, gap) for case, gap in done]),
    ]
    for device in dict.fromkeys(case.device for case, _ in named):
        hits = [names_label_by_share(case, gap) for case, gap in named if case.device == device]
        figures.append(_share(f"{device}: group of a known cause first, by the expected share", hits))
    return [figure for figure in figures if figure.count]


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
    lacking = [piece.name for piece in (*case.files, *case.baseline) if not (_is_packed(piece) or _further(piece))]
    if lacking:
        say(f"{case.name}: skipped, {lacking[0]} is not in tests/data or in the folder of further recordings")
    return not lacking


def _is_packed(piece: Piece) -> bool:
    return not piece.axis and piece.name in packed_names()


def _further(piece: Piece) -> Path | None:
    folder = further_recordings()
    return next(folder.rglob(f"{piece.name}.{'npz' if piece.axis else 'csv'}"), None) if folder else None


def is_outside(case: LabeledCase) -> bool:
    """Whether no effect of the catalog describes what is known."""
    return case.labels == (OUTSIDE,)


def is_nothing(case: LabeledCase) -> bool:
    """Whether the two sets do not differ."""
    return case.labels == (NOTHING,)


def is_right(case: LabeledCase, gap: dict[str, Any]) -> bool:
    """Whether the verdict and the first cause of the report agree with the label."""
    if is_nothing(case):
        return bool(gap["verdict"] == "none")
    return is_left_open(gap) if is_outside(case) else names_label_by_share(case, gap)


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
        _diagnose(case, own)
    gap = gap_of(own / "out")
    say(f"{case.name}: {_words(case, gap)}")
    return gap


def _words(case: LabeledCase, gap: dict[str, Any]) -> str:
    score = "hit" if is_right(case, gap) else "MISS"
    unlabeled = [f"not labeled: {name}" for name in unlabeled_sure(case, gap)]
    return ", ".join([f"{score} {'/'.join(case.labels)}", words_of(gap), *unlabeled])


def _diagnose(case: LabeledCase, folder: Path) -> None:
    paths = write_pieces(case.files, folder / "sessions")
    words = [*map(str, paths), "--rig", str(folder / "rig.yaml"), "--out", str(folder / "out")]
    if case.baseline:
        write_pieces(case.baseline, folder / "baseline")
        words += ["--baseline", str(folder / "baseline")]
    (folder / "rig.yaml").write_text(rig_of_case(case, paths))
    run_diagnose(words)


def write_pieces(pieces: Sequence[Piece], folder: Path) -> list[Path]:
    """Session files of recordings or their parts, each from time 0."""
    folder.mkdir(parents=True, exist_ok=True)
    paths = [folder / f"{piece.name}{piece.axis.strip('-')}.csv" for piece in pieces]
    for piece, path in zip(pieces, paths, strict=True):
        path.write_text(_rows_of(piece, folder).from_zero().text())
    return paths


def _rows_of(piece: Piece, folder: Path) -> Rows:
    path = None if _is_packed(piece) else _further(piece)
    rows = read_rows(path or Recordings(folder.parent).path(piece.name), piece.axis)
    length = len(rows.t_s) // piece.count
    return rows.only(np.arange(piece.index * length, (piece.index + 1) * length))


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
