"""What a turn has shown, as findings of `doctor`, and as JSON."""

from dataclasses import replace
from typing import Any

from gyrodrift.doctor.finding import DeviceFinding, error, note, ok, sentence, warning
from gyrodrift.doctor.turn.heard import TurnResult
from gyrodrift.doctor.turn.motion import Behaviour, ColumnMotion
from gyrodrift.doctor.turn.scale import HAND, QUARTER_DEG, Scale
from gyrodrift.doctor.turn.verdict import TurnedAngle, TurnedRate

MOST_NAMES = 8
"""Columns that are told of besides, the clearest first."""


def findings_of(result: TurnResult) -> list[DeviceFinding]:
    """The finding `turn`, and what else was seen, all of them with that id."""
    turned = result.verdict.turned
    if not result.is_found or turned is None:
        happened, _, do = result.question.partition("; ")
        return [_named(error(sentence(happened), sentence(do))), *_besides(result)]
    if not result.spec:
        return [_named(_of_protocol(result, turned))]
    says = _says_rate(turned) if isinstance(turned, TurnedRate) else _says_angle(turned)
    told = ok(says, abs(turned.turned_deg), "deg", f"Read it with {paste(result)}.")
    return [_named(told), *(_named(each) for each in _remarks(result, turned))]


def paste(result: TurnResult) -> str:
    """The option to paste."""
    return f"--columns '{result.spec}'"


def config_lines(result: TurnResult) -> str:
    """The same for a config, so that it is asked for once."""
    quoted = result.spec.replace('"', "")
    return f'columns: "{quoted}"\n'


def turn_json(result: TurnResult) -> dict[str, Any]:
    """`columns` for `--columns`, null where a question is left, and the evidence under `turn`."""
    verdict = result.verdict
    rate, angle = verdict.rate, verdict.angle
    evidence: dict[str, Any] = {
        "turned_deg": _rounded(abs(verdict.turned.turned_deg)) if verdict.turned else None,
        "read_back_deg": _rounded(result.read_deg) if result.spec else None,
        "rate": _rate_json(rate) if rate else None,
        "angle": _angle_json(angle) if angle else None,
        "question": result.question or None,
        "remarks": list(verdict.remarks),
        "seen": [_motion_json(each) for each in verdict.motions],
    }
    return {"columns": result.spec or None, "turn": evidence}


def _says_rate(rate: TurnedRate) -> str:
    motion = rate.motion
    return (
        f"{motion.series.name} is the yaw rate: it moved one way in the turn and came back,"
        f" {motion.clearness:.0f} times its noise. It adds up to {motion.integral:+.4g}, {_size(rate)};"
        f" a turn to the left makes it {_rise(motion.integral)}."
    )


def _size(rate: TurnedRate) -> str:
    scale = rate.scale
    if not scale.is_known:
        return f"{scale.per_dps:.4g} counts for each deg/s"
    stated = ", as it says" if rate.is_stated else ""
    return f"in {scale.near[0].about}{stated} (a quarter turn is {scale.near[0].per_dps * QUARTER_DEG:.4g})"


def _says_angle(angle: TurnedAngle) -> str:
    return (
        f"{angle.motion.series.name} is an angle: it changed by {angle.motion.change:+.4g} {angle.unit} and stayed;"
        f" a turn to the left makes it {_rise(angle.motion.change)}. The device's own filter has been at work on it."
    )


def _rise(change: float) -> str:
    return "rise" if change > 0.0 else "fall, so its sign is turned"


def _remarks(result: TurnResult, turned: TurnedRate | TurnedAngle) -> list[DeviceFinding]:
    found = [warning(sentence(each), "Trust the turn, or make it once more.") for each in result.verdict.remarks]
    if isinstance(turned, TurnedRate):
        if not turned.scale.is_known:
            found.append(_measured(turned.scale))
        if turned.motion.series.kind in {"gx", "gy"}:
            name, axis = turned.motion.series.name, turned.motion.series.kind[1]
            found.append(note(f"The {axis} axis of the sensor stands upright, so {name} is the yaw rate."))
        if result.verdict.angle is not None:
            found.append(note(f"{_says_angle(result.verdict.angle)} The rate is used, which no filter has touched."))
    return found


def _measured(scale: Scale) -> DeviceFinding:
    near = ", ".join(f"{each.option} ({each.about})" for each in scale.near)
    exact = f"If it is one of {near}, write that in its place" if near else "Take the figure of the sensor's data sheet"
    return warning(
        f"The scale is measured by a hand's quarter turn, to {HAND:.0%}: {scale.option}.",
        f"{exact}; gyrodrift calibrate measures it by whole turns.",
    )


def _of_protocol(result: TurnResult, turned: TurnedRate | TurnedAngle) -> DeviceFinding:
    """The rate of a protocol that states its unit, and of samples that were recorded."""
    name = result.heard.protocol
    if isinstance(turned, TurnedRate) and turned.scale.option == "dps" and turned.turned_deg > 0.0:
        return ok(f"The rate of {name} turned by {turned.turned_deg:.0f} deg to the left: deg/s with the right sign.")
    if isinstance(turned, TurnedRate) and turned.scale.option == "dps":
        return error(
            f"The rate of {name} turned to the right: its sign is the other one.",
            "Mount the sensor the other way up, or turn the sign in the firmware; if you turned right, do it again.",
        )
    what = turned.scale.option if isinstance(turned, TurnedRate) else turned.unit
    return error(f"What {name} calls deg/s is {what}.", "Scale it in the firmware, or print lines and name the unit.")


def _besides(result: TurnResult) -> list[DeviceFinding]:
    """What the columns did, where a question is left."""
    moved = [each for each in result.verdict.motions if each.behaviour not in {Behaviour.QUIET, Behaviour.GROWS}]
    moved.sort(key=lambda each: -each.clearness)
    return [_named(note(f"{each.series.name} {_did(each)}.")) for each in moved[:MOST_NAMES]]


def _did(motion: ColumnMotion) -> str:
    if motion.behaviour in {Behaviour.STAYS, Behaviour.RESTLESS}:
        return f"{motion.behaviour}: changed by {motion.change:+.3g}"
    share = motion.integral / QUARTER_DEG
    return f"{motion.behaviour}: adds up to {motion.integral:+.3g}, {share:.3g} for each deg/s of a quarter turn"


def _named(finding: DeviceFinding) -> DeviceFinding:
    return replace(finding, id="turn")


def _rate_json(rate: TurnedRate) -> dict[str, Any]:
    return {
        "column": rate.motion.series.name,
        "unit": rate.scale.option,
        "sign": 1 if rate.motion.integral > 0.0 else -1,
        "per_dps": _rounded(rate.scale.per_dps),
        "is_measured": not rate.scale.is_known,
        "near": [each.option for each in rate.scale.near],
        "integral": _rounded(rate.motion.integral),
        "clearness": _rounded(rate.motion.clearness),
    }


def _angle_json(angle: TurnedAngle) -> dict[str, Any]:
    return {
        "column": angle.motion.series.name,
        "unit": angle.unit,
        "sign": 1 if angle.turned_deg > 0.0 else -1,
        "change": _rounded(angle.motion.change),
    }


def _motion_json(motion: ColumnMotion) -> dict[str, Any]:
    return {
        "column": motion.series.name,
        "behaviour": str(motion.behaviour),
        "level": _rounded(motion.level),
        "noise": _rounded(motion.noise),
        "integral": _rounded(motion.integral),
        "change": _rounded(motion.change),
    }


def _rounded(value: float) -> float:
    return float(f"{value:.6g}")
