"""Input of the inference: the deviation of each feature, and the response of the features to each candidate."""

from dataclasses import dataclass, field

import numpy as np
from scipy.optimize import brentq
from scipy.special import stdtr

from gyrodrift.diagnose.features.vector import OF_AXES
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.values.arrays import Floats, Mask

FAMILY_WISE_ERROR = 0.02
"""Probability that any feature deviates by chance. Chosen: the search over causes and the inexact null use the rest of
the 5 % of false alarms."""

LEAST, MOST = 4.3, 1e6
"""Bounds of the threshold. If chance is small compared with the relevance thresholds, errors of the null decide.
Measured: of 218 random rigs diagnosed against themselves, 8 exceeded 3.5 and 3 exceeded 4.3. Of 171 devices with an
effect outside the catalog, 1 lay in between. Chosen: MOST, beyond every z."""

SEED = 0
"""Seed of the composed sets of null runs, and of the bootstrap of the gap. Chosen: any, so that results repeat."""


def pooled_z(z: Floats) -> Floats:
    """(F,) z over all sessions, from (S, F) z of single sessions.

    It is the larger of two deviates: that of a shift common to the sessions, and that of a scatter larger than chance.
    """
    count = len(z)
    shift = z.mean(axis=0) * np.sqrt(count)
    scatter = np.linalg.norm(z, axis=0) - np.sqrt(count)
    pooled: Floats = np.where(scatter > np.abs(shift), scatter * np.where(shift < 0.0, -1.0, 1.0), shift)
    return pooled


def family_wise_threshold(nulls: Floats) -> float:
    """Threshold of a pooled z.

    nulls
        (sessions, runs, F) differences without a gap, in units of sigma.
    """
    sessions, runs, features = nulls.shape
    degrees = sessions * runs - 1
    if degrees < 1:
        return float("inf")
    # A mean over sessions scatters about the center of these runs, which has a scatter of its own.
    spread = np.sqrt(np.square(nulls).reshape(-1, features).sum(axis=0) / degrees * (1.0 + 1.0 / runs))
    spread = spread[spread > 0.0]
    if not len(spread):
        return float("inf")
    by_student = float(brentq(lambda z: _expected(z, spread, degrees) + np.log1p(-FAMILY_WISE_ERROR), 0.0, MOST))
    return max(LEAST, by_student, float(np.quantile(_largest(nulls), 1.0 - FAMILY_WISE_ERROR)))


def _expected(z: float, spread: Floats, degrees: int) -> float:
    """Expected number of features with these spreads beyond a z."""
    return float(2.0 * stdtr(degrees, -z / spread).sum())


def _largest(nulls: Floats) -> Floats:
    """(sets,) largest pooled z of one run of each session, about the center of the other runs.

    Sigma was estimated from the same runs, which makes them smaller; `own` corrects that.
    """
    sessions, runs, _ = nulls.shape
    chosen = np.random.default_rng(SEED).integers(runs, size=(400, sessions))
    own = np.sqrt((sessions * runs + 1.0) / (sessions * runs - 1.0))
    drawn = nulls[np.arange(sessions), chosen]
    if runs > 1:
        drawn = drawn + drawn.mean(axis=1, keepdims=True) / (runs - 1.0)
    largest: Floats = own * np.array([np.abs(pooled_z(sample)).max() for sample in drawn])
    return largest


NOT_COMPARED = 1e6
"""Standard deviation of features that are not compared, in units of the features. Chosen: far above the scatter of
every feature."""


@dataclass(frozen=True, slots=True, eq=False)
class Response:
    """Response of the features to a variant of a candidate.

    mean
        (sizes, S, F) change of the features; of a random candidate at its simulated sizes only.
    phases_deg
        (S,) phase that each session shows, of a candidate with a free phase; None of all others.
    realized
        (simulated sizes, S, realizations, F) changes of a random candidate; None of all others.
    interpolation_sigma
        (sizes, S, F) standard deviation of the mean by interpolation between simulated sizes, or 0.
    """

    candidate: Candidate
    mean: Floats
    phases_deg: Floats | None = None
    realized: Floats | None = None
    interpolation_sigma: Floats | float = 0.0


@dataclass(frozen=True, slots=True, eq=False)
class Evidence:
    """Sessions as rows, F features as columns.

    names
        Names of the sessions.
    difference
        (S, F) recording minus simulation, minus the mean of the null.
    sigma
        (S, F) standard deviation without a gap, relevance threshold included.
    nulls
        (S, runs, F) differences without a gap, in units of sigma.
    sigma_factor
        (F,) factor that widens sigma if sigma comes from a few recordings; it applies to single features only.
    device_variance
        (S, F) variance of the device from recording to recording, in units of sigma; 0 without a baseline.
    threshold_z
        Pooled z beyond which a feature deviates. Any feature exceeds it by chance with FAMILY_WISE_ERROR.
    """

    names: tuple[str, ...]
    difference: Floats
    sigma: Floats
    nulls: Floats
    responses: tuple[Response, ...]
    sigma_factor: Floats | float = 1.0
    device_variance: Floats | float = 0.0
    threshold_z: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "threshold_z", family_wise_threshold(self.nulls))

    @property
    def z(self) -> Floats:
        """(S, F) deviation of each feature from the rig, in sigma."""
        return self.difference / self.sigma

    @property
    def is_compared(self) -> Mask:
        """(S, F) features that a session determines."""
        compared: Mask = self.sigma < NOT_COMPARED
        return compared

    @property
    def is_present(self) -> Mask:
        """(F,) whether a feature is present; features of three axes are present only if a session compares them."""
        present: Mask = ~OF_AXES | self.is_compared.any(axis=0)
        return present

    def effects(self) -> list[Response]:
        """Responses of effects of the catalog."""
        return [response for response in self.responses if not response.candidate.is_out_of_catalogue]
