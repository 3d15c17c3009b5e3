"""Real recordings whose cause is known, each with the source of its label. No label comes from a diagnosis.

A label is a group of effects that look alike. It is documented by the source of the data (`tests/data/README.md`), or
measured by a method that `diagnose` does not have; `source` says which. `test_real_causes.py` measures again.
"""

from collections.abc import Iterator
from dataclasses import dataclass

OUTSIDE = "outside the catalog"
"""Label of recordings with a known error that no effect describes: `unknown` and `partly` are right."""

NOTHING = "nothing changed"
"""Label of two sets of one device that do not differ: `none` is right."""


@dataclass(frozen=True, slots=True)
class Device:
    """A sensor with its reference, as a rig states them.

    dps_per_lsb, encoder_cpr
        Steps of the rate, and counts per turn of the reference.
    """

    dps_per_lsb: float
    encoder_cpr: int


@dataclass(frozen=True, slots=True)
class Piece:
    """A recording, or one of its equal parts.

    name
        Of the file, without its ending.
    axis
        Of the gyro, in an archive with three axes. A gyro on one axis has `-`. Empty: a session file.
    index, count
        Which part, of how many.
    """

    name: str
    axis: str = ""
    index: int = 0
    count: int = 1


@dataclass(frozen=True, slots=True)
class LabeledCase:
    """Recordings of one diagnosis.

    name
        Of the case, unique.
    device
        Key of DEVICES.
    files
        The recordings.
    labels
        Groups that are known to act; the first cause has to belong to one of them.
    source
        Where the labels come from.
    also
        Groups that are documented or measured too, but that may be too small to show: neither asked for nor wrong.
    baseline
        Earlier recordings of the device. The labels are what has changed since.
    """

    name: str
    device: str
    files: tuple[Piece, ...]
    labels: tuple[str, ...]
    source: str
    also: tuple[str, ...] = ()
    baseline: tuple[Piece, ...] = ()


DEVICES = {
    "thermal chamber": Device(250.0 / 32768.0, 36000),
    "MPU-6050 at rest": Device(250.0 / 32768.0, 36000),
    "BROAD": Device(2000.0 / 32767.0, 3_600_000),
    "LSM9DS0": Device(0.0175, 36000),
    "MPU-6500": Device(0.061, 36000),
    "MPU-9150": Device(0.061, 36000),
    "BNO085": Device(0.1119, 4096),
    "car": Device(0.01, 36000),
    "OpenAXES carpus": Device(0.002, 3_600_000),
    "OpenAXES radius": Device(0.002, 3_600_000),
    "DIODEM segment 1": Device(0.0305, 3_600_000),
    "DIODEM segment 2": Device(0.0305, 3_600_000),
    "DIODEM segment 3": Device(0.0305, 3_600_000),
    "DIODEM segment 4": Device(0.0305, 3_600_000),
    "DIODEM segment 5": Device(0.0305, 3_600_000),
    "BNO055": Device(0.0607, 3_600_000),
    "navX": Device(0.061, 3_600_000),
}
"""Steps of the rate from data sheets and README; 0.1119 is 1/512 rad/s.

OpenAXES and DIODEM have filtered them away: 16 bits of the stated ones hold their largest rates. That of the BNO055 is
the smallest difference of its rates. Optical references and robots are rounded to 1e-4°.
"""

ARRIVAL = "documented: stamped on arrival over radio, 2 to 19 ms apart; measured: lag-1 correlation of the intervals"
LOOP = "measured: percentiles 1 and 99 of the intervals are 18 ms apart or more, their lag-1 correlation is near 0"
"""Sampled at irregular times, with right stamps. Stamps that scatter by themselves give a correlation of -0.5."""

AXES = "documented: motion in three axes, of which one is recorded"
FIT = "measured: least squares of what the gyro turned in 0.5 s on what the reference turned about"
"""The reference's turn about the own axis, and about the other two; the shift with the least sum of squares is the lag.
`±` is the standard error of the regression, or of the median over eight pieces.
"""

