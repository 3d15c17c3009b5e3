"""All effects on vectors by name, in the order in which they act within a slot."""

from collections.abc import Mapping
from types import MappingProxyType

from firmware_sim.effects.triaxial import accelerometer, matrices, vibration
from firmware_sim.effects.triaxial.effect import TriaxialEffect

_KINDS: tuple[type[TriaxialEffect], ...] = (
    vibration.MotorVibration,
    matrices.GyroGSensitivity,
    matrices.GyroMisalignment,
    matrices.GyroCrossAxis,
    matrices.GyroScale,
    matrices.AccelMisalignment,
    matrices.AccelCrossAxis,
    matrices.AccelScale,
    accelerometer.AccelBias,
    accelerometer.AccelWalk,
    accelerometer.AccelRange,
    accelerometer.AccelSteps,
    accelerometer.AccelDropout,
)

TRIAXIAL: Mapping[str, type[TriaxialEffect]] = MappingProxyType(
    {str(kind.model_fields["name"].default): kind for kind in _KINDS}
)
"""Class by name."""


def in_triaxial_order(effects: tuple[TriaxialEffect, ...]) -> list[TriaxialEffect]:
    """Effects in the order of the catalogue; several of a kind keep their order."""
    order = {name: number for number, name in enumerate(TRIAXIAL)}
    return sorted(effects, key=lambda effect: order[effect.name])
