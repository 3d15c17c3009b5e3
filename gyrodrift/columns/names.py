"""What columns are called: the names that sketches give to quantities, and a column while it is being found out."""

import re
from dataclasses import dataclass
from itertools import permutations

from gyrodrift.columns.units import Dimension, Unit, unit_of, without_unit

GYRO = "gyro?|gyr|gy|g|w|omega|rot|rate|gyroscope|rotation|rotationrate|angvel|angularvelocity|angularrate"
GYRO_WORDS = "gyro?|gyr|gyroscope|omega|angvel|angularvelocity|angularrate|rotationrate"
GYRO_ABROAD = (
    r"drehrate|winkelgeschwindigkeit|vitesseangulaire|velocidadangular|velocit(a|à)angolare"
    r"|giroscopio|giro|gyroskop|kreisel"
)
YAW_RATE_ABROAD = (
    "gierrate|giergeschwindigkeit|gierwinkelgeschwindigkeit|vitessedelacet|tauxdelacet|velocidaddegui[nñ]ada"
)
BESIDE = re.compile(r"\([^)]{0,256}+\)|\[[^\]]{0,256}+\]")
"""Units and remarks beside a name."""

NO_QUANTITY = re.compile(r"^(scaled|raw|got|calibrated|imu|mpu|icm|lsm|bmi|sensor)+")
"""Words and chips that are named before a quantity."""

SCALED = re.compile(r"[*×]|/\s*\d{2}|^\d{2,}\s")
"""A name that is multiplied or divided, `gz*100`, `10 gz` or `gz/10`, is that of another number."""

INDEX = re.compile(r"\[([012])\]")
EITHER = re.compile(r"rot(ation)?z")
"""Rate or angle: only a unit of rates says which."""

PLACES = {"0": "x", "1": "y", "2": "z"}
KINDS = {
    "clock": r"t|ts|time|timestamp|clock|millis|micros|ms|us|t(ime(stamp)?)?(ms|us|s|sec)|sec(onds)?",
    "seq": r"seq|n|i|no|count(er)?|sample|id|index|frame",
    "rate": r"(yaw|z)rate(dps|deg|rads?|degs|rad)?|(gyro?|gyr|omega|w|rot)(z|dps|rads?)|gz|gyrz|gyroz(dps|rads?|degs)?"
    r"|(gyroscope|rotation|angvel|angularvelocity|angularrate)z|gyz|zgyro(rate)?|rotationratez"
    rf"|({GYRO_WORDS})yaw|yaw({GYRO_WORDS})|yaw(speed|vel(ocity)?|dot)|psidot|({GYRO_ABROAD})z|{YAW_RATE_ABROAD}",
    "rates": r"rate(dps|rads?)?|gyro?|gyr|omega|gyroscope|rotation|angvel|angularvelocity|angularrate|turnrate|rot"
    rf"|{GYRO_ABROAD}",
    "gx": rf"({GYRO}|{GYRO_ABROAD})x|({GYRO_WORDS})roll|rollrate|xgyro(rate)?|wankrate",
    "gy": rf"({GYRO}|{GYRO_ABROAD})y|({GYRO_WORDS})pitch|pitchrate|ygyro(rate)?|nickrate",
    "temp": r"t(e)?mp(erature)?(c|degc)?|tempc",
    "encoder": r"enc(oder)?(deg)?|ref(erence)?(angle)?(deg)?",
    "ax": r"xacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc)x",
    "ay": r"yacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc)y",
    "az": r"zacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc)z",
    "mx": r"(m|mag|magnetic|magnetometer)x",
    "my": r"(m|mag|magnetic|magnetometer)y",
    "mz": r"(m|mag|magnetic|magnetometer)z",
    "yaw": r"(est|fused|current)?yaw(angle)?(deg|rads?)?|psi|euleryaw|ypryaw|rpyyaw",
    "heading": r"(true|mag(netic)?|compass|gps|gnss|nav|boat|ship|vehicle)?(heading|hdg|course|bearing|azimuth)(deg)?"
    r"|compass|cog|courseoverground",
    "pitch": r"pitch(angle)?(deg|rads?)?|theta|eulerpitch",
    "roll": r"roll(angle)?(deg|rads?)?|phi|eulerroll",
    "angle": r"(acc)?(ypr|rpy|euler|angles?|orient(ation)?|attitude|ang|rot(ation)?vector)[xyzw]?|o[ypr]",
    "quaternion": r"q(uat(ernion)?)?[wxyz0123ijkr]|quat(ernion)?",
}
"""Names that sketches give to columns, without case, spaces and punctuation; `rates` name no axis."""

