"""The end of a report: detectable sizes of the effects, and the next steps."""

import shlex
from pathlib import Path

from gyrodrift.diagnose.inference.verdict import Kind, NamedCause
from gyrodrift.diagnose.report.files import PROFILE
from gyrodrift.diagnose.report.text import in_rig, quiet, size
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import command_line, headings, paragraph, section, table, text
from gyrodrift.html.numbers import significant


def detectable(diagnosis: Diagnosis) -> str:
    """The section of the detectable sizes."""
    rows = []
    for item in diagnosis.detectable:
        smallest, parameter = "none that was tried", ""
        if item.value is not None:
            smallest, parameter = size(item.value, item.unit), item.parameter
            parameter += "".join(f", {name} {significant(value, 4)}" for name, value in item.other_parameters.items())
        rows.append([text(item.effect), smallest, quiet(text(parameter)), item.stage])
    rows += [[text(item.effect), "–", quiet(text(item.why)), ""] for item in diagnosis.untestable]
    words = (
        "The smallest size of each effect that nine of ten such sets of sessions would have shown. An effect that is "
        "not named is smaller than this, or absent. Longer sessions and more varied motion show smaller effects. "
        "Steps, dead bands and limits are read directly from the recordings: only this size was tried."
    )
    head = headings(["effect", "smallest", "parameter, and others", "stage"], words=2)
    return section(
        "The smallest effects these sessions would show",
        paragraph(words),
        table("Each effect acting alone.", head, rows, words=2),
    )


def next_steps(diagnosis: Diagnosis, folder: Path) -> str:
    """The section of the next steps, with commands to copy."""
    rig, home = shlex.quote(str(folder / "rig.yaml")), folder
    simulated, tuned = shlex.quote(str(home / "simulated")), shlex.quote(str(home / "tuned.yaml"))
    steps = [
        ("Simulate sessions of that rig, faster than real time:", f"gyrodrift simulate --rig {rig} --out {simulated}"),
        ("Tune the filter on them:", f"gyrodrift tune {simulated} --out {tuned}"),
        ("Run the same rig as a device on a serial port:", f"gyrodrift simulated-device --link /tmp/gyro --rig {rig}"),
        (
            "Diagnose later recordings against that rig, to see whether a gap remains:",
            f"gyrodrift diagnose MORE --rig {rig} --out {shlex.quote(str(home / 'again'))}",
        ),
    ]
    if diagnosis.next_profile_yaml is not None:
        profile, combined = shlex.quote(str(home / PROFILE)), shlex.quote(str(home / "more"))
        steps += [
            (
                "Play the proposed motion on your own table. A simulated device plays it like this:",
                f"gyrodrift simulated-device --link /tmp/gyro --rig {rig} --profile {profile}",
            ),
            (
                "Diagnose recordings of it, in a folder MORE, together with these:",
                f"gyrodrift diagnose SESSIONS MORE --out {combined}",
            ),
        ]
    parts = [part for words, command in steps for part in (paragraph(words), command_line(command))]
    return section("What to do next", paragraph(_rig_words(diagnosis)), *parts)


def _rig_words(diagnosis: Diagnosis) -> str:
    """Content of `rig.yaml`, in a paragraph."""
    here = "<code>rig.yaml</code> beside this page is the rig"
    facts = ", with the facts that the recordings show" if diagnosis.contradictions else ""
    causes = diagnosis.verdict.causes
    new, changed = (
        " and ".join(_name(cause) for cause in causes if cause.is_adopted and bool(in_rig(cause)) is has)
        for has in (False, True)
    )
    undecided = " and ".join(_name(cause) for cause in causes if not cause.is_adopted)
    left_out = f" Without {undecided}: with a probability below 0.5 it is not decided yet." if undecided else ""
    if not new and not changed:
        as_it_was = facts or " as it was"
        return f"{here}{as_it_was}: there is nothing to switch on.{left_out}"
    limits = ""
    if diagnosis.verdict.kind is Kind.PARTLY or not diagnosis.verdict.gap.is_closed:
        limits = " Part of the gap stays open, as stated above: the rig is nearer to the device, and not the same."
    changes = [f"with {new} switched on at the fitted size"] * bool(new)
    changes += [f"with {changed} at the fitted size instead of its own (switched off if hardly any is left)"] * bool(
        changed
    )
    return f"{here} {' and '.join(changes)}{facts}.{left_out}{limits}"


def _name(cause: NamedCause) -> str:
    return f"<b>{text(cause.effect.name)}</b>"
