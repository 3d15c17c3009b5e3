"""What columns are called: the names that sketches give to quantities, and a column while it is being found out."""

import re
from dataclasses import dataclass

GYRO = "gyro?|gyr|gy|g|w|omega|rot|rate|gyroscope|rotation|rotationrate|angvel|angularvelocity|angularrate"
BESIDE = re.compile(r"\([^)]*+\)|\[[^\]]*+\]")
"""Units and remarks beside a name."""

NO_QUANTITY = re.compile(r"^(scaled|raw|got|calibrated|imu|mpu|icm|lsm|bmi|sensor)+")
"""Words and chips that are named before a quantity."""

PLACES = {"0": "x", "1": "y", "2": "z"}
KINDS = {
    "clock": r"t|ts|time|timestamp|clock|millis|micros|ms|us|t(ime(stamp)?)?(ms|us|s|sec)|sec(onds)?",
    "seq": r"seq|n|i|no|count(er)?|sample|id|index|frame",
    "rate": r"(yaw|z)rate(dps|deg|rads?)?|(rate|gyro?|gyr|omega|w|rot)(z|dps|rads?)?|gz|gyrz|gyroz(dps|rads?)?"
    r"|(gyroscope|rotation|angvel|angularvelocity|angularrate)z?|gyz|zgyro(rate)?|rotationratez",
    "gx": rf"({GYRO})x|rollrate|xgyro(rate)?",
    "gy": rf"({GYRO})y|pitchrate|ygyro(rate)?",
    "temp": r"t(e)?mp(erature)?(c|degc)?|tempc",
    "encoder": r"enc(oder)?(deg)?|angle(deg)?|ref(erence)?(deg)?",
    "ax": r"xacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc)x",
    "ay": r"yacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc)y",
    "az": r"zacc(el|eleration)?|(a|ac|acc|accelero|accel|acceleration|accelerometer|linacc)z",
    "mx": r"(m|mag|magnetic|magnetometer)x",
    "my": r"(m|mag|magnetic|magnetometer)y",
    "mz": r"(m|mag|magnetic|magnetometer)z",
    "yaw": r"yaw|heading|psi|euler(z|yaw)|ypr(yaw)?",
    "pitch": r"pitch|theta|euler(y|pitch)",
    "roll": r"roll|phi|euler(x|roll)",
    "angle": r"(acc)?(ypr|rpy|euler|angles?|orientation|attitude)[xyz]",
}
"""Names that sketches give to columns, without case, spaces and punctuation."""

SPOKEN = {"rate": "gz", "encoder": "encoder", "clock": "t"}
WORDS = {
    "ypr": ("yaw", "pitch", "roll"),
    "euler": ("yaw", "pitch", "roll"),
    "quat": ("qw", "qx", "qy", "qz"),
    "a/g": ("ax", "ay", "az", "gx", "gy", "rate"),
    "areal": ("ax", "ay", "az"),
    "aworld": ("ax", "ay", "az"),
}
"""A word that some sketches (the examples of i2cdevlib) begin each line with, and what follows it."""

USED = {"clock", "seq", "rate", "encoder", "temp"}


@dataclass(slots=True)
class SeenColumn:
    """A column while it is being found out.

    texts, numbers
        Of each line; `numbers` are empty where one of them is none.
    kind, why
        A key of KINDS, empty while unknown, and what speaks for it.
    """

    label: str
    texts: tuple[str, ...]
    numbers: tuple[float, ...]
    kind: str = ""
    why: str = ""

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
    words, mark, place = BESIDE.sub("", label).lower().rpartition(".")
    named = f"{words}{PLACES[place]}" if mark and place in PLACES else f"{words}{place}"
    plain = NO_QUANTITY.sub("", re.sub(r"[^a-z]", "", named))
    return next((kind for kind, names in KINDS.items() if re.fullmatch(names, plain)), "") if plain else ""


def name_by_label(columns: list[SeenColumn]) -> None:
    """What the labels say; of two rates the first."""
    taken: set[str] = set()
    for column in columns:
        kind = kind_of(column.label) if column.is_numeric else ""
        if kind and not (kind in USED and kind in taken):
            column.kind, column.why = kind, f"is labelled {column.label}"
            taken.add(kind)


def name_by_first_word(columns: list[SeenColumn]) -> None:
    """What the word before a row says."""
    word = columns[0].texts[0].rstrip(":").lower()
    for column, kind in zip(columns[1:], WORDS.get(word, ()), strict=False):
        if column.is_numeric:
            column.kind, column.why = kind, f"follows the word {word}"
