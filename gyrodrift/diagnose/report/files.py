"""The files of a diagnosis, and its verdict in ten lines."""

import json
from dataclasses import asdict
from math import isfinite
from pathlib import Path
from typing import Any

from gyrodrift.diagnose.diagnosis import Diagnosis
from gyrodrift.diagnose.inference.verdict import Deviation, Kind, NamedCause
from gyrodrift.files import write_whole
from gyrodrift.simulation.sessions import rig_yaml

SHOWN = 3


def write_files(folder: Path, diagnosis: Diagnosis) -> None:
    """`gap.json` and `rig.yaml`, each whole or not at all.

    Raises
    ------
    UsageError
        Where the folder cannot be written to.
    """
    text = json.dumps(_finite(content(diagnosis)), indent=1, allow_nan=False, ensure_ascii=False)
    write_whole(folder / "gap.json", [text, "\n"])
    write_whole(folder / "rig.yaml", [rig_yaml(diagnosis.rig)])


def content(diagnosis: Diagnosis) -> dict[str, Any]:
    """What `gap.json` holds."""
    verdict, worth = diagnosis.verdict, diagnosis.worth
    return {
        "verdict": verdict.kind.value,
        "causes": [_cause(cause) for cause in verdict.causes],
        "where": [_odd(odd) for odd in verdict.where],
        "leftover": [_odd(odd) for odd in verdict.leftover],
        "gap": asdict(verdict.gap),
        "yaw": {name: getattr(worth, name) for name in ("e_real_deg", "e_sim_before_deg", "e_sim_after_deg")},
        "transfer": {name: value for name, value in asdict(worth).items() if name.startswith("pi_")},
        "second_opinion": asdict(diagnosis.second),
        "detectable": diagnosis.detectable,
        "untestable": diagnosis.untestable,
        "calibration": diagnosis.calibration,
        "remarks": list(diagnosis.remarks),
        "sessions": list(diagnosis.sessions),
        "next": diagnosis.next,
        "seconds": round(diagnosis.seconds, 3),
    }


def _cause(cause: NamedCause) -> dict[str, Any]:
    parameters = {
        one.name: {"value": one.value, "low": one.low, "high": one.high, "unit": one.unit} for one in cause.parameters
    }
    return {
        "effect": cause.effect.name,
        "group": cause.group,
        "probability": round(cause.probability, 4),
        "parameters": parameters,
        "tied_with": list(cause.tied_with),
    }


def _odd(odd: Deviation) -> dict[str, Any]:
    return {
        "stage": odd.stage,
        "signature": odd.feature,
        "regime": odd.regime,
        "z": round(odd.z, 2),
        "share": round(odd.share, 4),
        "says": odd.says,
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
    verdict, gap, worth = diagnosis.verdict, diagnosis.verdict.gap, diagnosis.worth
    lines = [headline(diagnosis)]
    lines += [f"  {said(cause)}" for cause in verdict.causes[:SHOWN]]
    if verdict.where:
        lines.append("where: " + "; ".join(f"{odd.says} ({odd.stage}, {odd.regime})" for odd in verdict.where[:SHOWN]))
    if verdict.causes and verdict.leftover:
        lines.append("left over: " + "; ".join(f"{odd.says} ({odd.stage})" for odd in verdict.leftover[:SHOWN]))
    shrink = "" if gap.shrink is None else f", {100.0 * gap.shrink:.0f} % of what can be closed"
    gaps = f"{gap.before:.2f} before, {gap.after:.2f} after, {gap.floor:.2f} without one"
    judged = "sessions kept apart" if len(diagnosis.sessions) > 1 else "the session it was fitted on"
    lines.append(f"gap on {judged}: {gaps}{shrink}")
    lines.append(
        f"yaw error: {worth.e_real_deg:.3g} deg real; simulated {worth.e_sim_before_deg:.3g} before, "
        f"{worth.e_sim_after_deg:.3g} after"
    )
    lines.append(f"second opinion, by likelihood alone: {diagnosis.second.says}")
    lines.append(f"next: {diagnosis.next}")
    return lines


def headline(diagnosis: Diagnosis) -> str:
    """The verdict as a sentence."""
    names = " and ".join(cause.effect.name for cause in diagnosis.verdict.causes)
    match diagnosis.verdict.kind:
        case Kind.NONE:
            return "none: the simulator explains these sessions"
        case Kind.EFFECT:
            return f"effect: the sessions differ from the simulator by {names}"
        case Kind.PARTLY:
            explain = "explains" if len(diagnosis.verdict.causes) == 1 else "explain"
            return f"partly: {names} {explain} some of the difference, and something is left over"
        case Kind.UNKNOWN:
            return "unknown: the sessions differ from the simulator by something that none of its effects explains"


def said(cause: NamedCause) -> str:
    """A cause in one line."""
    first = cause.parameters[0]
    tied = f"; could as well be {', '.join(cause.tied_with)}" if cause.tied_with else ""
    return (
        f"{cause.effect.name}: {first.name} {first.value:.4g} {first.unit} ({first.low:.4g} to {first.high:.4g}), "
        f"probability {cause.probability:.2f}{tied}"
    )
