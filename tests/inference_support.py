"""Response tables by hand: a few sessions, candidates linear in their size, and their exact simulation."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.conclusion import GROUPS, Conclusion, conclude
from gyrodrift.diagnose.inference.density import Groups
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.inference.observation import Observation, observation_of
from gyrodrift.diagnose.inference.pooling import evidence_of
from gyrodrift.diagnose.inference.scorer import Scorer
from gyrodrift.diagnose.inference.template import Template, templates_of
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import ResponseTable, SimulatedSet, Sized, key
from gyrodrift.values.arrays import Floats

SESSIONS = 4
RUNS = 6
"""Null runs of each session."""

Amounts = Mapping[str, float]
"""Features by name, in sigmas; all others are 0."""

PARAMETERS = {
    "scale_factor": "error_percent",
    "scale_asymmetry": "error_percent",
    "misalignment": "tilt_deg",
    "clock_drift": "ppm",
    "temp_bias": "slope_dps_per_c",
    "latency": "delay_ms",
    "backlash": "play_deg",
    "bandwidth": "cutoff_hz",
    "vibration_rectification": "bias_dps_at_100_dps",
    "timestamp_jitter": "sigma_ms",
    "rate_random_walk": "density_dps_rts",
    "bias_instability": "floor_dph",
    "g_sensitivity": "amplitude_dps",
}
SIZES = np.arange(1.0, 9.0)


def row(amounts: Amounts) -> Floats:
    """(F,) as a vector."""
    values = np.zeros(len(FEATURES))
    for name, amount in amounts.items():
        values[NUMBER[name]] = amount
    return values


def rows(amounts: Amounts, sessions: int = SESSIONS) -> Floats:
    """(sessions, F) the same in every session."""
    return np.tile(row(amounts), (sessions, 1))


def candidate(name: str, sizes: Floats = SIZES, realisations: int = 1) -> Candidate:
    """An effect of the catalogue, or what none does where the name begins with a question mark."""

    def make(size: float) -> Effect:
        return CATALOGUE[name].model_validate({"name": name, PARAMETERS[name]: size})

    def shape(*_: object) -> Floats:
        raise AssertionError("nothing is simulated here")

    is_effect = name in CATALOGUE
    return Candidate(
        name,
        "",
        make,
        PARAMETERS.get(name, "size"),
        sizes,
        sizes,
        (KINDS[name].group or name) if name in KINDS else name,
        realisations=realisations,
        shape=None if is_effect else shape,
    )


class Simulated(NamedTuple):
    """A candidate with the changes that a simulator shows: (grid points, sessions, realisations, F)."""

    candidate: Candidate
    nodes: Floats


def simulated(name: str, per_size: Amounts, sizes: Floats = SIZES, sessions: int = SESSIONS) -> Simulated:
    """A candidate that moves features in proportion to its size."""
    nodes = sizes[:, None, None, None] * rows(per_size, sessions)[:, None]
    return Simulated(candidate(name, sizes), nodes)


def simulated_at_random(name: str, per_size: Floats, sizes: Floats = SIZES) -> Simulated:
    """A random candidate; `per_size` are its realisations in each session at size 1, (sessions, realisations, F)."""
    return Simulated(candidate(name, sizes, per_size.shape[1]), sizes[:, None, None, None] * per_size)


def tables(difference: Floats | Amounts, *tried: Simulated, nulls: Floats | None = None) -> list[ResponseTable]:
    """Sessions that differ from the rig; without other nulls each feature scatters by 1, independently in each."""
    away = rows(difference) if isinstance(difference, Mapping) else difference
    own = unit_nulls(len(away)) if nulls is None else nulls
    none = np.zeros(len(FEATURES))
    return [
        ResponseTable(
            f"session-{session}",
            away[session],
            none,
            own[session],
            own[session],
            {key(entry.candidate): entry.nodes[:, session] for entry in tried},
        )
        for session in range(len(away))
    ]


def unit_nulls(sessions: int) -> Floats:
    """(sessions, RUNS, F) null runs whose pooled variance is 1, and which sessions do not have in common."""
    signs = np.where((np.arange(sessions)[:, None] + np.arange(RUNS)) % 2, -1.0, 1.0)
    count = sessions * RUNS
    nulls: Floats = np.sqrt((count - 1.0) / count) * signs[:, :, None] * np.ones(len(FEATURES))
    return nulls


def simulator(*tried: Simulated) -> Callable[[Sequence[Sized]], SimulatedSet]:
    """A simulator of sets whose effects add up, each on straight lines between its grid points."""
    expected = {key(entry.candidate): entry for entry in tried}

    def simulate(effects: Sequence[Sized]) -> SimulatedSet:
        return exactly(np.sum([_between(expected[key(effect.candidate)], effect.size) for effect in effects], axis=0))

    return simulate


def _between(simulated: Simulated, size: float) -> Floats:
    """(S, F) change at a size, mean over realisations."""
    points, means = simulated.candidate.grid_points, simulated.nodes.mean(axis=2)
    position = float(np.interp(size, points, np.arange(len(points))))
    lower = min(int(position), len(points) - 2)
    change: Floats = means[lower] + (position - lower) * (means[lower + 1] - means[lower])
    return change


def concluded(difference: Floats | Amounts, *tried: Simulated) -> Conclusion:
    """Verdict and explanation of such sessions."""
    return conclude(tables(difference, *tried), [entry.candidate for entry in tried], simulator(*tried))


def observed(difference: Floats | Amounts, *, nulls: Floats | None = None) -> Observation:
    """The observation of such sessions, all features compared."""
    made = tables(difference, nulls=nulls)
    return observation_of(made, np.ones((len(made), len(FEATURES)), dtype=np.bool_))


def scorer_of(difference: Floats | Amounts, *tried: Simulated, nulls: Floats | None = None) -> Scorer:
    """A scorer of such sessions with a template of each candidate."""
    made = tables(difference, *tried, nulls=nulls)
    evidence = evidence_of(made, [entry.candidate for entry in tried])
    observation = observation_of(made, evidence.is_compared)
    stages = np.array([GROUPS.index((feature.stage, feature.regime)) for feature in FEATURES])
    groups = Groups(stages, len(GROUPS), np.logical_or.reduce(evidence.is_compared))
    templates = {item.name: item for item in templates_of(observation, evidence.responses)}
    return Scorer(observation, groups, templates)


def template_of(*tried: Simulated) -> Template:
    """The template of variants of one effect."""
    (template,) = scorer_of(np.zeros_like(tried[0].nodes[0, :, 0]), *tried).templates.values()
    return template


def response(name: str, per_size: Amounts, sizes: Floats = SIZES, sessions: int = SESSIONS) -> Response:
    return Response(candidate(name, sizes), sizes[:, None, None] * rows(per_size, sessions))


def evidence(difference: Floats | Amounts, *responses: Response) -> Evidence:
    """With a sigma of 1 everywhere, and nulls that are as large as that."""
    away = rows(difference) if isinstance(difference, Mapping) else difference
    nulls = np.where(np.arange(6)[:, None] % 2 == 0, 1.0, -1.0) * np.ones((len(away), 1, len(FEATURES)))
    names = tuple(f"session-{number}" for number in range(len(away)))
    return Evidence(names, away, np.ones_like(away), nulls, responses)


def exactly(change: Floats) -> SimulatedSet:
    return SimulatedSet(change, np.zeros_like(change), 3)


def with_difference(scorer: Scorer, difference: Floats) -> Scorer:
    observation = scorer.observation
    compared = np.where(observation.is_compared, difference, 0.0)
    return Scorer(replace(observation, difference=compared), scorer.groups, scorer.templates)
