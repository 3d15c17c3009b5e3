"""Flaws that are planted into real recordings: one half of the recordings of a device with the flaw, the other without.

The flaws are a few lines of numpy on the columns of a file (`blind.rows.tampering`); no simulator takes part. The
device keeps its own, unknown errors in both halves, which no simulated bench has.
"""

from collections.abc import Callable
from dataclasses import dataclass, field

from blind.rows.recordings import LEAST_SET_S, Rows, recordings_of
from blind.rows.tampering import tamper
from gyrogap.physics.dice import Rng, plan_dice
from gyrogap.physics.kinds import InjectedEffect

MOST_RECORDINGS = 4
"""Recordings in each half, so that a case takes a minute or two."""


@dataclass(frozen=True, slots=True)
class PlantedFlaw:
    """One case.

    device
        Key of `blind.rows.recordings.OWNED` or `FURTHER`.
    effects
        Effects that describe the flaw, the first as it was planted; empty if nothing was changed.
    """

    name: str
    device: str
    effects: tuple[str, ...] = ()
    parameters: dict[str, float] = field(default_factory=dict)


def _ramp(rows: Rows, _: Rng, *, dps: float) -> Rows:
    """A bias that rises evenly from the first sample to the last."""
    share = (rows.t_s - rows.t_s[0]) / rows.seconds
    return rows.with_columns(rate_dps=rows.columns["rate_dps"] + dps * share)


def _delay(rows: Rows, rng: Rng, *, samples: float) -> Rows:
    """The rate of some samples ago."""
    return tamper(rows, InjectedEffect("latency", {"delay_ms": 1e3 * samples / rows.rate_hz}), rng)


def _low_pass(rows: Rows, rng: Rng, *, cutoff_hz: float, order: float) -> Rows:
    """RC filters in series."""
    for _ in range(round(order)):
        rows = tamper(rows, InjectedEffect("bandwidth", {"cutoff_hz": cutoff_hz}), rng)
    return rows


OWN_FLAWS: dict[str, Callable[..., Rows]] = {"bandwidth": _low_pass, "latency": _delay, "warmup": _ramp}
"""Flaws that differ from those of `tamper`, by the first effect."""

SLOW = ("warmup", "rate_random_walk", "temp_bias")
"""Effects that a ramp in a recording without temperature can be."""

