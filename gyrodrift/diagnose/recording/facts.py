"""Facts that a rig states and recordings contradict: counts per turn, LSB, range, ratio of gyro and encoder angles.

The recorded values are compared with the stated fact. No simulation is compared: a wrong fact changes every feature,
and no effect explains that. Coarser steps that are a multiple of the stated step are no contradiction, because an
effect of the catalog causes them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.recording.levels import LEAST_GAPS, Levels, coherence, levels_of, off_grid
from gyrodrift.diagnose.recording.recording import Recording, filled

COUNTS_MOST = 32768
"""Largest magnitude of a signed 16-bit count. By definition."""

LSB_NEAR = 0.03
"""Relative tolerance of an LSB. Chosen: it is stated in a few digits, and differs from part to part by a few parts in a
thousand."""

TEXT_MOST = 0.25
"""Coarsest decimals of a file, as a share of a step, at which the step is still known. Chosen: rounding then moves a
value by at most an eighth of a step."""

LEAST_LEVELS = 50
"""Least number of different angles that show a grid of counts. Chosen: off the grid, the coherence of so many is about
0.14."""

ON_COUNTS, OFF_COUNTS = 0.9, 0.3
"""Coherence of the angles above which they are on a grid of counts, and up to which they are off it.

The coherence is |mean of exp(2πi·angle/count)|: 1 on the grid, and about 1/√n off it. Chosen: near 1, and twice that of
LEAST_LEVELS angles off the grid.
"""

FINER = 0.7
"""Gap between angles, as a share of the stated count, below which angles without steps contradict it. Chosen: gaps of
angles on the grid are whole counts."""

COMMON_CPR = (500, 512, 600, 720, 1000, 1024, 1440, 2000, 2048, 2400, 2500, 3600, 4000, 4096, 5000, 7200, 8000, 8192)
COMMON_FINE_CPR = (10_000, 14_400, 16_384, 20_000, 32_768, 36_000, 40_000, 65_536, 131_072, 262_144)
"""Counts per turn of encoders that are sold. Chosen: usual numbers of lines, their fourfold, and powers of two. They
are tried if the angles show no step: with a fine encoder few angles are neighboring counts."""

SAMPLES_BEYOND = 5
"""Least number of samples beyond the range that contradict it. Chosen: a few samples may be damaged."""

WINDOW_S = 1.0
"""Length of the windows in which the angles of gyro and encoder are compared. Chosen: a turn is many counts in it."""

TURNS = (0.25, 0.5, 2.0, 4.0)
"""Ratios of the angles of gyro and encoder that wrong counts per turn cause. Derived: a quadrature decoder counts one,
two or four edges per line."""

TURN_NEAR = 0.1
"""Relative tolerance of such a ratio, and of its difference between slow and fast turns. Chosen: scale errors of gyros
are smaller, and TURNS differ by factors of two."""

LEAST_TURN_DEG = 3.0
"""Least turn of the encoder in a window that gives a ratio. A window with a tenth of it counts as a rest. Chosen: large
against noise and counts."""


@dataclass(frozen=True, slots=True)
class Contradiction:
    """A fact of the rig that the recordings contradict.

    fact
        `encoder_cpr`, `dps_per_lsb`, `range_dps` or `turn_ratio`.
    rig, sessions
        Value that the rig states, and value from the recordings, in `unit`; None if the recordings have no steps.
    says
        A sentence with both values and with advice.
    """

    fact: str
    rig: float
    sessions: float | None
    unit: str
    says: str


def contradictions(recordings: Sequence[Recording], dps_per_lsb: float, cpr: int) -> tuple[Contradiction, ...]:
    """All facts of the rig that checked recordings contradict.

    dps_per_lsb, cpr
        Step of the rates, deg/s, and counts per turn of the encoder, as the rig states them.
    """
    counts = _counts(recordings, cpr)
    known_cpr = counts.sessions if counts is not None and counts.sessions else float(cpr)
    results = (counts, _lsb(recordings, dps_per_lsb), _range(recordings, dps_per_lsb))
    return tuple(result for result in (*results, _turns(recordings, known_cpr)) if result is not None)


def _lsb(recordings: Sequence[Recording], lsb_dps: float) -> Contradiction | None:
    """Contradiction of the LSB: 30 % of the small gaps between rates are no multiple of it."""
    levels = [levels_of(recording.rate_dps) for recording in recordings]
    readable = [own for own in levels if own.text <= TEXT_MOST * lsb_dps and len(own.values) > LEAST_GAPS]
    # If the step is half of the stated LSB, half of the gaps are off the grid.
    if not readable or np.median([off_grid(own, lsb_dps, LSB_NEAR) for own in readable]) < 0.3:
        return None
    steps = [own.step for own in readable]
    known_steps = np.array([step for step in steps if step is not None])
    rig = f"the rig's dps_per_lsb is {lsb_dps:.4g} deg/s"
    if len(known_steps) * 2 <= len(steps):
        shown = "the rates come in steps finer than that, or in none"
        do = "record what the gyro reads out, before it is scaled or filtered, or state a dps_per_lsb as fine as this"
        return Contradiction("dps_per_lsb", lsb_dps, None, "deg/s", f"{rig}, and {shown}: {do}")
    step = float(np.median(known_steps))
    kind = "finer than that" if step < lsb_dps * (1.0 - LSB_NEAR) else "no whole number of it"
    do = f"state dps_per_lsb: {step:.4g}, if that is the range the gyro was set to"
    says = f"{rig}, and the rates come in steps of {step:.4g} deg/s, {kind}: {do}"
    return Contradiction("dps_per_lsb", lsb_dps, step, "deg/s", says)


def _range(recordings: Sequence[Recording], lsb_dps: float) -> Contradiction | None:
    """Contradiction of the range: rates that 16 bits of the LSB do not hold."""
    most_dps = COUNTS_MOST * lsb_dps
    rates_dps = np.concatenate([recording.rate_dps for recording in recordings])
    beyond_dps = np.sort(np.abs(rates_dps[np.abs(rates_dps) > 1.01 * most_dps]))
    if len(beyond_dps) < SAMPLES_BEYOND:
        return None
    reached_dps = float(beyond_dps[-SAMPLES_BEYOND])
    limit = f"16 bits of the rig's {lsb_dps:.4g} deg/s hold {most_dps:.4g} deg/s"
    least = f"is the rig's dps_per_lsb right? At least {reached_dps / COUNTS_MOST:.3g} deg/s are needed"
    says = f"the sessions reach {reached_dps:.4g} deg/s, and {limit}: {least}"
    return Contradiction("range_dps", most_dps, reached_dps, "deg/s", says)


def _counts(recordings: Sequence[Recording], cpr: int) -> Contradiction | None:
    """Contradiction of the counts per turn: the angles are not on their grid."""
    if not cpr:
        return _no_encoder(recordings)
    count_deg = 360.0 / cpr
    levels = [levels_of(recording.encoder_deg) for recording in recordings]
    readable = [own for own in levels if own.text < 2.0 * TEXT_MOST * count_deg and _is_wide(own, count_deg)]
    if not readable or np.median([coherence(own, cpr) for own in readable]) > OFF_COUNTS:
        return None
    rig = f"the rig's encoder has {cpr} counts per turn, {count_deg:.4g} degrees each"
    recorded_cpr = _counts_per_turn(readable)
    if recorded_cpr is not None:
        kind = "finer than that" if recorded_cpr > cpr else "no whole number of these"
        do = f"state encoder_cpr: {recorded_cpr:.6g}, or convert the angles with {cpr}"
        shown = f"the angles come in steps of {360.0 / recorded_cpr:.4g} degrees ({recorded_cpr:.6g} per turn), {kind}"
        return Contradiction("encoder_cpr", float(cpr), recorded_cpr, "counts per turn", f"{rig}, and {shown}: {do}")
    if not any(own.has_gaps_below(FINER * count_deg) for own in readable):
        return None
    do = "state as many counts as the angles are fine, or record the encoder's own counts"
    says = f"{rig}, and the angles come in no steps, finer than that: {do}"
    return Contradiction("encoder_cpr", float(cpr), None, "counts per turn", says)


def _no_encoder(recordings: Sequence[Recording]) -> Contradiction:
    """Contradiction of a rig without an encoder."""
    levels = [levels_of(recording.encoder_deg) for recording in recordings]
    rig = "the rig's encoder has 0 counts per turn, which means no encoder, and the sessions have angles"
    recorded_cpr = _counts_per_turn(levels)
    if recorded_cpr is None:
        says = f"{rig}: state encoder_cpr"
        return Contradiction("encoder_cpr", 0.0, None, "counts per turn", says)
    says = f"{rig} in steps of {360.0 / recorded_cpr:.4g} degrees: state encoder_cpr: {recorded_cpr:.6g}"
    return Contradiction("encoder_cpr", 0.0, recorded_cpr, "counts per turn", says)


def _is_wide(levels: Levels, count_deg: float) -> bool:
    """Whether there are enough different angles, over more than five counts, to show a grid of counts."""
    return len(levels.values) >= LEAST_LEVELS and float(np.ptp(levels.values)) > 5.0 * count_deg


def _counts_per_turn(levels: Sequence[Levels]) -> float | None:
    """Counts per turn of recorded angles; None without steps.

    It is the whole number near the step of the angles with the largest coherence. If at most half of the recordings
    show a step, it is the first common number that fits.
    """
    steps = np.array([own.step for own in levels if own.step is not None])
    widest = max(levels, key=lambda own: len(own.values))
    if len(steps) * 2 <= len(levels):
        wide = len(widest.values) >= LEAST_LEVELS
        common = (cpr for cpr in (*COMMON_CPR, *COMMON_FINE_CPR) if wide and coherence(widest, cpr) > ON_COUNTS)
        return next(map(float, common), None)
    rough = 360.0 / float(np.median(steps))
    candidates = np.arange(max(1, int(rough * 0.98)), int(rough * 1.02) + 2)
    fits = np.array([coherence(widest, float(cpr)) for cpr in candidates])
    return float(candidates[np.argmax(fits)]) if fits.max() > ON_COUNTS else rough


def _turns(recordings: Sequence[Recording], cpr: float) -> Contradiction | None:
    """Contradiction of the counts per turn by the angle of the gyro: all recordings have the same ratio of TURNS."""
    gains = [gain for gain in map(_gain, recordings) if gain is not None]
    if not gains:
        return None
    gain = float(np.median(gains))
    near = [factor for factor in TURNS if all(abs(own / factor - 1.0) < TURN_NEAR for own in gains)]
    if not near or not cpr:
        return None
    agreeing_cpr = cpr / near[0]
    ratio = f"the gyro turns {gain:.3g} times as far as the encoder"
    why = "a quadrature decoder counts four edges a line: rig and file use different counts"
    do = f"with {agreeing_cpr:.6g} counts per turn instead of {cpr:.6g} they agree; convert the angles and state that"
    says = f"{ratio} ({why}): {do} as encoder_cpr, unless the rate's scale is wrong by that factor"
    return Contradiction("turn_ratio", cpr, agreeing_cpr, "counts per turn", says)


def _gain(recording: Recording) -> float | None:
    """Median ratio of the angles of gyro and encoder; None if slow and fast turns differ, or if there are too few."""
    window = max(1, round(WINDOW_S / recording.period_s))
    windows = len(recording.rate_dps) // window
    if windows < 2 or not recording.has_motion:
        return None
    ends = np.arange(windows + 1) * window
    gyro_deg = np.concatenate([[0.0], np.cumsum(filled(recording.rate_dps)) * recording.period_s])[ends]
    encoder_deg = filled(recording.encoder_deg)
    turn_deg, gyro_turn_deg = np.diff(encoder_deg[np.minimum(ends, len(encoder_deg) - 1)]), np.diff(gyro_deg)
    resting = np.abs(turn_deg) < 0.1 * LEAST_TURN_DEG
    bias_deg = np.median(gyro_turn_deg[resting]) if resting.any() else 0.0
    turns = np.abs(turn_deg) > LEAST_TURN_DEG
    ratios, sizes = (gyro_turn_deg[turns] - bias_deg) / turn_deg[turns], np.abs(turn_deg[turns])
    if len(ratios) < 8:
        return None
    slow, fast = (np.median(part) for part in (ratios[sizes <= np.median(sizes)], ratios[sizes >= np.median(sizes)]))
    whole = float(np.median(ratios))
    return whole if abs(slow - fast) < TURN_NEAR * abs(whole) else None
