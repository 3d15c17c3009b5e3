"""All effects by name, in the order of their stages."""

from typing import Annotated

from pydantic import Field

from firmware_sim.effects.effect import Effect
from firmware_sim.effects.encoder import Backlash, EncoderEccentricity, EncoderQuantization, EncoderSlip
from firmware_sim.effects.environment import TempBias, TempScale, Warmup
from firmware_sim.effects.link import ClockDrift, SampleDrop, TimestampJitter, UsbBatching
from firmware_sim.effects.sensor_bias import (
    BiasInstability,
    GSensitivity,
    Popcorn,
    RateRandomWalk,
    VibrationRectification,
)
from firmware_sim.effects.sensor_curve import (
    Deadband,
    Nonlinearity,
    Quantization,
    Saturation,
    ScaleAsymmetry,
    ScaleFactor,
)
from firmware_sim.effects.sensor_dynamics import Bandwidth, Latency, Vibration
from firmware_sim.effects.sensor_readout import Spikes, StaleHold

AnyEffect = Annotated[
    ScaleFactor
    | ScaleAsymmetry
    | Nonlinearity
    | Deadband
    | Saturation
    | Quantization
    | Bandwidth
    | Latency
    | BiasInstability
    | RateRandomWalk
    | Popcorn
    | Spikes
    | Vibration
    | VibrationRectification
    | GSensitivity
    | TempBias
    | TempScale
    | Warmup
    | EncoderEccentricity
    | EncoderSlip
    | EncoderQuantization
    | Backlash
    | ClockDrift
    | TimestampJitter
    | UsbBatching
    | SampleDrop
    | StaleHold,
    Field(discriminator="name"),
]

_UNION = AnyEffect.__origin__  # type: ignore[attr-defined]  # the union inside Annotated
CATALOGUE: dict[str, type[Effect]] = {kind.model_fields["name"].default: kind for kind in _UNION.__args__}
"""Class by name."""

ORDER = {name: place for place, name in enumerate(CATALOGUE)}
"""Within one place effects act in this order, however a rig file lists them."""