ROBOT = {
    "LSM9DS0": (("ev50p_s3", "ev50p_s4", "v_300_s1"), ("ev50p_s1", "ev50p_s2", "v_300_s3")),
    "MPU-6500": (("ev50p_s3", "ev50p_s4"), ("ev50p_s1", "ev50p_s2", "v_300_s1")),
    "MPU-9150": (("v_300_s3", "v_500_s3"),),
}
"""Sequences of each sensor in sets of a minute; no recording is in two sets."""

SUFFIX = {
    "LSM9DS0": "lsm9ds0",
    "MPU-6500": "mpu6500rm3100",
    "MPU-9150": "mpu9150",
}

BENCH_DAYS = (
    "2026-02-20_22-07-43", "2026-02-21_11-05-26", "2026-04-07_11-58-03", "2026-04-27_21-04-21", "2026-04-30_22-08-27",
    "2026-05-01_19-19-05", "2026-05-02_08-23-41", "2026-05-03_21-22-30", "2026-05-14_13-55-27", "2026-05-18_19-09-36",
    "2026-05-29_20-54-04", "2026-05-30_10-36-49", "2026-05-31_14-20-25", "2026-06-06_17-17-26", "2026-06-17_21-22-20",
    "2026-06-25_08-21-12", "2026-06-28_19-41-56",
)  # fmt: skip
"""The first recording of each day that lasts a minute and turns 30°."""


def _heated() -> Iterator[LabeledCase]:
    source = "documented: at rest in a thermal chamber, the bias follows the temperature with hysteresis"
    for piece in range(5):
        name = f"thermal chamber, part {piece + 1}"
        part = Piece("temperature_sweep", index=piece, count=5)
        yield LabeledCase(name, "thermal chamber", (part,), ("slow bias",), source, ("stochastic bias",))


def _bunched() -> Iterator[LabeledCase]:
    source = "documented: arrivals in bursts, recorded by the host; device times are the number over the mean rate"
    also = ("clock", "vibration")
    halves = [Piece("mpu6050_still", index=index, count=2) for index in range(2)]
    same = (
        "measured: means 1.1223 and 1.1219 deg/s, standard deviations 0.1132 and 0.1128, a tone at 31.4 Hz of 0.0157 "
        "and 0.0165, percentile 99 of the arrivals' intervals 68 and 69 ms"
    )
    yield LabeledCase(
        "MPU-6050 at rest, second half", "MPU-6050 at rest", (halves[1],), (NOTHING,), same, baseline=(halves[0],)
    )
    for piece in range(5):
        part = Piece("mpu6050_still", index=piece, count=5)
        yield LabeledCase(f"MPU-6050 at rest, part {piece + 1}", "MPU-6050 at rest", (part,), ("times",), source, also)


LAGS_MS = {
    "06": "3.9 ± 0.1", "14": "4.2 ± 0.2", "03": "4.3", "05": "4.3", "09": "4.2", "12": "4.0", "16": "4.2", "24": "4.1",
    "27": "4.1", "33": "4.3", "35": "4.1",
}  # fmt: skip
"""Of the z axis by trial: the first two from shifts of the integral in blocks of 20 s, the others by FIT. The other two
axes of all trials have 3.4 to 4.8 ms."""

SESSIONS = ("01", "06", "14")
"""Trials that are session files; the others are archives."""


def _trial(number: str) -> Piece:
    return Piece(f"broad_{number}", "" if number in SESSIONS else "z")


