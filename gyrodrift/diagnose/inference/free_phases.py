"""Phases of once-per-turn effects in sessions with an encoder zeroed at power-on: free in each session."""

import numpy as np

from gyrodrift.arrays import Floats

PHASES_DEG = np.arange(-180.0, 180.0, 2.0)


def free_phases_deg(unexplained: Floats, quadratures: tuple[Floats, Floats], shares: Floats) -> Floats:
    """(sessions,) phases of sines with a common amplitude that fit all sessions best, by least squares.

    The amplitude is common, because a session that hardly turns would accept any amplitude.

    unexplained
        (sessions, F) differences to explain, in standard deviations of chance.
    quadratures
        (sessions, F) each: changes at phases of 0 and 90 degrees, likewise.
    shares
        (sizes,) multiples of these changes that are possible.
    """
    at_0, at_90 = quadratures
    phase = np.deg2rad(PHASES_DEG)[:, None]
    cosine, sine = np.cos(phase), np.sin(phase)
    along = cosine * _product(unexplained, at_0) + sine * _product(unexplained, at_90)
    cross = 2.0 * sine * cosine * _product(at_0, at_90)
    power = np.square(cosine) * _product(at_0, at_0) + np.square(sine) * _product(at_90, at_90) + cross
    sizes = shares[:, None, None]
    cost = np.square(sizes) * power - 2.0 * sizes * along  # sizes, phases, sessions
    best = int(cost.min(axis=1).sum(axis=-1).argmin())
    phases: Floats = PHASES_DEG[cost[best].argmin(axis=0)]
    return phases


def _product(first: Floats, second: Floats) -> Floats:
    """(sessions,) scalar products."""
    product: Floats = (first * second).sum(axis=-1)
    return product
