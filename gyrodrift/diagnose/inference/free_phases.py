"""Phases of what comes once per turn, where an encoder is zeroed wherever it stands: another one in each session."""

import numpy as np

from gyrodrift.arrays import Floats

PHASES_DEG = np.arange(-180.0, 180.0, 2.0)


def free_phases_deg(wanted: Floats, quadratures: tuple[Floats, Floats], shares: Floats) -> Floats:
    """(sessions,) phases at which sines of one amplitude leave the least of all sessions together, by least squares.

    The amplitude is common, since a session that hardly turns would take any.

    wanted
        (sessions, F) what there is to explain, in standard deviations of chance.
    quadratures
        (sessions, F) each: changes at phases of 0 and 90 degrees, likewise.
    shares
        (sizes,) multiples of these changes that are possible.
    """
    at_0, at_90 = quadratures
    phase = np.deg2rad(PHASES_DEG)[:, None]
    cosine, sine = np.cos(phase), np.sin(phase)
    along = cosine * _product(wanted, at_0) + sine * _product(wanted, at_90)
    both = 2.0 * sine * cosine * _product(at_0, at_90)
    power = np.square(cosine) * _product(at_0, at_0) + np.square(sine) * _product(at_90, at_90) + both
    sizes = shares[:, None, None]
    left = np.square(sizes) * power - 2.0 * sizes * along  # sizes, phases, sessions
    best = int(left.min(axis=1).sum(axis=-1).argmin())
    phases: Floats = PHASES_DEG[left[best].argmin(axis=0)]
    return phases


def _product(one: Floats, other: Floats) -> Floats:
    """(sessions,) scalar products."""
    found: Floats = (one * other).sum(axis=-1)
    return found
