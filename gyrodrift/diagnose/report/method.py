"""The end of a report: the rig beside the recordings, the recordings themselves, and what words mean."""

from gyrodrift import __version__
from gyrodrift.diagnose.diagnosis import Diagnosis
from gyrodrift.diagnose.simulate.twin import Subject
from gyrodrift.html.html import command_line, facts, headings, paragraph, section, table, text
from gyrodrift.html.numbers import even, significant

UNITS = {"sample_rate_hz": "Hz", "noise_dps_rthz": "deg/s/√Hz", "bias_dps": "deg/s", "host_delay_s": "s"}

GAP = (
    "The root mean square over all features of how many times chance each is off, at most 20 each. Without a gap it "
    "is what the simulator scores against itself. Closed is how much of what lies above that went away."
)
APART = "For each session in turn the causes are fitted on all others; it is judged by what they leave of it."
PROBABILITY = (
    "How sure it is that this effect acts: by what would be lost without it, and what others would do as well."
)
YAW = "The mean absolute difference of filtered yaw and encoder, with one set of filter parameters."
TUNED_ON = (
    "What the gap costs: the filter is tuned on simulated sessions or on real ones, and scored on real ones kept "
    "apart. Where all three numbers are alike, this gap needs no repair for tuning."
)
GLOSSARY = (
    ("Gap", GAP),
    ("Kept apart", APART),
    ("Probability", PROBABILITY),
    ("Mean yaw error", YAW),
    ("Tuned on", TUNED_ON),
)


def calibration(diagnosis: Diagnosis) -> str:
    """The section of base values of the rig."""
    rows = []
    for name, values in diagnosis.calibration.items():
        numbers = even([values[column] for column in ("rig", "data", "low", "high")])
        unit = f' <span class="note">{UNITS[name]}</span>' if name in UNITS else ""
        rows.append([f"{text(name)}{unit}", *numbers])
    words = (
        "Bias, noise and sample rate may differ from the rig's without being a fault of the simulator: they were "
        "fitted to each session first, and are no cause. Copy them into the rig if it is to stand for this device."
    )
    head = headings(["base value", "rig", "recordings", "least", "most"])
    return section("The rig beside the recordings", paragraph(words), table("Middle of all sessions.", head, rows))


def how_it_was_done(diagnosis: Diagnosis, command: str) -> str:
    """The last section."""
    done = [("Took", f"{significant(diagnosis.seconds, 3)} s"), ("Made by", f"gyrodrift {text(__version__)}")]
    return section("How it was done", facts([*GLOSSARY, *done]), _sessions(diagnosis), command_line(command))


def _sessions(diagnosis: Diagnosis) -> str:
    subjects = diagnosis.drawn.subjects
    numbers = [
        even([subject.seen.recording.seconds / 60.0 for subject in subjects]),
        even([1.0 / subject.seen.recording.period_s for subject in subjects]),
        even([subject.rig.base.bias_dps for subject in subjects]),
        even([subject.rig.base.noise_dps_rthz for subject in subjects]),
    ]
    columns = zip(*numbers, strict=True)
    rows = [
        [f"{at}. {text(subject.seen.recording.name)}", *row, _has(subject)]
        for at, (subject, row) in enumerate(zip(subjects, columns, strict=True), 1)
    ]
    head = headings(["session", "minutes", "Hz", "bias, deg/s", "noise, deg/s/√Hz", "beside rate and angle"], words=1)
    return table("The sessions, with the numbers that they have in the figures.", head, rows, words=1)


def _has(subject: Subject) -> str:
    recording = subject.seen.recording
    has = {
        "host times": recording.host_s is not None,
        "temperature": recording.temp_c is not None,
        "counter": recording.has_counter,
    }
    return ", ".join(name for name, is_there in has.items() if is_there) or "nothing"
