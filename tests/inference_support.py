"""Evidence made by hand: a few sessions, candidates that are linear in their size, and their exact simulation."""

from collections.abc import Mapping, Sequence

import numpy as np
from gyrodrift.diagnose.inference.surrogate import Cause

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from gyrodrift.arrays import Floats
from gyrodrift.diagnose.features.vector import FEATURES, NUMBER
from gyrodrift.diagnose.inference.evidence import Evidence, Response
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import SimulatedSet

SESSIONS = 4
Amounts = Mapping[str, float]
"""Features by name, in sigmas; all others are 0."""

PARAMETERS = {
    "scale_factor": "error_percent",
    "scale_asymmetry": "error_percent",
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


def response(name: str, per_size: Amounts, sizes: Floats = SIZES, sessions: int = SESSIONS) -> Response:
    """Of a candidate that moves features in proportion to its size."""
    mean = sizes[:, None, None] * rows(per_size, sessions)
    return Response(candidate(name, sizes), mean, np.zeros((len(sizes), len(FEATURES))))


def random_response(name: str, spread_per_size: Amounts, sizes: Floats = SIZES) -> Response:
    """Of a candidate that makes features scatter, and moves none."""
    mean = np.zeros((len(sizes), SESSIONS, len(FEATURES)))
    return Response(candidate(name, sizes, 4), mean, sizes[:, None] * row(spread_per_size))


def evidence(difference: Floats | Amounts, *responses: Response) -> Evidence:
    """With a sigma of 1 everywhere, and nulls that are as large as that."""
    away = rows(difference) if isinstance(difference, Mapping) else difference
    nulls = np.where(np.arange(6)[:, None] % 2 == 0, 1.0, -1.0) * np.ones((len(away), 1, len(FEATURES)))
    names = tuple(f"session-{number}" for number in range(len(away)))
    return Evidence(names, away, np.ones_like(away), np.ones_like(away), nulls, responses)


def exactly(change: Floats) -> SimulatedSet:
    """What a simulator says of a set that does the same in each run."""
    return SimulatedSet(change, np.zeros_like(change), 3)


def added(causes: Sequence[Cause]) -> SimulatedSet:
    """What a simulator would say of a set whose effects simply add up."""
    return exactly(np.sum([cause.response.mean[cause.at] for cause in causes], axis=0))