def _hand_held() -> Iterator[LabeledCase]:
    yield LabeledCase("BROAD 01", "BROAD", (_trial("01"),), (OUTSIDE,), AXES, ("lag",))
    x = {number: Piece(f"broad_{number}", "x") for number in ("03", "06", "24")}
    faster = (
        f"{FIT}: scale of x -0.25 ± 0.02 % and -0.23 ± 0.02 % in trials 03 and 24, +0.44 ± 0.02 % in 06 at 922 deg/s"
    )
    labels = ("scale", "nonlinearity")
    yield LabeledCase("BROAD 06 x since 03", "BROAD", (x["06"],), labels, faster, baseline=(x["03"], x["24"]))
    same = f"{FIT}: alone, scale -0.30 ± 0.05 % and -0.27 ± 0.03 %, lag 4.1 and 3.9 ms"
    yield LabeledCase("BROAD 27 since 12", "BROAD", (_trial("27"),), (NOTHING,), same, baseline=(_trial("12"),))
    for number, lag in LAGS_MS.items():
        source = f"measured: lag {lag} ms; {AXES}"
        yield LabeledCase(f"BROAD {number}", "BROAD", (_trial(number),), ("lag",), source, ("scale",))


def _on_robot() -> Iterator[LabeledCase]:
    for device, sets in ROBOT.items():
        for number, names in enumerate(sets, 1):
            files = tuple(Piece(f"rasteiro_{name}_{SUFFIX[device]}") for name in names)
            also = ("lag", "outliers") if device == "LSM9DS0" else ("lag",)
            yield LabeledCase(f"{device}, set {number}", device, files, ("times",), ARRIVAL, also)


def _on_bench() -> Iterator[LabeledCase]:
    same = (
        f"{FIT}: scale +0.20 ± 0.36 % and +0.79 ± 0.32 % before, +0.49 ± 0.37 % and -0.17 ± 0.32 % since, lags within "
        "2 ms, 19.1 Hz"
    )
    before, since = ("2026-05-29_20-54-04", "2026-05-29_21-44-47"), ("2026-05-29_22-00-54", "2026-05-31_14-20-25")
    last, now = (tuple(Piece(f"benchy_{day}") for day in days) for days in (before, since))
    yield LabeledCase("BNO085 since 2026-05-29", "BNO085", now, (NOTHING,), same, baseline=last)
    for day in BENCH_DAYS:
        also = ("times", "coarse values", "once per turn")
        yield LabeledCase(f"BNO085 {day}", "BNO085", (Piece(f"benchy_{day}"),), (OUTSIDE,), LOOP, also)


def _in_car() -> Iterator[LabeledCase]:
    source = "measured: all stamps are multiples of 0.1 s to 1 ms, and the mean interval is 0.206 s"
    yield LabeledCase("car", "car", (Piece("smartloc_berlin_potsdamer_platz"),), ("times",), source)


def _robot_arm(names: tuple[str, ...], axis: str) -> tuple[Piece, ...]:
    return tuple(Piece(f"openaxes_{name}", axis) for name in names)


def _on_arm() -> Iterator[LabeledCase]:
    """A board on each of two links of an arm that draws circles and triangles."""
    circles = ("circle_100_carpus", "circle_150_carpus", "circle_200_carpus")
    source = f"{FIT}: scale +1.03, +0.98, +1.06 (each ± 0.05) %, lag 4.3, 3.9, 3.9 ms"
    yield LabeledCase(
        "OpenAXES carpus", "OpenAXES carpus", _robot_arm(circles, "y"), ("scale", "lag"), source, ("vibration",)
    )
    triangles = ("triangle_150_radius", "triangle_200_radius", "triangle_250_radius")
    tilted = f"{FIT}: scale -1.80, -1.76, -1.82 (each ± 0.08) %, and 1.0 % of the turn about z"
    yield LabeledCase("OpenAXES radius x", "OpenAXES radius", _robot_arm(triangles, "x"), ("scale",), tilted)
    leaning = f"{FIT}: 1.0 % of the turn about x, which goes with its own: alone, scale +1.05, +1.04, +1.03 (± 0.09) %"
    yield LabeledCase("OpenAXES radius y", "OpenAXES radius", _robot_arm(triangles, "y"), ("scale",), leaning)
    same = f"{FIT}: alone, scale +0.44 ± 0.06 % and +0.36 ± 0.12 % before, +0.29 ± 0.08 % and +0.34 ± 0.14 % since"
    yield LabeledCase(
        "OpenAXES radius z, faster", "OpenAXES radius", _robot_arm(("triangle_250_radius", "circle_250_radius"), "z"),
        (NOTHING,), same, baseline=_robot_arm(("triangle_150_radius", "triangle_200_radius"), "z"),
    )  # fmt: skip


