"""Rig as in its file: gyro, encoder and link."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import Field, SerializeAsAny, WrapValidator
from pydantic_core import PydanticKnownError

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.motion.profile import config_folder
from firmware_sim.named import parse_named
from firmware_sim.yaml_file import Checked, load

ENCODER_CPR_MAX = 2**31 // 360
"""A count is a 32-bit number on the wire; this allows 360 turns in either direction."""


class Base(Checked):
    """Ideal device.

    sample_rate_hz
        Samples per second of the device clock, Hz.
    dps_per_lsb
        One count of the 16-bit rate, deg/s.
    noise_dps_rthz
        White noise of the rate, deg/s/√Hz, as angle random walk is stated (IEEE Std 952): the Allan deviation is
        noise/√τ, the standard deviation of a sample noise·√sample_rate.
    bias_dps
        Constant offset of the rate, deg/s.
    encoder_cpr
        Counts of the encoder per turn; 0 for a rig without one.
    encoder_absolute
        Whether the zero of the encoder is the same after every power-on. An incremental encoder starts at zero at any
        angle, so that once-per-turn effects have a free phase in every session. Analyses use it; the simulated angle
        does not depend on it.
    encoder_phase_deg
        True angle at the beginning of the motion, degrees, for encoder counts and once-per-turn effects.
    host_delay_s
        Delay from a measurement to its bytes on the link, s.
    host_jitter_s
        Mean additional delay by the scheduler of the host, s: exponential and independent, but samples stay in order.
    """

    sample_rate_hz: Annotated[float, Field(ge=1.0, le=65535.0)] = 100.0
    dps_per_lsb: Annotated[float, Field(gt=0.0, le=10.0)] = 0.00763
    noise_dps_rthz: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0035
    bias_dps: Annotated[float, Field(ge=-50.0, le=50.0)] = 0.0
    encoder_cpr: Annotated[int, Field(ge=0, le=ENCODER_CPR_MAX)] = 36000
    encoder_absolute: bool = False
    encoder_phase_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    host_delay_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.002
    host_jitter_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0


def _of_the_catalogue(value: Any, _: object) -> Effect:
    """Effect from a file, by its name; a pydantic union would not include effects registered later."""
    if isinstance(value, Effect):
        return value
    if not isinstance(value, dict):
        raise PydanticKnownError("model_attributes_type")
    if "name" not in value:
        raise PydanticKnownError("union_tag_not_found", {"discriminator": "'name'"})
    name = value["name"]
    if not isinstance(name, str) or name not in CATALOGUE:
        names = ", ".join(map(repr, CATALOGUE))
        raise PydanticKnownError(
            "union_tag_invalid", {"discriminator": "'name'", "tag": str(name), "expected_tags": names}
        )
    return CATALOGUE[name].model_validate(value)


AnyEffect = Annotated[SerializeAsAny[Effect], WrapValidator(_of_the_catalogue)]


class Rig(Checked):
    """Rig: the ideal device and its effects; an effect may be listed several times."""

    base: Base = Base()
    effects: Annotated[tuple[AnyEffect, ...], Field(strict=False)] = ()


def load_rig(path: Path | None) -> Rig:
    """Rig of a file, or the shipped one.

    Raises
    ------
    FileError
        The file has mistakes; the message lists all of them.
    """
    return load(path or config_folder() / "rig.yaml", Rig)


def parse_effect(text: str) -> Effect:
    """Effect from a command line: `name` for its typical size, or `name:parameter=value,...`.

    Raises
    ------
    FileError
        The effect or a parameter is unknown, or a value is invalid.
    """
    return parse_named("effect", text, CATALOGUE, lambda kind: kind.typical)


def with_effects(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """Rig with additional effects."""
    return rig.model_copy(update={"effects": (*rig.effects, *effects)})


def with_replaced(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """Rig with effects that replace those of the same names, after all others."""
    names = {effect.name for effect in effects}
    kept = tuple(effect for effect in rig.effects if effect.name not in names)
    return rig.model_copy(update={"effects": (*kept, *effects)})
