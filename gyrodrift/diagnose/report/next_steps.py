"""What else a report says: how small an effect would have been seen, and how to go on."""

import shlex
from pathlib import Path

from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.report.files import PROFILE
from gyrodrift.diagnose.report.text import in_rig, quiet, size
from gyrodrift.diagnose.result import Diagnosis
from gyrodrift.html.html import command_line, headings, paragraph, section, table, text


def detectable(diagnosis: Diagnosis) -> str:
    """The section of the smallest effects."""
    rows = []
    for one in diagnosis.detectable:
        smallest, parameter = "none that was tried", ""
        if one.value is not None:
            smallest, parameter = size(one.value, one.unit), one.parameter
            parameter += "".join(f", {name} {value:.4g}" for name, value in one.other_parameters.items())
        rows.append([text(one.effect), smallest, quiet(text(parameter)), one.stage])
    rows += [[text(one.effect), "–", quiet(text(one.why)), ""] for one in diagnosis.untestable]
    words = (
        "The smallest size of each effect that these sessions would have shown. That an effect is not named means that "
        "it is smaller than this, not that it is absent. Longer sessions and more varied motion show smaller ones. "
        "Steps, dead bands and limits are read off the recordings: only the size that was read was tried."
    )
    head = headings(["effect", "smallest", "parameter, and others", "stage"], words=2)
    return section(
        "The smallest effects these sessions would show",
        paragraph(words),
        table("Each effect acting alone.", head, rows, words=2),
    )


def next_steps(diagnosis: Diagnosis, folder: Path) -> str:
    """The section of commands to be copied."""
    rig, home = shlex.quote(str(folder / "rig.yaml")), folder
    simulated, tuned = shlex.quote(str(home / "simulated")), shlex.quote(str(home / "tuned.yaml"))
    steps = [
        ("Simulate sessions of that rig, faster than real time:", f"gyrodrift simulate --rig {rig} --out {simulated}"),
        ("Tune the filter on them:", f"gyrodrift tune {simulated} --out {tuned}"),
        ("Run the same rig as a device on a serial port:", f"gyrodrift simulated-device --link /tmp/gyro --rig {rig}"),
        (
            "Diagnose later recordings against that rig, to see whether anything is left:",
            f"gyrodrift diagnose MORE --rig {rig} --out {shlex.quote(str(home / 'again'))}",
        ),
    ]
    if diagnosis.next_profile_yaml is not None:
        profile, more = shlex.quote(str(home / PROFILE)), shlex.quote(str(home / "more"))
        steps += [
            (
                "Play the motion that decides what is open on your own table; a simulated device plays it so:",
                f"gyrodrift simulated-device --link /tmp/gyro --rig {rig} --profile {profile}",
            ),
            (
                "Diagnose recordings of it, in a folder MORE, together with these:",
                f"gyrodrift diagnose SESSIONS MORE --out {more}",
            ),
        ]
    parts = [part for words, command in steps for part in (paragraph(words), command_line(command))]
    return section("What to do next", paragraph(_rig_words(diagnosis)), *parts)


def _rig_words(diagnosis: Diagnosis) -> str:
    here = "<code>rig.yaml</code> beside this page is the rig"
    facts = ", with the facts that the recordings show" if diagnosis.contradictions else ""
    new, changed = (
        " and ".join(f"<b>{text(one.effect.name)}</b>" for one in diagnosis.verdict.causes if bool(in_rig(one)) is has)
        for has in (False, True)
    )
    if not new and not changed:
        as_it_was = facts or " as it was"
        return f"{here}{as_it_was}: there is nothing to switch on."
    doubt = ""
    if diagnosis.verdict.kind is Kind.UNKNOWN:
        doubt = " It does not explain the recordings: do not rely on filters tuned with it."
    if diagnosis.verdict.kind is Kind.PARTLY:
        doubt = " Something stays unexplained, as said above: it is nearer to the real device, and not the same."
    said = [f"with {new} switched on at the fitted size"] * bool(new)
    said += [f"with {changed} at the fitted size instead of its own (switched off where hardly any is left)"] * bool(
        changed
    )
    return f"{here} {' and '.join(said)}{facts}.{doubt}"
