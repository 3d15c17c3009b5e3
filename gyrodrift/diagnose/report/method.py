"""The end of a report: the rig beside the recordings, the recordings themselves, and what words mean."""

from gyrodrift import __version__
from gyrodrift.diagnose.result import DiagnosedSession, Diagnosis
from gyrodrift.html.html import command_line, facts, headings, paragraph, section, table, text
from gyrodrift.html.numbers import even, significant

UNITS = {"sample_rate_hz": "Hz", "noise_dps_rthz": "deg/s/√Hz", "bias_dps": "deg/s", "host_delay_s": "s"}

GAP = (
    "The root mean square over all features of how many times chance each deviates, at most 20 each. Without a gap it "
    "is what the simulator scores against itself. Closed is how much of what lies above that went away."
)
HELD_OUT = (
    "Leave-one-session-out cross-validation: for each session in turn the causes are fitted on all others; it is "
    "judged by what they leave unexplained of it."
)
PROBABILITY = (
    "How sure it is that this effect acts: by what would be lost without it, and what others would do as well."
)
YAW = "The mean absolute difference of filtered yaw and encoder, with one set of filter parameters."
TRANSFER = (
    "Sim-to-real transfer, what the gap costs: the filter is tuned on simulated sessions or on real ones, and scored "
    "on real ones held out. Where all three numbers are alike, this gap needs no repair for tuning."
)
GLOSSARY = (
    ("Gap", GAP),
    ("Held out", HELD_OUT),
    ("Probability", PROBABILITY),
    ("Mean yaw error", YAW),
    ("Tuned on", TRANSFER),
)


def calibration(diagnosis: Diagnosis) -> str:
    """The section of base values of the rig."""
    rows = []
    for one in diagnosis.calibration:
        numbers = even([one.rig, one.data, one.low, one.high])
        unit = f' <span class="note">{UNITS[one.name]}</span>' if one.name in UNITS else ""
        rows.append([f"{text(one.name)}{unit}", *numbers])
    words = (
        "Bias, noise and sample rate may differ from the rig's without being a fault of the simulator: they were "
        "fitted to each session first, and are no cause. Copy them into the rig if it is to stand for this device."
    )
    head = headings(["base value", "rig", "recordings", "least", "most"])
    return section("The rig beside the recordings", paragraph(words), table("Median of all sessions.", head, rows))


def how_it_was_done(diagnosis: Diagnosis, command: str) -> str:
    """The last section."""
    done = [("Took", f"{significant(diagnosis.seconds, 3)} s"), ("Made by", f"gyrodrift {text(__version__)}")]
    return section("How it was done", facts([*GLOSSARY, *done]), _sessions(diagnosis), command_line(command))


def _sessions(diagnosis: Diagnosis) -> str:
    sessions = diagnosis.sessions
    numbers = [
        even([session.minutes for session in sessions]),
        even([session.sample_rate_hz for session in sessions]),
        even([session.bias_dps for session in sessions]),
        even([session.noise_dps_rthz for session in sessions]),
    ]
    columns = zip(*numbers, strict=True)
    rows = [
        [f"{at}. {text(session.name)}", *row, _has(session)]
        for at, (session, row) in enumerate(zip(sessions, columns, strict=True), 1)
    ]
    head = headings(["session", "minutes", "Hz", "bias, deg/s", "noise, deg/s/√Hz", "beside rate and angle"], words=1)
    return table("The sessions, with the numbers that they have in the figures.", head, rows, words=1)


def _has(session: DiagnosedSession) -> str:
    has = {
        "host times": session.has_host_times,
        "temperature": session.has_temperature,
        "counter": session.has_counter,
    }
    return ", ".join(name for name, is_there in has.items() if is_there) or "nothing"
