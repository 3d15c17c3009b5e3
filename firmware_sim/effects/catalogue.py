"""All effects by name. An entry here makes an effect known to rig files, command lines and the gallery.

The order matters: within a slot, effects act in the order of this list, not in the order of the rig file.
"""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import TypeVar

from firmware_sim.effects import encoder, environment, link
from firmware_sim.effects import sensor_bias as bias
from firmware_sim.effects import sensor_curve as curve
from firmware_sim.effects import sensor_dynamics as dynamics
from firmware_sim.effects import sensor_mount as mount
from firmware_sim.effects import sensor_readout as readout
from firmware_sim.effects.effect import Effect

Kind = TypeVar("Kind", bound=Effect)

_KINDS: dict[str, type[Effect]] = {}

CATALOGUE: Mapping[str, type[Effect]] = MappingProxyType(_KINDS)
"""Class by name; a view that includes effects registered later."""


def register(kind: type[Kind]) -> type[Kind]:
    """Add an effect after all others; also a decorator for classes outside this package.

    Raises
    ------
    ValueError
        The name is taken.
    """
    name = name_of(kind)
    if name in _KINDS:
        raise ValueError(f"{kind.__name__}: there is an effect {name!r} already, {_KINDS[name].__name__}")
    _KINDS[name] = kind
    return kind


def unregister(name: str) -> None:
    """Remove an effect, for tests."""
    del _KINDS[name]


def name_of(kind: type[Effect]) -> str:
    """Name in a rig file."""
    return str(kind.model_fields["name"].default)


def in_acting_order(effects: Sequence[Effect]) -> list[Effect]:
    """Effects in the order of the catalogue; several of a kind keep their order."""
    order = {name: number for number, name in enumerate(_KINDS)}
    return sorted(effects, key=lambda effect: order[effect.name])


for _kind in (
    curve.ScaleFactor,
    mount.Misalignment,
    curve.ScaleAsymmetry,
    curve.Nonlinearity,
    curve.Deadband,
    curve.Saturation,
    curve.Quantization,
    dynamics.Bandwidth,
    dynamics.Latency,
    bias.BiasInstability,
    bias.RateRandomWalk,
    bias.Popcorn,
    readout.Spikes,
    dynamics.Vibration,
    bias.VibrationRectification,
    bias.GSensitivity,
    environment.TempBias,
    environment.TempScale,
    environment.Warmup,
    encoder.EncoderEccentricity,
    encoder.EncoderSlip,
    encoder.EncoderQuantization,
    encoder.Backlash,
    link.ClockDrift,
    link.TimestampJitter,
    link.UsbBatching,
    link.SampleDrop,
    readout.StaleHold,
):
    register(_kind)
