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
        smallest, parameter = "at no size that was tried", ""
        if one.value is not None:
            smallest, parameter = size(one.value, one.unit), one.parameter
        rows.append([text(one.effect), smallest, quiet(text(parameter)), one.stage])
    rows += [[text(one.effect), "–", quiet(text(one.why)), ""] for one in diagnosis.untestable]
    words = (
        "The smallest effect of each kind that these sessions would have shown. What is smaller may be there: this is "
        "what it means that an effect is not named. Longer sessions and richer motion show smaller ones. Steps, "
        "dead bands and limits are read off the recordings themselves: only what was read was tried."
    )
    head = headings(["effect", "smallest", "parameter", "stage"], words=2)
    return section(
        "How small it could have been", paragraph(words), table("One effect at a time.", head, rows, words=2)
    )


def next_steps(diagnosis: Diagnosis, folder: Path) -> str:
    """The section of commands to be copied."""
    rig, home = shlex.quote(str(folder / "rig.yaml")), folder
    simulated, tuned = shlex.quote(str(home / "simulated")), shlex.quote(str(home / "tuned.yaml"))
    steps = [
        ("Sessions of that rig, without waiting for real time:", f"gyrodrift simulate --rig {rig} --out {simulated}"),
        ("The filter tuned on them:", f"gyrodrift tune {simulated} --out {tuned}"),
        ("The same rig as a device on a serial port:", f"python -m firmware_sim --link /tmp/gyro --rig {rig}"),
        (
            "Recordings made after this one, asked whether anything is left beside that rig:",
            f"gyrodrift diagnose MORE --rig {rig} --out {shlex.quote(str(home / 'again'))}",
        ),
    ]
    if diagnosis.next_profile_yaml is not None:
        profile, more = shlex.quote(str(home / PROFILE)), shlex.quote(str(home / "more"))
        steps += [
            (
                "The motion that decides what is open, for a table of your own; a simulated device plays it so:",
                f"python -m firmware_sim --link /tmp/gyro --rig {rig} --profile {profile}",
            ),
            (
                "Recordings of it in a folder, diagnosed with those that there are:",
                f"gyrodrift diagnose SESSIONS MORE --out {more}",
            ),
        ]
    parts = [part for words, command in steps for part in (paragraph(words), command_line(command))]
    return section("How to go on", paragraph(_rig_words(diagnosis)), *parts)


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
        doubt = " It does not explain the recordings: do not rely on what is tuned with it."
    if diagnosis.verdict.kind is Kind.PARTLY:
        doubt = " Something is unexplained, as said above: it is nearer to the real thing, and not the same."
    said = [f"with {new} switched on at the fitted size"] * bool(new)
    said += [f"with the fitted size of {changed} instead of its own (without it, where nearly nothing is left)"] * bool(
        changed
    )
    return f"{here} {' and '.join(said)}{facts}.{doubt}"
