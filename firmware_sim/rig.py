"""The rig as its file says it: what gyro, what encoder, what link; a value, like the profile it plays."""

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

ENCODER_CPR_MOST = 2**31 // 360
"""A count is a 32-bit number on the wire; this leaves room for 360 turns either way."""


class Base(Checked):
    """The ideal device.

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
        Whether the encoder's zero stays where it is between power-ons. An incremental one is zeroed wherever it stands
        at power-on, so that what happens once per turn has another phase in each session. It is for those who compare
        sessions; a simulated angle does not depend on it.
    encoder_phase_deg
        True angle at which the motion begins, degrees: counts begin there, and so does all that happens once per turn.
    host_delay_s
        From the moment of a measurement to its bytes on the link, s.
    host_jitter_s
        Mean of what the host's scheduler adds to that, s: exponential and independent from sample to sample, but no
        sample overtakes the one before it.
    """

    sample_rate_hz: Annotated[float, Field(ge=1.0, le=65535.0)] = 100.0
    dps_per_lsb: Annotated[float, Field(gt=0.0, le=10.0)] = 0.00763
    noise_dps_rthz: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0035
    bias_dps: Annotated[float, Field(ge=-50.0, le=50.0)] = 0.0
    encoder_cpr: Annotated[int, Field(ge=0, le=ENCODER_CPR_MOST)] = 36000
    encoder_absolute: bool = False
    encoder_phase_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    host_delay_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.002
    host_jitter_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0


def _of_the_catalogue(value: Any, _: object) -> Effect:
    """What a file says of an effect, as the effect of that name; pydantic's own union would not see later ones."""
    if isinstance(value, Effect):
        return value
    if not isinstance(value, dict):
        raise PydanticKnownError("model_attributes_type")
    if "name" not in value:
        raise PydanticKnownError("union_tag_not_found", {"discriminator": "'name'"})
    name = value["name"]
    if not isinstance(name, str) or name not in CATALOGUE:
        known = ", ".join(map(repr, CATALOGUE))
        raise PydanticKnownError(
            "union_tag_invalid", {"discriminator": "'name'", "tag": str(name), "expected_tags": known}
        )
    return CATALOGUE[name].model_validate(value)


AnyEffect = Annotated[SerializeAsAny[Effect], WrapValidator(_of_the_catalogue)]


class Rig(Checked):
    """A whole rig; `effects` is what it has beyond the ideal, and one of them may stand there more than once."""

    base: Base = Base()
    effects: Annotated[tuple[AnyEffect, ...], Field(strict=False)] = ()


def load_rig(path: Path | None) -> Rig:
    """The rig of a file, or the shipped one.

    Raises
    ------
    FileError
        With every mistake in the file.
    """
    return load(path or config_folder() / "rig.yaml", Rig)


def parse_effect(text: str) -> Effect:
    """An effect as a command line says it: `name` for its typical size, or `name:parameter=value,...`.

    Raises
    ------
    FileError
        Where there is no such effect or parameter, or a value is none or out of range.
    """
    return parse_named("effect", text, CATALOGUE, lambda kind: kind.typical)


def with_effects(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """The rig with more effects."""
    return rig.model_copy(update={"effects": (*rig.effects, *effects)})


def with_replaced(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """The rig with effects in the place of those of the same names, behind all others."""
    names = {effect.name for effect in effects}
    kept = tuple(effect for effect in rig.effects if effect.name not in names)
    return rig.model_copy(update={"effects": (*kept, *effects)})
