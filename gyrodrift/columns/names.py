"""Names that sketches give to quantities, and a column while its meaning is being determined."""

import re
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import permutations

from gyrodrift.columns.units import TURNS_OR_RADIANS, Dimension, Unit, unit_of, without_unit

GYRO = "gyro?|gyr|gy|g|w|omega|rot|rate|gyroscope|rotation|rotationrate|angvel|angularvelocity|angularrate"
GYRO_WORDS = "gyro?|gyr|gyroscope|omega|angvel|angularvelocity|angularrate|rotationrate"
GYRO_ABROAD = (
    r"drehrate|winkelgeschwindigkeit|vitesseangulaire|velocidadangular|velocit(a|à)angolare"
    r"|giroscopio|giro|gyroskop|kreisel"
)
YAW_RATE_ABROAD = (
    "gierrate|giergeschwindigkeit|gierwinkelgeschwindigkeit|vitessedelacet|tauxdelacet|velocidaddegui[nñ]ada"
)
BRACKETED = re.compile(r"\([^)]{0,256}+\)|\[[^\]]{0,256}+\]")
"""Units and remarks in brackets after a name."""

NO_QUANTITY = re.compile(r"^(scaled|raw|got|calibrated|imu|mpu|icm|lsm|bmi|sensor|msg)+")
"""Words and chip names before a quantity."""

CHANGE, ANGLE = "delta|d|inc|incr|increment|incremental|change|diff", "theta|ang|angle|yaw|heading|psi|rot|rotation"
"""Words of an angle since the last sample, in any order: `dtheta_z`, `delta angle z`, `yaw increment`."""

SCALED = re.compile(r"[*×]|/\s*\d{2}|^\d{2,}\s")
"""Factors in a name, `gz*100`, `10 gz` or `gz/10`, which make it another quantity."""

PATH = re.compile(r"^(?:\w{0,16}:)?/(?:[^/]{0,64}/)*(?=[^/]{3})")
"""Path of a topic or table before the name of its value: `NT:/SmartDashboard/Gyro Rate`."""

INDEX = re.compile(r"\[([012])\]")
EITHER = re.compile(r"rot(ation)?z|gyro?yaw")
"""Names of a rate or an angle; only a unit decides."""

