"""Candidates of both signs by hand: simulated at two sizes and scaled, as what is linear in its size."""

from dataclasses import replace

import numpy as np
from inference_support import Amounts, Simulated, simulated

SIZES = np.arange(0.5, 8.01, 0.25)


def simulated_either_way(name: str, per_size: Amounts) -> Simulated:
    """A candidate that moves features in proportion to its size, from -8 to 8."""
    made = simulated(name, per_size, np.array([-8.0, 8.0]))
    sizes = np.concatenate([-SIZES[::-1], SIZES])
    return made._replace(candidate=replace(made.candidate, sizes=sizes))
