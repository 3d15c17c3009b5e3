"""What else a report says: how small an effect would have been seen, and how to go on."""

import shlex
from pathlib import Path

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.diagnose.diagnosis import Diagnosis
from gyrodrift.diagnose.inference.verdict import Kind
from gyrodrift.diagnose.report.text import quiet, size
from gyrodrift.html.html import command_line, headings, paragraph, section, table, text


def detectable(diagnosis: Diagnosis) -> str:
    """The section of the smallest effects."""
    names = (name for name in diagnosis.drawn.attribution.names() if name in CATALOGUE)
    stages = {name: CATALOGUE[name].stage for name in names}
    rows = []
    for name, stage in stages.items():
        known = list(diagnosis.detectable.get(name, {}).items())
        parameter = known[0][0] if known else ""
        smallest = size(float(known[0][1]), str(known[1][1])) if known else "at no size that was tried"
        rows.append([text(name), smallest, quiet(text(parameter)), stage])
    rows += [[text(name), "–", quiet(text(why)), ""] for name, why in diagnosis.untestable.items()]
    words = (
        "The smallest effect of each kind that these sessions would have shown. What is smaller may be there: this is "
        "what it means that an effect is not named. Longer sessions and richer motion show smaller ones. Steps, "
        "dead bands and limits are read off the recordings themselves: only what was read was tried."
    )
    head = headings(["effect", "smallest", "parameter", "stage"], words=2)
    return section(
        "How small it could have been", paragraph(words), table("One effect at a time.", head, rows, words=2)
    )


def onward(diagnosis: Diagnosis, folder: Path) -> str:
    """The section of commands to be copied."""
    rig, home = shlex.quote(str(folder / "rig.yaml")), folder
    simulated, tuned = shlex.quote(str(home / "simulated")), shlex.quote(str(home / "tuned.yaml"))
    steps = [
        ("Sessions of that rig, without waiting for real time:", f"gyrodrift simulate --rig {rig} --out {simulated}"),
        ("The filter tuned on them:", f"gyrodrift tune {simulated} --out {tuned}"),
        ("The same rig as a device on a serial port:", f"python -m firmware_sim --link /tmp/gyro --rig {rig}"),
        (
            "When there are more recordings, asked whether anything is left:",
            f"gyrodrift diagnose MORE --rig {rig} --out {shlex.quote(str(home / 'again'))}",
        ),
    ]
    parts = [part for words, command in steps for part in (paragraph(words), command_line(command))]
    return section("How to go on", paragraph(_rig_words(diagnosis)), *parts)


def _rig_words(diagnosis: Diagnosis) -> str:
    names = " and ".join(f"<b>{text(cause.effect.name)}</b>" for cause in diagnosis.verdict.causes)
    if not names:
        return "<code>rig.yaml</code> beside this page is the rig as it was: there is nothing to switch on."
    doubt = ""
    if diagnosis.verdict.kind is Kind.UNKNOWN:
        doubt = " It does not explain the recordings: do not rely on what is tuned with it."
    if diagnosis.verdict.kind is Kind.PARTLY:
        doubt = " Something is left over, as said above: it is nearer to the real thing, and not the same."
    return f"<code>rig.yaml</code> beside this page is the rig with {names} switched on at the fitted size.{doubt}"