CHAIN = {
    "t2_seg1": ("x", "lag 2.3 ± 0.1 ms, scale -0.33 ± 0.08 %"),
    "t2_seg3": ("y", "lag 2.4 ± 0.1 ms, scale -0.58 ± 0.04 %"),
    "t2_seg5": ("y", "lag 2.6 ± 0.1 ms, scale -0.52 ± 0.05 %"),
}
"""An axis of each segment; the others have lags of 2.2 to 2.5 ms, and scales of -0.26 to -0.59 %."""

AHEAD = {
    "t1_seg2": ("x", "15.8 ms, 16.9 ± 0.9 in pieces"),
    "t1_seg4": ("y", "15.6 ms, 16.2 ± 1.4 in pieces"),
}


def _in_chain() -> Iterator[LabeledCase]:
    """Wireless units, one on each segment of a chain that is moved by hand."""
    for name, (axis, figures) in CHAIN.items():
        segment = f"DIODEM segment {name[-1]}"
        yield LabeledCase(segment, segment, (Piece(f"diodem_{name}", axis),), ("lag", "scale"), f"{FIT}: {figures}")
    for name, (axis, figures) in AHEAD.items():
        segment = f"DIODEM segment {name[-1]}"
        source = f"{FIT}: the rate is {figures} ahead of the reference; no effect makes the reference late"
        yield LabeledCase(segment, segment, (Piece(f"diodem_{name}", axis),), (OUTSIDE,), source, ("lag",))


def _small_cars() -> Iterator[LabeledCase]:
    """A robot car with the gyro of a fusion chip that takes its own bias out, at 10 Hz, beside an optical reference."""
    long = (Piece("dart_09_16_10_02_28", "-"),)
    short = tuple(Piece(f"dart_{name}", "-") for name in ("09_04_12_34_30", "09_16_17_17_59", "09_25_09_56_00"))
    scatter = (
        "measured: stamps scatter by 1.9 ms around an even grid, lag-1 correlation of the intervals -0.40 to -0.46"
    )
    scale = "scale -0.57 ± 0.14 % in the long one, -0.99 ± 0.32 % and -0.65 ± 0.25 % in two short ones, lags 4 to 7 ms"
    for name, files in (("BNO055, long", long), ("BNO055, short", short)):
        yield LabeledCase(name, "BNO055", files, ("times", "scale"), f"{scatter}; {scale}", ("lag",))
    yield LabeledCase("BNO055, long since short", "BNO055", long, (NOTHING,), f"measured: {scale}", baseline=short)


def _turtle() -> Iterator[LabeledCase]:
    files = tuple(Piece(f"turtlebot_navx_{number}", "-") for number in (0, 2, 6))
    source = (
        "documented: 50 Hz with repeats, host times; measured: 2 % of the rates in motion repeat the sample before, "
        "percentiles 1 and 99 of the intervals 11 and 31 ms, their lag-1 correlation -0.30 to -0.42"
    )
    yield LabeledCase("navX", "navX", files, ("times", "coarse values"), source, ("lag",))


CASES = (
    *_heated(), *_bunched(), *_on_robot(), *_in_car(), *_on_bench(), *_hand_held(), *_on_arm(), *_in_chain(),
    *_small_cars(), *_turtle(),
)  # fmt: skip
