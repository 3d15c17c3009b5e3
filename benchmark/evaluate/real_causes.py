"""Real recordings whose cause is known, each with the source of its label. No label comes from a diagnosis.

A label is a group of effects that look alike. It is documented by the source of the data (`tests/data/README.md`), or
measured by a method that `diagnose` does not have; `source` says which. `test_real_causes.py` measures again.
"""

from collections.abc import Iterator
from dataclasses import dataclass

OUTSIDE = "outside the catalog"
"""Label of recordings with a known error that no effect describes: `unknown` and `partly` are right."""


@dataclass(frozen=True, slots=True)
class Device:
    """A sensor with its reference, as a rig states them.

    dps_per_lsb, encoder_cpr
        Steps of the rate, and counts per turn of the reference.
    """

    dps_per_lsb: float
    encoder_cpr: int


@dataclass(frozen=True, slots=True)
class LabeledCase:
    """Recordings of one diagnosis.

    name
        Of the case, unique.
    device
        Key of DEVICES.
    files
        Names of the recordings, without `.csv`.
    labels
        Groups that are known to act; the first cause has to belong to one of them.
    source
        Where the labels come from.
    also
        Groups that are documented or measured too, but that may be too small to show: neither asked for nor wrong.
    piece, pieces
        The index of one of so many equal parts of the recording.
    """

    name: str
    device: str
    files: tuple[str, ...]
    labels: tuple[str, ...]
    source: str
    also: tuple[str, ...] = ()
    piece: int = 0
    pieces: int = 1


DEVICES = {
    "thermal chamber": Device(250.0 / 32768.0, 36000),
    "MPU-6050 at rest": Device(250.0 / 32768.0, 36000),
    "BROAD": Device(2000.0 / 32767.0, 3_600_000),
    "LSM9DS0": Device(0.0175, 36000),
    "MPU-6500": Device(0.061, 36000),
    "MPU-9150": Device(0.061, 36000),
    "BNO085": Device(0.1119, 4096),
    "car": Device(0.01, 36000),
}
"""Steps of the rate from data sheets and README; 0.1119 is 1/512 rad/s."""

ARRIVAL = "documented: stamped on arrival over radio, 2 to 19 ms apart; measured: lag-1 correlation of the intervals"
LOOP = "measured: percentiles 1 and 99 of the intervals are 18 ms apart or more, their lag-1 correlation is near 0"
"""Sampled at irregular times, with right stamps. Stamps that scatter by themselves give a correlation of -0.5."""

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
        yield LabeledCase(
            name, "thermal chamber", ("temperature_sweep",), ("slow bias",), source, ("stochastic bias",), piece, 5
        )


def _bunched() -> Iterator[LabeledCase]:
    source = "documented: arrivals in bursts, recorded by the host; device times are the number over the mean rate"
    also = ("clock", "vibration")
    for piece in range(5):
        name = f"MPU-6050 at rest, part {piece + 1}"
        yield LabeledCase(name, "MPU-6050 at rest", ("mpu6050_still",), ("times",), source, also, piece, 5)


def _hand_held() -> Iterator[LabeledCase]:
    axes = "documented: motion in three axes, of which one is recorded"
    lags = {"06": "3.9 ± 0.1 ms", "14": "4.2 ± 0.2 ms"}
    yield LabeledCase("BROAD 01", "BROAD", ("broad_01",), (OUTSIDE,), axes)
    for number, lag in lags.items():
        source = f"measured: shift of the integral that fits the angle best, blocks of 20 s: {lag}; {axes}"
        yield LabeledCase(f"BROAD {number}", "BROAD", (f"broad_{number}",), ("lag",), source)


def _on_robot() -> Iterator[LabeledCase]:
    for device, sets in ROBOT.items():
        for number, names in enumerate(sets, 1):
            files = tuple(f"rasteiro_{name}_{SUFFIX[device]}" for name in names)
            also = ("lag", "outliers") if device == "LSM9DS0" else ("lag",)
            yield LabeledCase(f"{device}, set {number}", device, files, ("times",), ARRIVAL, also)


def _on_bench() -> Iterator[LabeledCase]:
    for day in BENCH_DAYS:
        also = ("times", "coarse values", "once per turn")
        yield LabeledCase(f"BNO085 {day}", "BNO085", (f"benchy_{day}",), (OUTSIDE,), LOOP, also)


def _in_car() -> Iterator[LabeledCase]:
    source = "measured: all stamps are multiples of 0.1 s to 1 ms, and the mean interval is 0.206 s"
    yield LabeledCase("car", "car", ("smartloc_berlin_potsdamer_platz",), ("times",), source)


CASES = (*_heated(), *_bunched(), *_on_robot(), *_in_car(), *_on_bench(), *_hand_held())