CASES = (
    PlantedFlaw("nothing, LSM9DS0", "lsm9ds0"),
    PlantedFlaw("scale +1.5 %", "lsm9ds0", ("scale_factor",), {"error_percent": 1.5}),
    PlantedFlaw("scale -1.5 %, 19 Hz", "benchy", ("scale_factor",), {"error_percent": -1.5}),
    PlantedFlaw("scale +1.5 %, 40 Hz", "diodem", ("scale_factor",), {"error_percent": 1.5}),
    PlantedFlaw("nothing, BNO085", "benchy"),
    PlantedFlaw("delay of 2 samples, 125 Hz", "openaxes", ("latency",), {"samples": 2.0}),
    PlantedFlaw("limit of 120 deg/s", "dart", ("saturation",), {"limit_dps": 120.0}),
    PlantedFlaw("nothing, MPU-6500", "mpu6500"),
    PlantedFlaw("1 % of the samples lost, with a counter", "mpu6050_still", ("sample_drop",), {"share_percent": 1.0}),
    PlantedFlaw("delay of 3 samples, MPU-6500", "mpu6500", ("latency",), {"samples": 3.0}),
    PlantedFlaw("nothing, MPU-6050 at rest", "mpu6050_still"),
    PlantedFlaw("scale -3 %", "car", ("scale_factor",), {"error_percent": -3.0}),
    PlantedFlaw("delay of 3 samples", "lsm9ds0", ("latency",), {"samples": 3.0}),
    PlantedFlaw("nothing, DIODEM", "diodem"),
    PlantedFlaw("delay of 2 samples", "benchy", ("latency",), {"samples": 2.0}),
    PlantedFlaw("nothing, OpenAXES", "openaxes"),
    PlantedFlaw("low-pass of 5 Hz, 40 Hz", "diodem", ("bandwidth",), {"cutoff_hz": 5.0, "order": 1.0}),
    PlantedFlaw("steps of 0.5 deg/s", "openaxes", ("quantization",), {"step_dps": 0.5}),
    PlantedFlaw("nothing, BNO055", "dart"),
    PlantedFlaw("3 % of the samples held, 10 Hz", "dart", ("stale_hold",), {"share_percent": 3.0}),
    PlantedFlaw("ramp of 0.5 deg/s", "mpu6050_still", SLOW, {"dps": 0.5}),
    PlantedFlaw("nothing, car", "car"),
    PlantedFlaw("limit of 40 deg/s, MPU-6500", "mpu6500", ("saturation",), {"limit_dps": 40.0}),
    PlantedFlaw("ramp of 1 deg/s, car", "car", SLOW, {"dps": 1.0}),
    PlantedFlaw("limit of 40 deg/s", "lsm9ds0", ("saturation",), {"limit_dps": 40.0}),
    PlantedFlaw("delay of 2 samples, 40 Hz", "diodem", ("latency",), {"samples": 2.0}),
    PlantedFlaw("scale +1.5 %, 125 Hz", "openaxes", ("scale_factor",), {"error_percent": 1.5}),
    PlantedFlaw("3 % of the samples held", "lsm9ds0", ("stale_hold",), {"share_percent": 3.0}),
    PlantedFlaw("steps of 1 deg/s", "lsm9ds0", ("quantization",), {"step_dps": 1.0}),
    PlantedFlaw("ramp of 1 deg/s", "lsm9ds0", SLOW, {"dps": 1.0}),
    PlantedFlaw("1 % of the samples lost", "broad", ("sample_drop",), {"share_percent": 1.0}),
    PlantedFlaw("nothing, BROAD", "broad"),
    PlantedFlaw("low-pass of 5 Hz", "broad", ("bandwidth",), {"cutoff_hz": 5.0, "order": 1.0}),
    PlantedFlaw("scale -1.5 %", "broad", ("scale_factor",), {"error_percent": -1.5}),
    PlantedFlaw("low-pass of 8 Hz, second order", "broad", ("bandwidth",), {"cutoff_hz": 8.0, "order": 2.0}),
    PlantedFlaw("delay of 4 samples", "broad", ("latency",), {"samples": 4.0}),
    PlantedFlaw("stamps that scatter by 1 ms", "broad", ("timestamp_jitter",), {"sigma_ms": 1.0}),
)


def halves(flaw: PlantedFlaw) -> tuple[list[Rows], list[Rows]]:
    """Recordings without and with the flaw: every second of the device; both empty without its files.

    If these are too short, each recording goes to the shorter half, the longest first.
    """
    recordings = recordings_of(flaw.device)
    parts = recordings[0::2][:MOST_RECORDINGS], recordings[1::2][:MOST_RECORDINGS]
    without, kept = ([*part] for part in parts)
    if recordings and min(map(_seconds, (without, kept))) < LEAST_SET_S:
        without, kept = [], []
        for rows in sorted(recordings, key=lambda rows: -rows.seconds):
            min(without, kept, key=_seconds).append(rows)
    return without, [planted(flaw, rows, number) for number, rows in enumerate(kept)]


def _seconds(recordings: list[Rows]) -> float:
    return sum(rows.seconds for rows in recordings)


def planted(flaw: PlantedFlaw, rows: Rows, number: int) -> Rows:
    """A recording with the flaw; the random numbers depend on the case and the number of the recording."""
    if not flaw.effects:
        return rows
    name, rng = flaw.effects[0], plan_dice(("planted", flaw.name, number))
    if name in OWN_FLAWS:
        return OWN_FLAWS[name](rows, rng, **flaw.parameters)
    return tamper(rows, InjectedEffect(name, flaw.parameters), rng)
