"""The files of a diagnosis, and its verdict in ten lines."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from gyrodrift.diagnose.features.feature import WHEN
from gyrodrift.diagnose.inference.gap import Deviation, SimToRealGap
from gyrodrift.diagnose.inference.parameters import Parameter
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause
from gyrodrift.diagnose.report.effect_words import effect_sentence, says
from gyrodrift.diagnose.report.text import stated
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.diagnose.what_next import FILE as PROFILE
from gyrodrift.io.files import write_whole
from gyrodrift.report.numbers import significant, write_json

SHOWN = 3
"""Largest number of causes, of negligible effects and of deviations in the summary. Chosen: a summary fits on a
screen."""

NAMES = ("gap.json", "rig.yaml", PROFILE, "report.html")
"""Names of the files of a diagnosis."""


def write_files(folder: Path, diagnosis: Diagnosis) -> None:
    """Write `gap.json`, `rig.yaml` and the profile of the next motion, each whole or not at all.

    Without a next motion, the profile of an earlier diagnosis is removed.

    Raises
    ------
    UsageError
        If the folder cannot be written to.
    """
    write_json(folder / "gap.json", content(diagnosis))
    write_whole(folder / "rig.yaml", [diagnosis.rig_yaml])
    profile = folder / PROFILE
    if diagnosis.next_profile_yaml is not None:
        write_whole(profile, [diagnosis.next_profile_yaml])
    else:
        profile.unlink(missing_ok=True)


def content(diagnosis: Diagnosis) -> dict[str, Any]:
    """Content of `gap.json`."""
    verdict, impact = diagnosis.verdict, diagnosis.yaw_impact
    no_gap, unknown = _rounded(verdict.probability_none), _rounded(verdict.probability_unknown)
    return {
        "contradictions": [asdict(item) for item in diagnosis.contradictions],
        "verdict": verdict.kind.value,
        "probability_of_no_gap": no_gap,
        "probability_of_unknown": unknown,
        "probability_none": no_gap,  # the former names of both
        "probability_unknown": unknown,
        "posterior": [
            {"effects": list(item.effects), "unknown": item.is_unknown, "probability": round(item.probability, 4)}
            for item in diagnosis.posterior
        ],
        "causes": [_cause(cause) for cause in verdict.causes],
        "negligible": [{**_cause(item.cause), "yaw_deg": round(item.yaw_deg, 4)} for item in verdict.negligible],
        "where": [_deviation(item) for item in verdict.where],
        "leftover": [_deviation(item) for item in verdict.unexplained],
        "gap": asdict(verdict.gap),
        "yaw": {name: getattr(impact, name) for name in ("e_real_deg", "e_sim_before_deg", "e_sim_after_deg")},
        "transfer": {name: value for name, value in asdict(impact).items() if name.startswith("pi_")},
        **({} if diagnosis.halves is None else {"halves": asdict(diagnosis.halves)}),
        "detectable": {
            item.effect: {item.parameter: item.value, "unit": item.unit}
            | ({"at": dict(item.other_parameters)} if item.other_parameters else {})
            for item in diagnosis.detectable
            if item.value is not None
        },
        "untestable": {item.effect: item.why for item in diagnosis.untestable},
        "calibration": {
            base.name: {"rig": base.rig, "data": base.data, "low": base.low, "high": base.high}
            for base in diagnosis.calibration
        },
        "remarks": list(diagnosis.remarks),
        **({} if diagnosis.lacking is None else {"lacking": asdict(diagnosis.lacking)}),
        "sessions": [session.name for session in diagnosis.sessions],
        "next": diagnosis.next_step,
        "seconds": round(diagnosis.seconds, 3),
    }


def _cause(cause: NamedCause) -> dict[str, Any]:
    parameters = {parameter.name: _parameter(parameter) for parameter in cause.parameters}
    in_rig = {} if cause.in_rig is None else {"in_rig": cause.in_rig.model_dump(exclude={"name"})}
    return {
        "effect": cause.effect.name,
        "group": cause.group,
        "probability": round(cause.probability, 4),
        "group_probability": round(cause.group_probability, 4),
        "gap_share": round(cause.gap_share, 4),
        "parameters": parameters,
        **in_rig,
        "tied_with": list(cause.tied_with),
    }


def _rounded(probability: float | None) -> float | None:
    return None if probability is None else round(probability, 4)


def _parameter(parameter: Parameter) -> dict[str, Any]:
    fields: dict[str, Any] = {
        "value": parameter.value,
        "low": parameter.low,
        "high": parameter.high,
        "unit": parameter.unit,
    }
    if parameter.is_bound:
        fields["bound"] = "at least" if parameter.is_at_least else "at most"
    return fields


def _deviation(deviation: Deviation) -> dict[str, Any]:
    return {
        "stage": deviation.stage,
        "signature": deviation.feature,
        "regime": deviation.regime,
        "z": round(deviation.z, 2),
        "share": round(deviation.share, 4),
        "says": says(deviation),
    }


def summary(diagnosis: Diagnosis) -> list[str]:
    """The verdict in ten lines or fewer."""
    verdict = diagnosis.verdict
    lines = [f"contradiction of facts: {item.says}" for item in diagnosis.contradictions]
    lines.append(headline(diagnosis))
    lines += [f"  {cause_line(cause)}" for cause in verdict.causes_by_share[:SHOWN]]
    lines += [
        f"  negligible: {cause_line(item.cause)}; changes yaw by {significant(item.yaw_deg, 2)} deg"
        for item in verdict.negligible[:SHOWN]
    ]
    if verdict.where:
        lines.append(f"where: {_listed(verdict.where)}")
    if verdict.causes and verdict.unexplained:
        lines.append(f"unexplained: {_listed(verdict.unexplained)}")
    return [
        *lines,
        _gap_line(diagnosis),
        _yaw_line(diagnosis),
        *([] if diagnosis.halves is None else [f"check on halves: {diagnosis.halves.says}"]),
        f"next: {diagnosis.next_step}",
    ]


def _gap_line(diagnosis: Diagnosis) -> str:
    gap, is_corrected = diagnosis.verdict.gap, bool(diagnosis.verdict.causes)
    closed = f"; {_closed(gap)} of the gap closed" if gap.shrink is not None and is_corrected else ""
    corrected = f"{gap.after:.2f} σ corrected, " * is_corrected
    judged = "held-out sessions" if len(diagnosis.sessions) > 1 else "the session it was fitted on"
    return (
        f"gap, RMS of all features on {judged}: {gap.before:.2f} σ simulator as it is, {corrected}{gap.floor:.2f} σ by "
        f"chance{closed}"
    )


def _closed(gap: SimToRealGap) -> str:
    return f"{100.0 * max(gap.shrink or 0.0, 0.0):.0f} %"


def _yaw_line(diagnosis: Diagnosis) -> str:
    impact = diagnosis.yaw_impact
    real, before, after = (
        f"{significant(value, 3)} deg" for value in (impact.e_real_deg, impact.e_sim_before_deg, impact.e_sim_after_deg)
    )
    corrected = f", {after} corrected" * bool(diagnosis.verdict.causes)
    return f"mean yaw error, one filter: {real} recordings, {before} simulator as it is{corrected}"


def _listed(deviations: Sequence[Deviation]) -> str:
    """The worst deviations beyond chance, and the number of the others."""
    beyond = [deviation for deviation in deviations if deviation.is_beyond_chance]
    if not beyond:
        return "in no single feature by more than chance, in many together"
    rest = f"; and {len(beyond) - SHOWN} more" if len(beyond) > SHOWN else ""
    return "; ".join(f"{says(item)} ({item.stage}, {WHEN[item.regime]})" for item in beyond[:SHOWN]) + rest


def headline(diagnosis: Diagnosis) -> str:
    """The verdict as a sentence: each cause in plain words with its sign and size, and the closed share of the gap."""
    gap = diagnosis.verdict.gap
    causes = _worse(diagnosis) + "; ".join(effect_sentence(cause) for cause in diagnosis.verdict.causes_by_share)
    small = " and ".join(item.cause.effect.name for item in diagnosis.verdict.negligible)
    closed = "" if gap.shrink is None else f"; {_closed(gap)} of the gap closed"
    match diagnosis.verdict.kind:
        case Kind.NONE:
            except_small = f", but for {small}, negligible in yaw" if small else ""
            return f"none: the simulator explains these sessions{except_small}"
        case Kind.EFFECT:
            return f"effect: {causes}{'' if gap.is_closed else closed}"
        case Kind.PARTLY:
            return f"partly: {causes}{closed}; part of the difference is unexplained"
        case Kind.UNKNOWN:
            return "unknown: the sessions differ from the simulator, and no effect of the simulator explains it"


def _worse(diagnosis: Diagnosis) -> str:
    """Words before the causes if their correction is withdrawn; empty otherwise."""
    if not any(cause.is_withdrawn for cause in diagnosis.verdict.causes):
        return ""
    yaw = diagnosis.yaw_impact
    recorded, before, after = (
        f"{significant(e_deg, 3)}°" for e_deg in (yaw.e_real_deg, yaw.e_sim_before_deg, yaw.e_sim_after_deg)
    )
    figures = f"recorded {recorded}, simulator {before}, corrected {after}"
    return f"a correction makes yaw worse and is not adopted ({figures}); "


def cause_line(cause: NamedCause) -> str:
    """A cause in one line."""
    first = cause.parameters[0]
    has = ""
    if cause.in_rig is not None:
        has = f" in the rig with {significant(getattr(cause.in_rig, first.name), 4)} {first.unit}, the sessions say"
    phase = ", a phase of its own in each session" if cause.cause.phases_deg is not None else ""
    tied = ""
    if cause.tied_with:
        tied = (
            f"; could as well be {' or '.join(cause.tied_with)} (probability that one of them acts: "
            f"{stated(cause.group_probability)})"
        )
    size = f"{first.name}{has} {_size_words(first)}{phase}"
    return f"{cause.effect.name}: {size}, probability {stated(cause.probability)}{tied}"


def _size_words(parameter: Parameter) -> str:
    """A size with its 95 % interval, or a bound if the interval ends at a size beyond which none was tried."""
    bound, low, high = (significant(number, 4) for number in (parameter.bound, parameter.low, parameter.high))
    if parameter.is_bound:
        return f"at {'least' if parameter.is_at_least else 'most'} {bound} {parameter.unit}"
    return f"{bound} {parameter.unit} ({low} to {high})"
