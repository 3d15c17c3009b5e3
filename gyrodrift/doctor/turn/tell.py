"""Result of a turn as findings of `doctor`, and as JSON."""

from dataclasses import replace
from typing import Any

from gyrodrift.columns.turn.motion import Behavior, ColumnMotion
from gyrodrift.columns.turn.scale import HAND, QUARTER_DEG, Scale
from gyrodrift.columns.turn.verdict import AngleColumn, RateColumn
from gyrodrift.doctor.finding import DeviceFinding, error, note, ok, sentence, warning
from gyrodrift.doctor.turn.heard import TurnResult

NAMES_MAX = 8
"""Largest number of columns in the notes of an unclear turn, the clearest first."""


def findings_of(result: TurnResult) -> list[DeviceFinding]:
    """Findings of a turn, all with the id `turn`."""
    column = result.verdict.column
    if not result.is_found or column is None:
        happened, _, do = result.question.partition("; ")
        return [_with_id(error(sentence(happened), sentence(do))), *_motion_notes(result)]
    if not result.spec:
        return [_with_id(_of_protocol(result, column))]
    says = _rate_text(column) if isinstance(column, RateColumn) else _angle_text(column)
    main = ok(says, abs(column.turn_deg), "deg", f"Read it with {paste(result)}.")
    return [_with_id(finding) for finding in (main, *_remarks(result, column))]


def paste(result: TurnResult) -> str:
    """Option for the command line."""
    return f"--columns '{result.spec}'"


def config_lines(result: TurnResult) -> str:
    """Line for a config."""
    quoted = result.spec.replace('"', "")
    return f'columns: "{quoted}"\n'


def turn_json(result: TurnResult) -> dict[str, Any]:
    """`columns` for `--columns`, null with a question, and the evidence under `turn`."""
    verdict = result.verdict
    rate, angle = verdict.rate, verdict.angle
    evidence: dict[str, Any] = {
        "turned_deg": _rounded(abs(verdict.column.turn_deg)) if verdict.column else None,
        "read_back_deg": _rounded(result.read_deg) if result.spec else None,
        "rate": _rate_json(rate) if rate else None,
        "angle": _angle_json(angle) if angle else None,
        "question": result.question or None,
        "remarks": list(verdict.remarks),
        "seen": [_motion_json(motion) for motion in verdict.motions],
    }
    return {"columns": result.spec or None, "turn": evidence}


def _rate_text(rate: RateColumn) -> str:
    motion = rate.motion
    return (
        f"{motion.series.name} is the yaw rate: it moved one way in the turn and came back,"
        f" {motion.clearness:.0f} times its noise. Its integral is {motion.integral:+.4g}, {_size(rate)};"
        f" a turn to the left makes it {_direction_text(motion.integral)}."
    )


def _size(rate: RateColumn) -> str:
    scale = rate.scale
    if not scale.is_known:
        return f"{scale.per_dps:.4g} counts per deg/s"
    stated = ", as its label says" if rate.is_stated else ""
    return f"in {scale.near[0].about}{stated} (a quarter turn is {scale.near[0].per_dps * QUARTER_DEG:.4g})"


def _angle_text(angle: AngleColumn) -> str:
    return (
        f"{angle.motion.series.name} is an angle: it changed by {angle.motion.change:+.4g} {angle.unit} and stayed;"
        f" a turn to the left makes it {_direction_text(angle.motion.change)}. A filter in the device has processed it."
    )


def _direction_text(change: float) -> str:
    return "rise" if change > 0.0 else "fall, so its sign is reversed"