AXIS_OF_INDEX = {"0": "x", "1": "y", "2": "z"}
KINDS = {
    "clock": r"t|ts|time|timestamp|clock|millis|micros|ms|us|t(ime(stamp)?)?(ms|us|s|sec)"
    r"|([mun]|milli|micro|nano)?sec(s|onds?)?|nanos",
    "seq": r"seq|n|i|no|count(er)?|sample|id|index|frame",
    "rate": r"(yaw|z)rate(dps|deg|rads?|degs|rad)?|(gyro?|gyr|omega|w|rot)(z|dps|rads?)|gz|gyrz|gyroz(dps|rads?|degs)?"
    r"|(gyroscope|rotation|angvel|angularvelocity|angularrate)z|gyz|zgyro(rate)?|rotationratez"
    rf"|({GYRO_WORDS})?yaw(speed|vel(ocity)?|dot)|({GYRO_WORDS})yaw(rate)?|yaw({GYRO_WORDS})|psidot"
    rf"|({GYRO_ABROAD})z|{YAW_RATE_ABROAD}",
    "rates": r"(gyro?)?rate(dps|rads?)?|gyro?|gyr|omega|gyroscope|rotation|angvel|angularvelocity|angularrate"
    rf"|turnrate|rot|{GYRO_ABROAD}",
    "gx": rf"({GYRO}|{GYRO_ABROAD})x|({GYRO_WORDS})?roll(speed|vel(ocity)?)"
    rf"|({GYRO_WORDS})roll|rollrate|xgyro(rate)?|wankrate",
    "gy": rf"({GYRO}|{GYRO_ABROAD})y|({GYRO_WORDS})?pitch(speed|vel(ocity)?)"
    rf"|({GYRO_WORDS})pitch|pitchrate|ygyro(rate)?|nickrate",
    "temp": r"t(e)?mp(erature)?(c|degc)?|tempc",
    "encoder": r"enc(oder)?(deg)?|ref(erence)?(angle)?(deg)?",
    "ax": r"xacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc|linearacceleration)x",
    "ay": r"yacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc|linearacceleration)y",
    "az": r"zacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc|linearacceleration)z",
    "mx": r"(m|mag|magnetic|magnetometer)x",
    "my": r"(m|mag|magnetic|magnetometer)y",
    "mz": r"(m|mag|magnetic|magnetometer)z",
    "delta": rf"({CHANGE})({ANGLE})z?|({ANGLE})({CHANGE})z?",
    "yaw": r"(est|fused|current|gyro?)?yaw(angle)?(deg|rads?)?|psi|euleryaw|ypryaw|rpyyaw",
    "heading": r"(true|mag(netic)?|compass|gps|gnss|nav|boat|ship|vehicle)?(heading|hdg|course|bearing|azimuth)(deg)?"
    r"|compass|cog|courseoverground",
    "pitch": r"pitch(angle)?(deg|rads?)?|theta|eulerpitch",
    "roll": r"roll(angle)?(deg|rads?)?|phi|eulerroll",
    "angle": r"(acc|gyro)?(ypr|rpy|euler|angles?|orient(ation)?|attitude|ang|rot(ation)?vector)[xyzw]?|o[ypr]",
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
"""Columns after the first word of a line of known firmware, as entries of a SPEC.

Lower case: examples of i2cdevlib. Upper case: Razor AHRS, whose z axis points down.
"""

SENTENCE_OF_TURN, PER_MIN = re.compile(r"[A-Z]{2}ROT"), "lsb/60"
RATE_OF_TURN = f"rate:{PER_MIN}:-"
"""Sentence ROT of any talker, and its first value: deg/min to starboard (NMEA 0183)."""

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
"""Kinds of columns in units of rates, by their labels; columns without labels have the order x, y, z."""

USED = {"clock", "seq", "rate", "encoder", "temp", "yaw", "heading"}
ONE_OF = {"encoder", "temp", "seq"}
"""Kinds of which the first column counts; of several clocks, rates or angles the judge chooses or asks."""

QUATERNION = re.compile(r"(?:.*[\s._])?q(?:uat(?:ernion)?)?[\s._]?([wxyz0-3])", re.IGNORECASE)
SCALAR_FIRST = dict(zip("0123", "wxyz", strict=True))
"""Parts of q0 to q3, as in the filters of Madgwick and i2cdevlib; some libraries have the scalar last."""

AIMS = re.compile(r"target|set_?point|desired|cmd|command|(?<![a-z])(sp|ref|goal)(?![a-z])", re.IGNORECASE)
"""Labels of setpoints: such a quaternion is the desired orientation, not the measured one."""


@dataclass(slots=True)
class SeenColumn:
    """Column whose meaning is being determined.

    texts, numbers
        Values of all lines; `numbers` are empty if one of them is not a number.
    unit
        Unit from a label, a header or a word after the value; None without one.
    kind, why
        Key of KINDS, empty while unknown, and the reason.
    option
        Options after the kind in a SPEC, for known firmware, as in `rads:-`.
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
        """Whether all values are numbers."""
        return bool(self.numbers)

    @property
    def moves(self) -> float:
        """Range of the numbers."""
        return max(self.numbers) - min(self.numbers) if self.numbers else 0.0


def kind_of(label: str) -> str:
    """Key of KINDS for a label; empty without one."""
    name = BRACKETED.sub(_bracket_words, INDEX.sub(r".\1", PATH.sub("", label))).strip()
    if SCALED.search(name):
        return ""
    words, mark, axis = name.rpartition(".")
    if mark and axis in AXIS_OF_INDEX and (kind := kind_of(words)) in {"rate", *AXIS_OF}:
        return kind  # `gz.1` is a second gz
    named = f"{words}{AXIS_OF_INDEX[axis]}" if mark and axis in AXIS_OF_INDEX else f"{words}{axis}"
    words_alone = "".join(word for word in re.split(r"[\s_]+", named) if len(word) == 1 or unit_of(word) is None)
    return _kind_of(named) or _kind_of(words_alone) or _kind_of(without_unit(named))


def _bracket_words(match: re.Match[str]) -> str:
    """Words in brackets, which may name another quantity: `gz (bias)`; empty for units and numbers."""
    inner = TURNS_OR_RADIANS.sub("", match[0][1:-1])
    is_word = inner.replace(" ", "").isalpha() and len(inner) > 1 and unit_of(inner) is None
    return f" {inner} " if is_word else ""


def _kind_of(name: str) -> str:
    plain = NO_QUANTITY.sub("", re.sub(r"[^a-zàñ]", "", name.lower()))
    return next((kind for kind, names in KINDS.items() if re.fullmatch(names, plain)), "") if plain else ""


def name_by_label(columns: list[SeenColumn]) -> None:
    """Name columns by their labels. Label and unit must agree: Hz is not a rate. Clocks are named by the judge."""
    taken = {column.kind for column in columns}
    is_one = sum(map(_is_rate, columns)) == 1
    for column in columns:
        kind = kind_of(column.label) if column.is_numeric and not column.kind else ""
        if kind == "rates" and _is_rate(column) and is_one:
            kind = "rate"  # a single value of a gyro, in a unit of rates
        if kind not in {"", "clock"} and not (kind in ONE_OF and kind in taken) and _agrees(kind, column):
            column.kind, column.why = kind, f"is labeled {column.label}"
            taken.add(kind)
    for index in quaternion_of(columns).values():
        columns[index].kind = columns[index].kind or "quaternion"


DIMENSIONS = {
    "clock": (Dimension.TIME,),
    **dict.fromkeys(("rate", "gx", "gy"), (Dimension.RATE, Dimension.COUNTS, Dimension.ANGLE)),
    **dict.fromkeys(("ax", "ay", "az"), (Dimension.ACCELERATION, Dimension.COUNTS, Dimension.LENGTH)),
    **dict.fromkeys(("yaw", "heading", "encoder", "pitch", "roll", "delta"), (Dimension.ANGLE, Dimension.COUNTS)),
    "temp": (Dimension.TEMPERATURE, Dimension.COUNTS),
}
"""Allowed dimensions of a kind; some sketches write deg for deg/s, which is asked."""


def _agrees(kind: str, column: SeenColumn) -> bool:
    if kind == "rate" and EITHER.fullmatch(re.sub("[^a-z]", "", _name(column))):
        return _is_rate(column)
    return _measures(column, *DIMENSIONS.get(kind, tuple(Dimension)))


def _measures(column: SeenColumn, *dimensions: Dimension) -> bool:
    return column.unit is None or column.unit.dimension in dimensions


def name_by_known_row(columns: list[SeenColumn]) -> None:
    """Name the columns of known firmware by the first word of its lines."""
    word = "".join(columns[0].texts[:1]).rstrip(":=").lstrip("$")
    entries = (RATE_OF_TURN,) if SENTENCE_OF_TURN.fullmatch(word) else KNOWN_ROWS.get(word, ())
    followers = list(zip(columns[1:], entries, strict=False))
    of_sentences = [(column, RATE_OF_TURN) for column in columns if _is_rate_of_turn(column)]
    for column, entry in followers or of_sentences:
        if column.is_numeric:
            kind, _, option = entry.partition(":")
            column.kind, column.option = kind, option
            column.why = f"follows the word {word}" if followers else f"is labeled {column.label}, to starboard"


def _is_rate_of_turn(column: SeenColumn) -> bool:
    """Whether a label is that of a ship's rate of turn, in its unit."""
    is_per_min = column.unit is not None and column.unit.option == PER_MIN
    return SENTENCE_OF_TURN.fullmatch(column.label[:-2]) is not None or (
        without_unit(column.label).upper() == "ROT" and is_per_min
    )


def name_by_unit(columns: list[SeenColumn]) -> None:
    """Name one or three columns in units of rates, whose labels have at most an axis.

    Other words may mean another rate: `gz_bias`, `yaw_rate_setpoint`, `motor`.
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


def quaternion_of(columns: Sequence[SeenColumn]) -> dict[str, int]:
    """Indices of the parts w, x, y and z of the only quaternion; empty without one."""
    labels = ["" if AIMS.search(column.label) or not column.is_numeric else column.label.strip() for column in columns]
    matches = [
        (match[1].lower(), index) for index, label in enumerate(labels) if (match := QUATERNION.fullmatch(label))
    ]
    parts = {SCALAR_FIRST.get(part, part): index for part, index in matches}
    return parts if len(matches) == len(parts) == len(SCALAR_FIRST) else {}


def _name(column: SeenColumn) -> str:
    """Words of a label without its unit, and without the word axis."""
    words = re.split(r"[\s-]+", without_unit(PATH.sub("", column.label)).lower())
    return " ".join(word for word in words if unit_of(word) is None and word != "axis").strip()


def _is_rate(column: SeenColumn) -> bool:
    return column.unit is not None and column.unit.dimension is Dimension.RATE


def _is_setting(column: SeenColumn) -> bool:
    """Whether a value is constant, like a range or a limit; 0 may be the rate of a device at rest."""
    return not column.label and column.numbers[0] != 0.0 and column.moves == 0.0
