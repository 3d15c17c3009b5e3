"""Question to the user if a table does not say which column is the rate, or in which unit."""

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite

from gyrodrift.columns.fields import as_label
from gyrodrift.columns.judge import ColumnVerdict
from gyrodrift.columns.keys import keys_of
from gyrodrift.columns.names import kind_of
from gyrodrift.columns.spec import CLOCK_US, selection
from gyrodrift.columns.times import is_time
from gyrodrift.columns.units import unit_in, unit_of
from gyrodrift.session.csv import OLD_NAMES, REQUIRED, slips_in
from gyrodrift.session.session import COLUMNS
from gyrodrift.session.tables.layout import is_value
from gyrodrift.session.tables.plan import Head
from gyrodrift.values.errors import DataError, shortened
from gyrodrift.values.words import suggestion

SHOWN = 20
LABEL_SHOWN = 48
AXES = {"rate", "gx", "gy"}
MEANINGS = {
    "seq": "a counter",
    "gz": "a rate about the vertical axis",
    "rates": "a rate about an unknown axis",
    "gx": "a rate about x",
    "gy": "a rate about y",
    "temp": "a temperature",
    "encoder": "a reference angle",
    **dict.fromkeys(("ax", "ay", "az"), "an acceleration"),
    **dict.fromkeys(("mx", "my", "mz"), "a magnetic field"),
    "yaw": "an angle about the vertical axis",
    "heading": "a heading, clockwise",
    "quaternion": "a part of a quaternion",
    **dict.fromkeys(("pitch", "roll", "angle"), "an angle"),
    **dict.fromkeys(CLOCK_US, "a clock"),
}
HOW = (
    "name them with --columns, one entry per column or LABEL=entry: the clock is t_s, t_ms, t_us or t_ns, and without"
    " one --sample-rate HZ states the rate of the rows; the rate about the vertical axis is rate with its unit, :dps,"
    " :rads, :mdps or :lsb/N for counts (N is in the sensor's data sheet); an angle since the last row is delta:deg or"
    " delta:rad; a reference angle is encoder:deg or encoder:rad; an angle of the device itself is yaw:deg or yaw:rad;"
    " LABEL=VALUE uses only the rows with this value; _ ignores a column"
)


def unclear(head: Head, verdict: ColumnVerdict) -> DataError:
    """Error that shows every column with its apparent meaning, and what is missing."""
    source = f"{head.path}:{head.line}" if head.line else f"{head.path}"
    lines = [_described(head, index, verdict) for index in range(min(head.width, SHOWN))]
    rest = [f"  and {head.width - SHOWN} more"] if head.width > SHOWN else []
    reason = f"{source}: {_reason(head, verdict)}:"
    return DataError("\n".join([reason, *lines, *rest, *_kinds(head, verdict), *_proposal(verdict), HOW]))


def _reason(head: Head, verdict: ColumnVerdict) -> str:
    names = "header does" if head.line else "labels do"
    says = f"its {names} not say" if head.labels else "it has no header, so nothing says"
    if verdict.turn is not None and verdict.clock is None:
        return f"{says} which column is the clock"
    question = f" ({verdict.question})" if verdict.question else ""
    return f"{says} which column is the rate and in which unit{question}"


def _proposal(verdict: ColumnVerdict) -> list[str]:
    """Line with the SPEC as far as the judge could tell."""
    if verdict.template is None:
        return []
    rate = "" if verdict.clock else " --sample-rate HZ"
    unit = f"; replace {', and '.join(verdict.missing)}" if verdict.missing else ""
    return [f"probably --columns '{verdict.template}'{rate}{unit} ({verdict.reasons})"]


def _kinds(head: Head, verdict: ColumnVerdict) -> list[str]:
    """Advice for a table whose rows are of several kinds, as a column of words says; the proposal may name one."""
    if any(column.looks_like == "sender" for column in verdict.columns) and verdict.template:
        return []
    for index in range(min(head.width, SHOWN)):
        label = head.labels[index].strip() if index < len(head.labels) else ""
        counts = dict.fromkeys(head.texts(index))
        are_words = not any(map(is_value, counts)) and not any(map(unit_of, counts))
        if are_words and (keys_of(head.texts(index), is_named=True) or not AXES.isdisjoint(map(kind_of, counts))):
            kinds = ", ".join(shortened(word, LABEL_SHOWN) for word in counts)
            entry = selection(as_label(label), next(iter(counts)))
            name = label or f"column {index + 1}"
            return [f"its rows are of several kinds by {name} ({kinds}): the entry {entry} keeps one"]
    return []


def check_header(head: Head) -> None:
    """Check that the header is as wide as the rows, and that no column name is misspelled.

    Raises
    ------
    DataError
        With both widths, or with the misspelled name.
    """
    if head.labels and head.width != len(head.labels):
        widths = f"rows have {head.width} values, the header has {len(head.labels)} columns"
        raise DataError(f"{head.path}:{head.line}: {widths}")
    labels = [label.strip() for label in head.labels]
    is_ours = bool(set(labels) & {"t_device_s", *OLD_NAMES})
    for index, meant in slips_in(labels).items():
        if is_ours or set(meant) & set(REQUIRED):
            hint = f"columns are {', '.join(COLUMNS)}"
            raise DataError(
                f"{head.path}:{head.line}: column {index + 1} is {labels[index]!r}; {suggestion(meant)} {hint}"
            )


def _described(head: Head, index: int, verdict: ColumnVerdict) -> str:
    label = head.labels[index].strip() if index < len(head.labels) else ""
    name = f" {shortened(label, LABEL_SHOWN)}" if label else ""
    looks = verdict.columns[index].looks_like if label else ""
    meaning = MEANINGS.get(looks, "unknown") if label else "no label"
    unit = unit_in(label)
    in_unit = f", in a unit of {unit.dimension}" if unit else ", no unit" if label and looks not in CLOCK_US else ""
    return f"  column {index + 1}{name}: {_values(head.texts(index))}; {meaning}{in_unit}"


def _values(texts: Sequence[str]) -> str:
    if not texts:
        return "empty"
    if is_time(texts[0]):
        return f"{texts[0]} …"
    try:
        numbers = [float(text.replace(",", ".")) for text in texts]
    except ValueError:
        return f"words such as {shortened(texts[0], LABEL_SHOWN)!r}"
    finite = [number for number in numbers if isfinite(number)]
    if not finite:
        return "no number"
    return f"{min(finite):.6g} … {max(finite):.6g}{_trend(finite)}"


def _trend(numbers: Sequence[float]) -> str:
    steps = [after - before for before, after in pairwise(numbers)]
    if not steps:
        return ""
    if not any(steps):
        return ", never changes"
    return f", grows by {sorted(steps)[len(steps) // 2]:.4g} a row" if min(steps) > 0.0 else ""
