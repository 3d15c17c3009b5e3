"""Facts that a rig states and recordings contradict: counts per turn, LSB, range, turns of encoder and gyro.

What recordings show is judged by the values they hold, not by how a simulation of the rig would look: a wrong fact
makes every feature differ, and no effect explains that. Coarser steps that are whole numbers of the rig's are no
contradiction, since there is an effect that does that.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.diagnose.recording.levels import LEAST_GAPS, Levels, coherence, levels_of, off_grid
from gyrodrift.diagnose.recording.recording import Recording, filled

COUNTS_MOST = 32768
"""The largest of 16 bits with a sign."""

LSB_NEAR = 0.03
"""An LSB is stated in a few digits, and a device's own differs from its data sheet's by a few parts in a thousand."""

TEXT_MOST = 0.25
"""A file whose decimals are coarser than this share of a step hides what the steps are."""

LEAST_LEVELS = 50

ON_COUNTS, OFF_COUNTS = 0.9, 0.3
"""|mean of exp(2πi·angle/count)| is one on the grid; off it, it is about 1/√n."""

FINER = 0.7
"""Angles without steps contradict only a count that is clearly coarser than they are."""

COMMON_CPR = (500, 512, 600, 720, 1000, 1024, 1440, 2000, 2048, 2400, 2500, 3600, 4000, 4096, 5000, 7200, 8000, 8192)
COMMON_FINE_CPR = (10_000, 14_400, 16_384, 20_000, 32_768, 36_000, 40_000, 65_536, 131_072, 262_144)
"""Of encoders that are sold; one so fine that hardly two angles are neighbours does not show its step."""

SAMPLES_BEYOND = 5
"""A few damaged samples are no range."""

WINDOW_S = 1.0
TURNS = (0.25, 0.5, 2.0, 4.0)
TURN_NEAR = 0.1

LEAST_TURN_DEG = 3.0


@dataclass(frozen=True, slots=True)
class Contradiction:
    """A fact that cannot be as the rig states it.

    fact
        `encoder_cpr`, `dps_per_lsb`, `range_dps` or `turn_ratio`.
    rig, sessions
        What the rig states and what the recordings show, in `unit`; None where they show that there are no steps.
    says
        A sentence with both numbers and what to do.
    """

    fact: str
    rig: float
    sessions: float | None
    unit: str
    says: str


def contradictions(recordings: Sequence[Recording], dps_per_lsb: float, cpr: int) -> tuple[Contradiction, ...]:
    """All facts of the rig that the recordings contradict; recordings are as the checks left them, in degrees."""
    counts = _counts(recordings, cpr)
    known_cpr = counts.sessions if counts is not None and counts.sessions else float(cpr)
    found = (counts, _lsb(recordings, dps_per_lsb), _range(recordings, dps_per_lsb))
    return tuple(each for each in (*found, _turns(recordings, known_cpr)) if each is not None)


def _lsb(recordings: Sequence[Recording], lsb_dps: float) -> Contradiction | None:
    held = [levels_of(recording.rate_dps) for recording in recordings]
    told = [each for each in held if each.text <= TEXT_MOST * lsb_dps and len(each.values) > LEAST_GAPS]
    # Of a step that is half of the rig's, half of the gaps are off the grid.
    if not told or np.median([off_grid(each, lsb_dps, LSB_NEAR) for each in told]) < 0.3:
        return None
    steps = [each.step for each in told]
    known = np.array([step for step in steps if step is not None])
    rig = f"the rig's dps_per_lsb is {lsb_dps:.4g} deg/s"
    if len(known) * 2 <= len(steps):
        what = "the rates come in steps finer than that, or in none"
        do = "record what the gyro reads out, before it is scaled or filtered, or state a dps_per_lsb as fine as this"
        return Contradiction("dps_per_lsb", lsb_dps, None, "deg/s", f"{rig}, and {what}: {do}")
    step = float(np.median(known))
    kind = "finer than that" if step < lsb_dps * (1.0 - LSB_NEAR) else "no whole number of it"
    do = f"state dps_per_lsb: {step:.4g}, if that is the range the gyro was set to"
    says = f"{rig}, and the rates come in steps of {step:.4g} deg/s, {kind}: {do}"
    return Contradiction("dps_per_lsb", lsb_dps, step, "deg/s", says)


def _range(recordings: Sequence[Recording], lsb_dps: float) -> Contradiction | None:
    most_dps = COUNTS_MOST * lsb_dps
    rates_dps = np.concatenate([recording.rate_dps for recording in recordings])
    beyond_dps = np.sort(np.abs(rates_dps[np.abs(rates_dps) > 1.01 * most_dps]))
    if len(beyond_dps) < SAMPLES_BEYOND:
        return None
    reached_dps = float(beyond_dps[-SAMPLES_BEYOND])
    holds = f"16 bits of the rig's {lsb_dps:.4g} deg/s hold {most_dps:.4g} deg/s"
    least = f"is the rig's dps_per_lsb right? It takes {reached_dps / COUNTS_MOST:.3g} deg/s at least"
    says = f"the sessions reach {reached_dps:.4g} deg/s, and {holds}: {least}"
    return Contradiction("range_dps", most_dps, reached_dps, "deg/s", says)


def _counts(recordings: Sequence[Recording], cpr: int) -> Contradiction | None:
    if not cpr:
        return _no_encoder(recordings)
    count_deg = 360.0 / cpr
    held = [levels_of(recording.encoder_deg) for recording in recordings]
    told = [each for each in held if each.text < 2.0 * TEXT_MOST * count_deg and _spans(each, count_deg)]
    if not told or np.median([coherence(each, cpr) for each in told]) > OFF_COUNTS:
        return None
    rig = f"the rig's encoder has {cpr} counts per turn, {count_deg:.4g} degrees each"
    found = _counts_per_turn(told)
    if found is not None:
        kind = "finer than that" if found > cpr else "no whole number of these"
        do = f"state encoder_cpr: {found:.6g}, or convert the angles with {cpr}"
        shown = f"the angles come in steps of {360.0 / found:.4g} degrees ({found:.6g} per turn), {kind}"
        return Contradiction("encoder_cpr", float(cpr), found, "counts per turn", f"{rig}, and {shown}: {do}")
    if not any(each.has_gaps_below(FINER * count_deg) for each in told):
        return None
    do = "state as many counts as the angles are fine, or record the encoder's own counts"
    says = f"{rig}, and the angles come in no steps, finer than that: {do}"
    return Contradiction("encoder_cpr", float(cpr), None, "counts per turn", says)


def _no_encoder(recordings: Sequence[Recording]) -> Contradiction:
    held = [levels_of(recording.encoder_deg) for recording in recordings]
    rig = "the rig has 0 counts of an encoder per turn, none at all, and the sessions hold angles"
    found = _counts_per_turn(held)
    if found is None:
        says = f"{rig}: state encoder_cpr"
        return Contradiction("encoder_cpr", 0.0, None, "counts per turn", says)
    says = f"{rig} in steps of {360.0 / found:.4g} degrees: state encoder_cpr: {found:.6g}"
    return Contradiction("encoder_cpr", 0.0, found, "counts per turn", says)


def _spans(levels: Levels, count_deg: float) -> bool:
    # Fewer counts say nothing of a grid.
    return len(levels.values) >= LEAST_LEVELS and float(np.ptp(levels.values)) > 5.0 * count_deg


def _counts_per_turn(held: Sequence[Levels]) -> float | None:
    """The whole number near the step of the angles on whose grid they lie best, or a common one; None without steps."""
    known = np.array([each.step for each in held if each.step is not None])
    widest = max(held, key=lambda each: len(each.values))
    if len(known) * 2 <= len(held):
        wide = len(widest.values) >= LEAST_LEVELS
        common = (cpr for cpr in (*COMMON_CPR, *COMMON_FINE_CPR) if wide and coherence(widest, cpr) > ON_COUNTS)
        return next(map(float, common), None)
    rough = 360.0 / float(np.median(known))
    tried = np.arange(max(1, int(rough * 0.98)), int(rough * 1.02) + 2)
    fits = np.array([coherence(widest, float(cpr)) for cpr in tried])
    return float(tried[np.argmax(fits)]) if fits.max() > ON_COUNTS else rough


def _turns(recordings: Sequence[Recording], cpr: float) -> Contradiction | None:
    gains = [gain for gain in map(_gain, recordings) if gain is not None]
    if not gains:
        return None
    gain = float(np.median(gains))
    near = [factor for factor in TURNS if all(abs(each / factor - 1.0) < TURN_NEAR for each in gains)]
    if not near or not cpr:
        return None
    agree = cpr / near[0]
    turned = f"the gyro turns {gain:.3g} times as far as the encoder"
    why = "a quadrature decoder counts four edges a line: rig and file do not know the same counts"
    do = f"with {agree:.6g} counts per turn instead of {cpr:.6g} they agree; convert the angles anew, and state that"
    says = f"{turned} ({why}): {do} as encoder_cpr, unless the rate's scale is wrong by that factor"
    return Contradiction("turn_ratio", cpr, agree, "counts per turn", says)


def _gain(recording: Recording) -> float | None:
    """Turns of the gyro over those of the encoder; None where slow and fast turns differ, or there are too few."""
    points = max(1, round(WINDOW_S / recording.period_s))
    windows = len(recording.rate_dps) // points
    if windows < 2 or not recording.has_motion:
        return None
    ends = np.arange(windows + 1) * points
    gyro_deg = np.concatenate([[0.0], np.cumsum(filled(recording.rate_dps)) * recording.period_s])[ends]
    encoder_deg = filled(recording.encoder_deg)
    turned_deg, felt_deg = np.diff(encoder_deg[np.minimum(ends, len(encoder_deg) - 1)]), np.diff(gyro_deg)
    resting = np.abs(turned_deg) < 0.1 * LEAST_TURN_DEG
    bias_deg = np.median(felt_deg[resting]) if resting.any() else 0.0
    turns = np.abs(turned_deg) > LEAST_TURN_DEG
    ratios, sizes = (felt_deg[turns] - bias_deg) / turned_deg[turns], np.abs(turned_deg[turns])
    if len(ratios) < 8:
        return None
    slow, fast = (np.median(part) for part in (ratios[sizes <= np.median(sizes)], ratios[sizes >= np.median(sizes)]))
    whole = float(np.median(ratios))
    return whole if abs(slow - fast) < TURN_NEAR * abs(whole) else None
