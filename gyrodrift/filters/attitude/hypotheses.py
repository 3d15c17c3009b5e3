"""The Gaussian sum: a Gaussian over attitude, bias, velocity, scale and misalignment for each sequence of regimes."""

from dataclasses import dataclass, fields, replace

import numpy as np

from gyrodrift.filters.attitude.batch import from_rotation_vectors, products, unit
from gyrodrift.values.arrays import Floats, Integers, Mask

ATTITUDE, BIAS, VELOCITY, SCALE, FORCE_BIAS = slice(0, 3), slice(3, 6), slice(6, 9), slice(9, 18), slice(18, 21)
STATES = 21
HEADING = 2
"""Error states, by definition: rotation in the earth frame, rad; bias, rad/s; velocity in the earth frame, m/s; scale
and misalignment of the gyro, row by row; bias of the accelerometer, m/s²."""

UNDECIDED, REST, TURN = 0, 1, 2
"""Regimes of a hypothesis in the present segment. By definition."""


@dataclass(slots=True)
class Hypotheses:
    """Hypotheses in arrays; the first dimension n counts them.

    weight
        Probabilities (n).
    q, bias, velocity, scale, force_bias
        Means: (n, 4), (n, 3) in rad/s, (n, 3) in m/s, (n, 3, 3), (n, 3) in m/s².
    cov
        Covariances (n, 21, 21) of the error states.
    yaw_deg
        Unwrapped headings (n).
    regime
        UNDECIDED, REST or TURN (n).
    knows_bias
        A rest of 1 s or more was measured (n).
    moving_s
        Time since the last measured rest, s (n).
    """

    weight: Floats
    q: Floats
    bias: Floats
    velocity: Floats
    scale: Floats
    force_bias: Floats
    cov: Floats
    yaw_deg: Floats
    regime: Integers
    knows_bias: Mask
    moving_s: Floats

    def select(self, index: Integers | Mask | list[int]) -> "Hypotheses":
        """Copies of some hypotheses."""
        return replace(self, **{f.name: getattr(self, f.name)[index] for f in fields(self)})

    def joined(self, added: "Hypotheses") -> "Hypotheses":
        """These hypotheses, followed by the added ones."""
        names = [f.name for f in fields(self)]
        return replace(self, **{name: np.concatenate((getattr(self, name), getattr(added, name))) for name in names})

    def correct(self, error: Floats) -> None:
        """Add error states (n, 21) to the means."""
        self.q = unit(products(from_rotation_vectors(error[:, ATTITUDE]), self.q))
        self.bias = self.bias + error[:, BIAS]
        self.velocity = self.velocity + error[:, VELOCITY]
        self.scale = self.scale + error[:, SCALE].reshape(-1, 3, 3)
        self.force_bias = self.force_bias + error[:, FORCE_BIAS]
        self.yaw_deg = self.yaw_deg + np.degrees(error[:, HEADING])


def first_hypothesis() -> Hypotheses:
    """A single hypothesis without uncertainty, level and at rest."""
    return Hypotheses(
        weight=np.ones(1),
        q=np.array([[1.0, 0.0, 0.0, 0.0]]),
        bias=np.zeros((1, 3)),
        velocity=np.zeros((1, 3)),
        scale=np.zeros((1, 3, 3)),
        force_bias=np.zeros((1, 3)),
        cov=np.zeros((1, STATES, STATES)),
        yaw_deg=np.zeros(1),
        regime=np.zeros(1, dtype=np.int64),
        knows_bias=np.zeros(1, dtype=np.bool_),
        moving_s=np.zeros(1),
    )