SPOKEN = {"rate": "gz", "encoder": "encoder", "clock": "t"}
KNOWN_ROWS: dict[str, tuple[str, ...]] = {
    "ypr": ("yaw:deg", "pitch", "roll"),
    "YPR": ("yaw:deg:-", "pitch", "roll"),
    "YPRAG": ("yaw:deg:-", "pitch", "roll", "ax", "ay", "az", "gx:rads", "gy:rads", "rate:rads:-"),
    "YPRAMG": (
        *("yaw:deg:-", "pitch", "roll", "ax", "ay", "az", "mx", "my", "mz"),
        "gx:rads",
        "gy:rads",
        "rate:rads:-",
    ),
    "euler": ("yaw:deg", "pitch", "roll"),
    "quat": ("qw", "qx", "qy", "qz"),
    "a/g": ("ax", "ay", "az", "gx", "gy", "rate"),
    "areal": ("ax", "ay", "az"),
    "aworld": ("ax", "ay", "az"),
}
"""Columns behind a word that known firmware begins its lines with, as entries of a SPEC.

In small letters the examples of i2cdevlib; in capitals Razor AHRS, whose z axis is downwards.
"""

AXIS_OF = {"gx": "x", "gy": "y", "rate": "z"}
AXES_OF_RATES: dict[tuple[str, ...], tuple[str, ...]] = {
    **dict.fromkeys((("",), ("z",), ("yaw",)), ("rate",)),
    ("", "", ""): ("gx", "gy", "rate"),
    **{
        order: tuple(("gx", "gy", "rate")[names.index(name)] for name in order)
        for names in (("x", "y", "z"), ("roll", "pitch", "yaw"), ("p", "q", "r"))
        for order in permutations(names)
    },
}
"""Kinds of columns in units of rates, by their labels; unlabelled ones stand in the order x, y, z."""

USED = {"clock", "seq", "rate", "encoder", "temp", "yaw", "heading"}


@dataclass(slots=True)
class SeenColumn:
    """A column while it is being found out.

    texts, numbers
        Of each line; `numbers` are empty where one of them is none.
    unit
        What a label, a header or a word behind the value says; None where nothing does.
    kind, why
        A key of KINDS, empty while unknown, and what speaks for it.
    option
        What follows the kind in a SPEC where known firmware lays it down, as in `rads:-`.
    """

    label: str
    texts: tuple[str, ...]
    numbers: tuple[float, ...]
    unit: Unit | None = None
    kind: str = ""
    why: str = ""
    option: str = ""

    @property
    def is_numeric(self) -> bool:
        """Whether every line has a number there."""
        return bool(self.numbers)

    @property
    def moves(self) -> float:
        """From the smallest number to the largest."""
        return max(self.numbers) - min(self.numbers) if self.numbers else 0.0


def kind_of(label: str) -> str:
    """The key of KINDS that a label means; empty where it is none of them."""
    name = BESIDE.sub(_beside, INDEX.sub(r".\1", label)).strip()
    if SCALED.search(name):
        return ""
    words, mark, place = name.rpartition(".")
    named = f"{words}{PLACES[place]}" if mark and place in PLACES else f"{words}{place}"
    without_unit = "".join(word for word in re.split(r"[\s_]+", named) if len(word) == 1 or unit_of(word) is None)
    return _kind_of(named) or _kind_of(without_unit)


