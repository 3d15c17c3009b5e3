"""How features answer to each candidate: a session's own figures, its null, and a table of simulated answers.

Everything a session contributes is worked out by itself, in one task; what follows works on the tables alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features import residuals as residual
from gyrodrift.diagnose.features.block_residuals import unexplained_dps
from gyrodrift.diagnose.features.design_matrix import TURN_ORDERS
from gyrodrift.diagnose.features.periodic import angle_shares, periodic_component
from gyrodrift.diagnose.features.rate_values import NEAR_ZERO_DPS, smallest
from gyrodrift.diagnose.features.spectral_line import spectral_line
from gyrodrift.diagnose.features.vector import measure
from gyrodrift.diagnose.recording.outliers import Cleaned, step_of
from gyrodrift.diagnose.recording.recording import Recording
from gyrodrift.diagnose.simulate.candidates import Candidate, Hints
from gyrodrift.diagnose.simulate.twin import Subject, subject_of

BASE_RUNS = 4
NULL_RUNS = 5
NULL_BASE_RUNS = 2
FIRST_NULL_SEED = 1000
TIMES_ONLY = frozenset({"clock_drift", "timestamp_jitter", "usb_batching"})
"""They leave rate and angle of each sample as they were."""

RATE_ONLY = frozenset(
    {
        "scale_factor",
        "scale_asymmetry",
        "nonlinearity",
        "vibration_rectification",
        "g_sensitivity",
        "temp_bias",
        "temp_scale",
        "warmup",
        "rate_random_walk",
        "bias_instability",
        "popcorn",
    }
)
"""They add to the rate something that is slow beside a sample: its noise, its numbers and its times stay."""

SPIKE_DPS, SLIP_DEG, LINE_HZ, SWING_S = 20.0, 0.5, 20.0, 100.0
"""Of candidates for which the recordings show nothing."""


@dataclass(frozen=True, slots=True)
class ResponseTable:
    """What a session says; F features, a row for each candidate's every node and run.

    difference, floors
        (F,) features of the recording less those of the rig driven through it; what does not matter.
    runs
        (runs, F) features of the latter, one throw of the dice each.
    nulls
        (runs, F) the same differences where the recording is the rig itself.
    answers
        Of each candidate that was simulated: (nodes, dice, F), change of the features when it is added.
    """

    name: str
    difference: Floats
    floors: Floats
    runs: Floats
    nulls: Floats
    answers: dict[str, Floats]


def key(candidate: Candidate) -> str:
    """By which its answers are found."""
    return f"{candidate.name} {candidate.variant}"


def simulated_key(candidate: Candidate, phase_deg: float) -> str:
    """The same of a turned candidate of another phase."""
    return f"{candidate.name} phase_deg {phase_deg:.4g}"


def table_of(recording: Recording, subject: Subject, asked: Sequence[Candidate]) -> ResponseTable:
    """Simulate all that is to be known of a session; the same dice with and without an effect."""
    own = subject.measured()
    played = [subject.replayed((), seed) for seed in range(BASE_RUNS)]
    runs = np.array([measure(one, subject.design, subject.facts).values for one in played])
    answers = {}
    for candidate in asked:
        if candidate.phase_deg in (None, 0.0, 90.0):
            nodes = [_answers(subject, candidate, float(node), played, runs) for node in candidate.nodes]
            answers[key(candidate)] = np.array(nodes)
    base = runs.mean(axis=0)
    nulls = np.array([_null(subject, FIRST_NULL_SEED + number) for number in range(NULL_RUNS)])
    return ResponseTable(recording.name, own.values - base, own.thresholds, runs, nulls, answers)


def _answers(
    subject: Subject, candidate: Candidate, size: float, played: Sequence[Cleaned], runs: Floats
) -> list[Floats]:
    """What a size changes, one row for each throw of the dice."""
    return [
        _with(subject, candidate, size, seed, played[seed], runs[seed]) - runs[seed] for seed in range(candidate.dice)
    ]


def _with(subject: Subject, candidate: Candidate, size: float, seed: int, played: Cleaned, without: Floats) -> Floats:
    """Features with a candidate; those that it cannot touch are taken over."""
    if candidate.shape is not None:
        slow = residual.measure(subject.with_shape(candidate.shape, size, seed, played), subject.design).values
        return np.concatenate([slow, without[len(slow) :]])
    effects = (candidate.make(size),)
    if candidate.name in RATE_ONLY:
        slow = residual.measure(subject.with_rate(effects, seed, played), subject.design).values
        return np.concatenate([slow, without[len(slow) :]])
    if candidate.name in TIMES_ONLY:
        times = subject.simulated_times(effects, seed).values
        return np.concatenate([without[: -len(times)], times])
    return subject.with_noise(candidate.noise_share).simulated(effects, seed).values


def _null(subject: Subject, seed: int) -> Floats:
    """The difference that is left when the rig is taken for a recording, and driven through itself."""
    played = subject.replayed((), seed)
    again = subject_of(played.recording, subject.rig)
    runs = [again.simulated((), number).values for number in range(NULL_BASE_RUNS)]
    left: Floats = again.measured().values - np.mean(runs, axis=0)
    return left


def _near_zero(cleaned: Cleaned) -> Floats:
    rates = cleaned.recording.rate_dps
    near = rates[np.isfinite(rates) & (np.abs(rates) < NEAR_ZERO_DPS)]
    return near if np.any(near != 0.0) else rates[np.isfinite(rates) & (rates != 0.0)]


def _order(shares: Floats) -> int:
    """Which part of a turn takes most, its sine and its cosine together."""
    return TURN_ORDERS[0] + int(np.argmax(shares.reshape(-1, 2).sum(axis=1)))


def hints_of(seen: Sequence[tuple[Cleaned, Subject]]) -> Hints:
    """The middle of what the sessions show, or what is usual where they show nothing."""
    lines = [spectral_line(cleaned, subject.design).frequency_hz for cleaned, subject in seen]
    slow = [_near_zero(cleaned) for cleaned, _ in seen]
    spikes = np.concatenate([np.abs(cleaned.spikes_dps) for cleaned, _ in seen])
    slips = np.concatenate([np.abs(cleaned.slips_deg) for cleaned, _ in seen])
    lefts = [(unexplained_dps(cleaned, subject.design), subject.design) for cleaned, subject in seen]
    turns = np.mean([angle_shares(left, design.turn_basis) for left, design in lefts], axis=0)
    angles = np.mean([angle_shares(left, design.turn_rate_basis) for left, design in lefts], axis=0)
    return Hints(
        line_hz=float(np.median(lines)) or LINE_HZ,
        rate_step_dps=float(np.median([step_of(rates) for rates in slow])),
        angle_step_deg=float(np.median([step_of(cleaned.recording.encoder_deg) for cleaned, _ in seen])),
        least_dps=float(np.median([smallest(rates[rates > 0.0]) for rates in map(np.abs, slow)])),
        largest_dps=max(float(np.abs(cleaned.rate_dps).max()) for cleaned, _ in seen),
        spike_dps=float(np.median(spikes)) if len(spikes) else SPIKE_DPS,
        slip_deg=float(np.median(slips)) if len(slips) else SLIP_DEG,
        swing_s=float(np.median([periodic_component(left)[1] for left, _ in lefts])) or SWING_S,
        ripple_order=_order(turns),
        angle_ripple_order=_order(angles),
    )
