"""The files of a diagnosis, and its verdict in ten lines."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

from gyrodrift.diagnose.inference.deviations import Deviation
from gyrodrift.diagnose.inference.verdict import Kind, NamedCause
from gyrodrift.diagnose.regime_words import WHEN
from gyrodrift.diagnose.report.effect_words import effect_sentence, says
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.files import write_whole

SHOWN = 3
PROFILE = "next-profile.yaml"

NAMES = ("gap.json", "rig.yaml", PROFILE, "report.html")
"""Of all files of a diagnosis."""


def write_files(folder: Path, diagnosis: Diagnosis) -> None:
    """`gap.json`, `rig.yaml` and the next motion where there is one, each whole or not at all.

    Raises
    ------
    UsageError
        Where the folder cannot be written to.
    """
    text = json.dumps(_finite(content(diagnosis)), indent=1, allow_nan=False, ensure_ascii=False)
    write_whole(folder / "gap.json", [text, "\n"])
    write_whole(folder / "rig.yaml", [diagnosis.rig_yaml])
    profile = folder / PROFILE
    if diagnosis.next_profile_yaml is not None:
        write_whole(profile, [diagnosis.next_profile_yaml])
    else:
        profile.unlink(missing_ok=True)


def content(diagnosis: Diagnosis) -> dict[str, Any]:
    """What `gap.json` holds."""
    verdict, impact = diagnosis.verdict, diagnosis.yaw_impact
    return {
        "contradictions": [asdict(one) for one in diagnosis.contradictions],
        "verdict": verdict.kind.value,
        "causes": [_cause(cause) for cause in verdict.causes],
        "negligible": [{**_cause(one.cause), "yaw_deg": round(one.yaw_deg, 4)} for one in verdict.negligible],
        "where": [_deviation(one) for one in verdict.where],
        "leftover": [_deviation(one) for one in verdict.unexplained],
        "gap": asdict(verdict.gap),
        "yaw": {name: getattr(impact, name) for name in ("e_real_deg", "e_sim_before_deg", "e_sim_after_deg")},
        "transfer": {name: value for name, value in asdict(impact).items() if name.startswith("pi_")},
        "linear_model": asdict(diagnosis.linear_model),
        "detectable": {
            one.effect: {one.parameter: one.value, "unit": one.unit}
            | ({"at": dict(one.other_parameters)} if one.other_parameters else {})
            for one in diagnosis.detectable
            if one.value is not None
        },
        "untestable": {one.effect: one.why for one in diagnosis.untestable},
        "calibration": {
            one.name: {"rig": one.rig, "data": one.data, "low": one.low, "high": one.high}
            for one in diagnosis.calibration
        },
        "remarks": list(diagnosis.remarks),
        "sessions": [session.name for session in diagnosis.sessions],
        "next": diagnosis.next_step,
        "seconds": round(diagnosis.seconds, 3),
    }


def _cause(cause: NamedCause) -> dict[str, Any]:
    parameters = {
        one.name: {"value": one.value, "low": one.low, "high": one.high, "unit": one.unit} for one in cause.parameters
    }
    in_rig = {} if cause.in_rig is None else {"in_rig": cause.in_rig.model_dump(exclude={"name"})}
    return {
        "effect": cause.effect.name,
        "group": cause.group,
        "probability": round(cause.probability, 4),
        "group_probability": round(cause.group_probability, 4),
        "parameters": parameters,
        **in_rig,
        "tied_with": list(cause.tied_with),
    }


def _deviation(one: Deviation) -> dict[str, Any]:
    return {
        "stage": one.stage,
        "signature": one.feature,
        "regime": one.regime,
        "z": round(one.z, 2),
        "share": round(one.share, 4),
        "says": says(one),
    }


def _finite(value: Any) -> Any:
    """The same with null for what is infinite or no number."""
    if isinstance(value, dict):
        return {name: _finite(inner) for name, inner in value.items()}
    if isinstance(value, list):
        return [_finite(inner) for inner in value]
    return None if isinstance(value, float) and not isfinite(value) else value


def summary(diagnosis: Diagnosis) -> list[str]:
    """The verdict in ten lines or fewer."""
    verdict, gap, impact = diagnosis.verdict, diagnosis.verdict.gap, diagnosis.yaw_impact
    lines = [f"contradiction of facts: {one.says}" for one in diagnosis.contradictions]
    lines.append(headline(diagnosis))
    lines += [f"  {said(cause)}" for cause in verdict.causes[:SHOWN]]
    lines += [
        f"  negligible: {said(one.cause)}; costs {one.yaw_deg:.2g} deg of yaw" for one in verdict.negligible[:SHOWN]
    ]
    if verdict.where:
        lines.append(f"where: {_listed(verdict.where)}")
    if verdict.causes and verdict.unexplained:
        lines.append(f"unexplained: {_listed(verdict.unexplained)}")
    corrected = bool(verdict.causes)
    shrink = "" if gap.shrink is None or not corrected else f"; {100.0 * gap.shrink:.0f} % of the gap closed"
    gaps = f"{gap.before:.2f} σ simulator as it is, " + f"{gap.after:.2f} σ corrected, " * corrected
    judged = "held-out sessions" if len(diagnosis.sessions) > 1 else "the session it was fitted on"
    lines.append(f"gap, RMS of all features on {judged}: {gaps}{gap.floor:.2f} σ by chance{shrink}")
    yaws = f"{impact.e_real_deg:.3g} deg recordings, {impact.e_sim_before_deg:.3g} deg simulator as it is"
    lines.append(f"mean yaw error, one filter: {yaws}" + f", {impact.e_sim_after_deg:.3g} deg corrected" * corrected)
    lines.append(f"check by a linear model: {diagnosis.linear_model.says}")
    lines.append(f"next: {diagnosis.next_step}")
    return lines


def _listed(found: Sequence[Deviation]) -> str:
    """The worst, and how many there are beside."""
    more = f"; and {len(found) - SHOWN} more" if len(found) > SHOWN else ""
    return "; ".join(f"{says(one)} ({one.stage}, {WHEN[one.regime]})" for one in found[:SHOWN]) + more


def headline(diagnosis: Diagnosis) -> str:
    """The verdict as a sentence: each cause in plain words with its sign and size."""
    causes = "; ".join(effect_sentence(cause) for cause in diagnosis.verdict.causes)
    small = " and ".join(one.cause.effect.name for one in diagnosis.verdict.negligible)
    match diagnosis.verdict.kind:
        case Kind.NONE:
            beside = f", but for {small}, negligible in yaw" if small else ""
            return f"none: the simulator explains these sessions{beside}"
        case Kind.EFFECT:
            return f"effect: {causes}"
        case Kind.PARTLY:
            return f"partly: {causes}; part of the difference is unexplained"
        case Kind.UNKNOWN:
            return "unknown: the sessions differ from the simulator, and no effect of the simulator explains it"


def said(cause: NamedCause) -> str:
    """A cause in one line."""
    first = cause.parameters[0]
    has = ""
    if cause.in_rig is not None:
        has = f" in the rig with {getattr(cause.in_rig, first.name):.4g} {first.unit}, the sessions say"
    phase = ", a phase of its own in each session" if cause.cause.phases_deg is not None else ""
    tied = ""
    if cause.tied_with:
        others = " or ".join(cause.tied_with)
        tied = f"; could as well be {others} (one of them or of their group: {cause.group_probability:.2f})"
    return (
        f"{cause.effect.name}: {first.name}{has} {first.value:.4g} {first.unit} ({first.low:.4g} to {first.high:.4g})"
        f"{phase}, probability {cause.probability:.2f}{tied}"
    )
