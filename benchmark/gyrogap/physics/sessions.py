"""Sessions of a case: length, cold or warm start, heating, and temperature of the sensor."""

from dataclasses import asdict, dataclass, replace

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.motion import Floats

WHOLE_S = 300.0
"""A session of this length has the whole motion."""


@dataclass(frozen=True, slots=True)
class SessionPlan:
    """One session.

    powered_s
        How long the device has been on when it begins, s: up to 2 for a cold start, 900 to 2000 for a warm one.
    ambient_c, wander_c, self_heating_c, warm_s
        Temperature of the air and its swing, °C; self-heating of the device, °C, and its time constant, s.
    heated_c, heat_from_s, heat_s
        By how much the air is heated and cooled again, when that begins, and how long either takes; 0 where it is not.
    start_deg
        Where the table stands when it begins, true angle.
    still_factor
        How long the stills at both ends are, against those of a session of five minutes.
    """

    seconds: float
    powered_s: float
    ambient_c: float
    wander_c: float
    self_heating_c: float
    warm_s: float
    heated_c: float = 0.0
    heat_from_s: float = 0.0
    heat_s: float = 60.0
    start_deg: float = 0.0
    still_factor: float = 1.0

    def facts(self) -> dict[str, float]:
        """For the label."""
        return {name: round(value, 3) for name, value in asdict(self).items()}

    def sensor_c(self, t_s: Floats) -> Floats:
        """Temperature of the sensor at times since the beginning, °C, of their shape."""
        warmed = 1.0 - np.exp(-(t_s + self.powered_s) / self.warm_s)
        ambient_c = self.ambient_c + self.wander_c * np.sin(2.0 * np.pi * t_s / 700.0 + self.ambient_c)
        up = _half_cosine((t_s - self.heat_from_s) / self.heat_s)
        down = _half_cosine((t_s - self.heat_from_s - 1.6 * self.heat_s) / self.heat_s)
        temp_c: Floats = ambient_c + self.self_heating_c * warmed + self.heated_c * (up - 0.8 * down)
        return temp_c


def _half_cosine(share: Floats) -> Floats:
    rise: Floats = 0.5 - 0.5 * np.cos(np.pi * np.clip(share, 0.0, 1.0))
    return rise


def plan_sessions(rng: Rng, count: int, minutes: tuple[float, float]) -> list[SessionPlan]:
    """One of them starts warm, another one is heated and cooled, the rest are cold starts in a steady room."""
    ambient_c, self_heating_c, warm_s = rng.uniform(18.0, 26.0), rng.uniform(2.0, 6.0), rng.uniform(120.0, 280.0)
    plans = [
        SessionPlan(
            seconds=60.0 * rng.uniform(*minutes),
            powered_s=rng.uniform(0.0, 2.0),
            ambient_c=ambient_c + rng.uniform(-1.5, 1.5),
            wander_c=rng.uniform(0.05, 0.4),
            self_heating_c=self_heating_c,
            warm_s=warm_s,
        )
        for _ in range(count)
    ]
    warm, heated = rng.permutation(count)[:2]
    plans[warm] = replace(plans[warm], powered_s=rng.uniform(900.0, 2000.0))
    plans[heated] = replace(
        plans[heated],
        heated_c=rng.uniform(8.0, 15.0),
        heat_from_s=rng.uniform(40.0, 100.0),
        heat_s=rng.uniform(70.0, 100.0),
    )
    return plans


def place_sessions(rng: Rng, plans: list[SessionPlan]) -> list[SessionPlan]:
    """Sessions that begin at any angle of the table; short ones have short stills."""
    return [
        replace(plan, start_deg=rng.uniform(0.0, 360.0), still_factor=min(1.0, plan.seconds / WHOLE_S))
        for plan in plans
    ]
