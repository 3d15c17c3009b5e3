"""A device with its rig and the plans of its sessions, drawn together."""

from collections.abc import Sequence
from dataclasses import asdict, replace
from typing import Any

from gyrogap.physics.device import DrawnDevice, RigFile
from gyrogap.physics.dice import Path, Rng
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.sessions import SessionPlan, place_sessions, plan_sessions
from gyrogap.physics.spread import RATES_HZ, DeviceFacts, draw_facts, draw_spread
from gyrogap.physics.three_axes import draw_three_axes
from gyrogap.physics.write import SessionBatch

SESSIONS = 3
MINUTES = (1.5, 3.0)


class Stand:
    """A device as people own it, and sessions of one and a half to three minutes."""

    def __init__(
        self,
        rng: Rng,
        minutes: tuple[float, float] = MINUTES,
        sessions: int = SESSIONS,
        *,
        has_three_axes: bool = False,
        rates_hz: Sequence[int] = RATES_HZ,
    ) -> None:
        self.facts: DeviceFacts = draw_facts(rng, rates_hz)
        self.plans: tuple[SessionPlan, ...] = draw_plans(rng, minutes, sessions)
        self.device: DrawnDevice
        self.rig: RigFile
        self.device, self.rig = draw_spread(rng, self.facts, sessions)
        if has_three_axes:
            self.device = replace(self.device, three_axes=draw_three_axes(rng, sessions))

    @property
    def rig_text(self) -> str:
        """The rig file."""
        return self.rig.text(self.device)

    @property
    def about(self) -> str:
        """A short description for lists."""
        low_pass = f", low-pass {self.device.low_pass_hz:g} Hz" if self.device.low_pass_hz else ""
        return describe(self.facts) + low_pass

    @property
    def label(self) -> dict[str, Any]:
        """Content for the label of a case."""
        return {
            "facts": asdict(self.facts),
            "device": self.device.facts(),
            "sessions": [plan.facts() for plan in self.plans],
        }

    def batch(self, faults: tuple[InjectedEffect, ...], path: Path) -> SessionBatch:
        """Its sessions."""
        return SessionBatch(self.device, self.plans, faults, path)


def draw_plans(rng: Rng, minutes: tuple[float, float], sessions: int) -> tuple[SessionPlan, ...]:
    """Sessions that begin at any angle of the table."""
    return tuple(place_sessions(rng, plan_sessions(rng, sessions, minutes)))


def describe(facts: DeviceFacts) -> str:
    """Counts, rate, noise and step in a line."""
    return (
        f"{facts.encoder_cpr} counts{' absolute' if facts.encoder_absolute else ''}, {facts.sample_hz} Hz, "
        f"noise {facts.noise_dps_rthz:g}, step {facts.dps_per_lsb:g}"
    )