def _remarks(result: TurnResult, column: RateColumn | AngleColumn) -> list[DeviceFinding]:
    findings = [warning(sentence(text), "Trust the turn, or repeat it.") for text in result.verdict.remarks]
    if isinstance(column, RateColumn):
        if not column.scale.is_known:
            findings.append(_measured(column.scale))
        if column.motion.series.kind in {"gx", "gy"}:
            name, axis = column.motion.series.name, column.motion.series.kind[1]
            findings.append(note(f"The {axis} axis of the sensor is vertical, so {name} is the yaw rate."))
        if result.verdict.angle is not None:
            findings.append(note(f"{_angle_text(result.verdict.angle)} The rate is used: no filter has processed it."))
    return findings


def _measured(scale: Scale) -> DeviceFinding:
    near = ", ".join(f"{unit.option} ({unit.about})" for unit in scale.near)
    exact = f"If it is one of {near}, use that instead" if near else "Use the value of the data sheet of the sensor"
    return warning(
        f"The scale is measured from a quarter turn by hand, to {HAND:.0%}: {scale.option}.",
        f"{exact}; gyrodrift calibrate measures it from whole turns.",
    )


def _of_protocol(result: TurnResult, column: RateColumn | AngleColumn) -> DeviceFinding:
    """Finding about the rate of a protocol with a fixed unit, or of a session."""
    name = result.heard.protocol
    if isinstance(column, RateColumn) and column.scale.option == "dps" and column.turn_deg > 0.0:
        return ok(f"The rate of {name} turned by {column.turn_deg:.0f} deg to the left: deg/s with the right sign.")
    if isinstance(column, RateColumn) and column.scale.option == "dps":
        return error(
            f"The rate of {name} turned to the right: its sign is wrong.",
            "Mount the sensor the other way up, or reverse the sign in the firmware. If you turned right, repeat it.",
        )
    unit = column.scale.option if isinstance(column, RateColumn) else column.unit
    return error(
        f"The rate of {name} is in {unit} instead of deg/s.",
        "Scale it in the firmware, or print text and name the unit.",
    )


def _motion_notes(result: TurnResult) -> list[DeviceFinding]:
    """Notes on the motions of the columns, if the turn is not clear."""
    unmoved = {Behavior.QUIET, Behavior.GROWS}
    moved = [motion for motion in result.verdict.motions if motion.behavior not in unmoved]
    moved.sort(key=lambda motion: -motion.clearness)
    return [_with_id(note(f"{motion.series.name} {_motion_text(motion)}.")) for motion in moved[:NAMES_MAX]]


def _motion_text(motion: ColumnMotion) -> str:
    if motion.behavior in {Behavior.STAYS, Behavior.RESTLESS}:
        return f"{motion.behavior}: changed by {motion.change:+.3g}"
    share = motion.integral / QUARTER_DEG
    return f"{motion.behavior}: integral {motion.integral:+.3g}, or {share:.3g} per deg/s of a quarter turn"


def _with_id(finding: DeviceFinding) -> DeviceFinding:
    return replace(finding, id="turn")


def _rate_json(rate: RateColumn) -> dict[str, Any]:
    return {
        "column": rate.motion.series.name,
        "unit": rate.scale.option,
        "sign": 1 if rate.motion.integral > 0.0 else -1,
        "per_dps": _rounded(rate.scale.per_dps),
        "is_measured": not rate.scale.is_known,
        "near": [unit.option for unit in rate.scale.near],
        "integral": _rounded(rate.motion.integral),
        "clearness": _rounded(rate.motion.clearness),
    }


def _angle_json(angle: AngleColumn) -> dict[str, Any]:
    return {
        "column": angle.motion.series.name,
        "unit": angle.unit,
        "sign": 1 if angle.turn_deg > 0.0 else -1,
        "change": _rounded(angle.motion.change),
    }


def _motion_json(motion: ColumnMotion) -> dict[str, Any]:
    return {
        "column": motion.series.name,
        "behaviour": str(motion.behavior),  # codespell:ignore behaviour - a published key
        "level": _rounded(motion.level),
        "noise": _rounded(motion.noise),
        "integral": _rounded(motion.integral),
        "change": _rounded(motion.change),
    }


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")