def _beside(found: re.Match[str]) -> str:
    """Nothing for a unit and for what has numbers, such as a range; words may say another quantity: `gz (bias)`."""
    inner = found[0][1:-1]
    is_word = inner.replace(" ", "").isalpha() and len(inner) > 1 and unit_of(inner) is None
    return f" {inner} " if is_word else ""


def _kind_of(name: str) -> str:
    plain = NO_QUANTITY.sub("", re.sub(r"[^a-zàñ]", "", name.lower()))
    return next((kind for kind, names in KINDS.items() if re.fullmatch(names, plain)), "") if plain else ""


def name_by_label(columns: list[SeenColumn]) -> None:
    """What the labels say; of two rates the first. A label never stands against its unit: a rate in Hz is none."""
    taken = {column.kind for column in columns}
    is_one = sum(map(_is_rate, columns)) == 1
    for column in sorted(columns, key=_is_rate, reverse=True):  # of `gz_raw` and `gz` in deg/s the latter
        kind = kind_of(column.label) if column.is_numeric and not column.kind else ""
        if kind == "rates" and _is_rate(column) and is_one:
            kind = "rate"  # one value of a gyro, in a unit of rates
        if kind and not (kind in USED and kind in taken) and _agrees(kind, column):
            column.kind, column.why = kind, f"is labelled {column.label}"
            taken.add(kind)


DIMENSIONS = {
    "clock": (Dimension.TIME,),
    **dict.fromkeys(("rate", "gx", "gy"), (Dimension.RATE, Dimension.COUNTS, Dimension.ANGLE)),
    **dict.fromkeys(("ax", "ay", "az"), (Dimension.ACCELERATION, Dimension.COUNTS, Dimension.LENGTH)),
    **dict.fromkeys(("yaw", "heading", "encoder", "pitch", "roll"), (Dimension.ANGLE, Dimension.COUNTS)),
    "temp": (Dimension.TEMPERATURE, Dimension.COUNTS),
}
"""What a kind may be measured in; sketches write deg for deg/s, too, and that is asked for."""


def _agrees(kind: str, column: SeenColumn) -> bool:
    if kind == "rate" and EITHER.fullmatch(re.sub("[^a-z]", "", _name(column))):
        return _is_rate(column)
    return _measures(column, *DIMENSIONS.get(kind, tuple(Dimension)))


def _measures(column: SeenColumn, *dimensions: Dimension) -> bool:
    return column.unit is None or column.unit.dimension in dimensions


def name_by_known_row(columns: list[SeenColumn]) -> None:
    """What known firmware puts behind the word that its lines begin with."""
    word = columns[0].texts[0].rstrip(":=")
    for column, entry in zip(columns[1:], KNOWN_ROWS.get(word, ()), strict=False):
        if column.is_numeric:
            kind, _, option = entry.partition(":")
            column.kind, column.option, column.why = kind, option, f"follows the word {word}"


def name_by_unit(columns: list[SeenColumn]) -> None:
    """One value, or three, in units of rates, whose labels name an axis at most.

    Other words beside the unit may say that it is no rate of the device: `gz_bias`, `yaw_rate_setpoint`, `motor`.
    """
    if any(column.kind in {"rate", "gx", "gy"} for column in columns):
        return
    rates = [column for column in columns if column.is_numeric and _is_rate(column)]
    if any(_is_setting(column) for column in rates):
        return
    kinds = AXES_OF_RATES.get(tuple(map(_name, rates)), ())
    for column, kind in zip(rates, kinds, strict=False):
        column.kind = kind
        column.why = "is the only rate" if len(rates) == 1 else f"is the rate about {AXIS_OF[kind]} of three"


def _name(column: SeenColumn) -> str:
    """The words of a label without the unit."""
    return " ".join(word for word in without_unit(column.label).lower().split() if unit_of(word) is None)


def _is_rate(column: SeenColumn) -> bool:
    return column.unit is not None and column.unit.dimension is Dimension.RATE


def _is_setting(column: SeenColumn) -> bool:
    """Whether it is always the same, as a range or a limit is; a rate of 0 may be that of a device at rest."""
    return not column.label and column.numbers[0] != 0.0 and column.moves == 0.0
