"""Rig as in its file: gyro, encoder and link."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self, TypeVar, get_args

from pydantic import (
    Field,
    SerializeAsAny,
    SerializerFunctionWrapHandler,
    WrapValidator,
    model_serializer,
    model_validator,
)
from pydantic_core import PydanticCustomError, PydanticKnownError

from firmware_sim.constants import STANDARD_GRAVITY_MPS2
from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.effects.triaxial.catalogue import TRIAXIAL
from firmware_sim.effects.triaxial.effect import TriaxialEffect
from firmware_sim.motion.profile import config_folder
from firmware_sim.named import parse_named
from firmware_sim.yaml_file import Checked, FileError, load

Kind = TypeVar("Kind", bound=Effect)

MPS2_PER_LSB_AT_4_G = 4.0 * STANDARD_GRAVITY_MPS2 / 2**15
"""One count at ±4 g in 16 bits, m/s²: 8192 LSB/g (MPU-6050, 6.2)."""

OwnYaw = Literal["hdr", "restlevel", "attitude"]
OWN_YAWS: tuple[OwnYaw, ...] = get_args(OwnYaw)
"""Filters that a device may run itself; attitude is restlevel on three axes."""

ENCODER_CPR_MAX = 2**31 // 360
"""A count is a 32-bit number on the wire; this allows 360 turns in either direction."""


def _of(catalogue: Mapping[str, type[Kind]], value: Any) -> Kind | Any:
    """Effect from a file, by its name; a pydantic union would not include effects registered later."""
    if not isinstance(value, dict):
        raise PydanticKnownError("model_attributes_type")
    if "name" not in value:
        raise PydanticKnownError("union_tag_not_found", {"discriminator": "'name'"})
    name = value["name"]
    if not isinstance(name, str) or name not in catalogue:
        names = ", ".join(map(repr, catalogue))
        raise PydanticKnownError(
            "union_tag_invalid", {"discriminator": "'name'", "tag": str(name), "expected_tags": names}
        )
    return catalogue[name].model_validate(value)


def _of_the_catalogue(value: Any, _: object) -> Effect:
    return value if isinstance(value, Effect) else _of(CATALOGUE, value)


def _of_triaxial(value: Any, _: object) -> TriaxialEffect:
    return value if isinstance(value, TriaxialEffect) else _of(TRIAXIAL, value)


AnyEffect = Annotated[SerializeAsAny[Effect], WrapValidator(_of_the_catalogue)]
AnyTriaxial = Annotated[SerializeAsAny[TriaxialEffect], WrapValidator(_of_triaxial)]


class ThreeAxes(Checked):
    """Ideal gyro of three axes with an accelerometer, and its effects on vectors.

    `base` states scale, noise and sample rate for each gyro axis, and the bias about z. Other effects of the rig act on
    each gyro axis by itself.

    gyro_bias_x_dps, gyro_bias_y_dps
        Constant offsets of the rates about x and y, deg/s.
    mps2_per_lsb
        One count of the 16-bit acceleration, m/s²; 0 for a device without accelerometer.
    accel_noise_mps2_rthz
        White noise of each axis, m/s²/√Hz, two-sided like that of the rate.
    gravity_mps2
        Local gravity, m/s².
    effects
        Effects on vectors; one may be listed several times.
    """

    gyro_bias_x_dps: Annotated[float, Field(ge=-50.0, le=50.0)] = 0.0
    gyro_bias_y_dps: Annotated[float, Field(ge=-50.0, le=50.0)] = 0.0
    mps2_per_lsb: Annotated[float, Field(ge=0.0, le=1.0)] = MPS2_PER_LSB_AT_4_G
    accel_noise_mps2_rthz: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0028
    gravity_mps2: Annotated[float, Field(ge=0.0, le=30.0)] = STANDARD_GRAVITY_MPS2
    effects: Annotated[tuple[AnyTriaxial, ...], Field(strict=False)] = ()


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
    three_axes
        Gyro of three axes and accelerometer; None for a device that sends the yaw rate alone.
    own_yaw
        Filter that the device runs itself on its counts, and whose yaw it sends with each sample; None for none.
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
    three_axes: ThreeAxes | None = None
    own_yaw: OwnYaw | None = None

    @model_validator(mode="after")
    def _has_axes_for_its_filter(self) -> Self:
        if self.own_yaw == "attitude" and self.three_axes is None:
            raise PydanticCustomError("own_yaw", "own_yaw: attitude needs three axes; add three_axes, or use restlevel")
        return self

    @model_serializer(mode="wrap")
    def _without_axes(self, as_usual: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Fields of a device without axes or filter stay what they were, to the byte."""
        fields: dict[str, Any] = as_usual(self)
        for name in ("three_axes", "own_yaw"):
            if getattr(self, name) is None:
                fields.pop(name, None)
        return fields


AidName = Literal["heading", "turn_rate", "wheels", "speed", "standing"]
AIDS: tuple[AidName, ...] = get_args(AidName)


class SimulatedAid(Checked):
    """Second source beside the gyro, and its flaws.

    name
        heading, turn_rate, wheels, speed or standing.
    every_s, late_s
        Time between two measurements, and from a measurement to its arrival, s.
    sigma, resolution
        Standard deviation and rounding, in the unit of the value: deg, deg/s or m/s.
    threshold
        Size below which it reads 0.
    sign, scale_percent
        −1 if it is reversed, and the error of its scale, %.
    offset_deg, period_deg
        Of a heading: its zero, and 360, or 90 for walls.
    wrong_share, slip_share, gone_share
        Shares of wrong measurements, and of stretches of time in which turns read too much, or nothing comes.
    stuck_s
        Time from which on it repeats its value, s; 0 for never.
    speed_mps, track_m
        Speed whenever the device does not rest, and distance of the wheels.
    """

    name: AidName
    every_s: Annotated[float, Field(ge=0.001, le=3600.0)] = 1.0
    late_s: Annotated[float, Field(ge=0.0, le=10.0)] = 0.0
    sigma: Annotated[float, Field(ge=0.0, le=180.0)] = 0.0
    resolution: Annotated[float, Field(ge=0.0, le=90.0)] = 0.0
    threshold: Annotated[float, Field(ge=0.0, le=100.0)] = 0.0
    sign: Literal[-1, 1] = 1
    scale_percent: Annotated[float, Field(ge=-50.0, le=50.0)] = 0.0
    offset_deg: Annotated[float, Field(ge=-360.0, le=360.0)] = 0.0
    period_deg: Annotated[float, Field(gt=0.0, le=360.0)] = 360.0
    wrong_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    slip_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    gone_share: Annotated[float, Field(ge=0.0, le=1.0)] = 0.0
    stuck_s: Annotated[float, Field(ge=0.0)] = 0.0
    speed_mps: Annotated[float, Field(ge=0.0, le=100.0)] = 0.5
    track_m: Annotated[float, Field(gt=0.0, le=10.0)] = 0.3


class Rig(Checked):
    """Rig: the ideal device, its effects and second sources; an effect may be listed several times."""

    base: Base = Base()
    effects: Annotated[tuple[AnyEffect, ...], Field(strict=False)] = ()
    aids: Annotated[tuple[SimulatedAid, ...], Field(strict=False)] = ()

    @model_serializer(mode="wrap")
    def _without_aids(self, as_usual: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Fields of a rig without second sources stay what they were, to the byte."""
        fields: dict[str, Any] = as_usual(self)
        if not self.aids:
            del fields["aids"]
        return fields


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
    return parse_named("effect", text, {**CATALOGUE, **TRIAXIAL}, lambda kind: kind.typical)


def parse_aid(text: str) -> SimulatedAid:
    """Second source from a command line: `heading`, or `heading:every_s=60,late_s=0.5`.

    Raises
    ------
    FileError
        The source or a parameter is unknown, or a value is invalid.
    """
    return parse_named("aid", text, dict.fromkeys(AIDS, SimulatedAid), lambda _kind: {})


def with_aids(rig: Rig, aids: Sequence[SimulatedAid]) -> Rig:
    """Rig with additional second sources."""
    return rig.model_copy(update={"aids": (*rig.aids, *aids)})


def with_effects(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """Rig with additional effects.

    Raises
    ------
    FileError
        An effect needs three axes, and the rig has one.
    """
    triaxial = [effect for effect in effects if isinstance(effect, TriaxialEffect)]
    if triaxial:
        rig = _with_triaxial(rig, triaxial)
    scalar = [effect for effect in effects if not isinstance(effect, TriaxialEffect)]
    return rig.model_copy(update={"effects": (*rig.effects, *scalar)})


def _with_triaxial(rig: Rig, effects: Sequence[TriaxialEffect]) -> Rig:
    axes = rig.base.three_axes
    if axes is None:
        raise FileError(f"--effect {effects[0].name}: needs a rig with three axes; add --axes 3")
    return _with_axes_block(rig, axes.model_copy(update={"effects": (*axes.effects, *effects)}))


def with_axes(rig: Rig, axes: int | None) -> Rig:
    """Rig with 1 or 3 axes; None leaves it as it is. A block `three_axes` of the rig stays."""
    if axes == 1:
        return _with_axes_block(rig, None)
    return _with_axes_block(rig, ThreeAxes()) if axes and rig.base.three_axes is None else rig


def with_own_yaw(rig: Rig, own_yaw: str | None) -> Rig:
    """Rig whose device runs this filter; None leaves it as it is.

    Raises
    ------
    FileError
        The filter needs three axes, and the rig has one.
    """
    if own_yaw is None:
        return rig
    if own_yaw == "attitude" and rig.base.three_axes is None:
        raise FileError("--own-yaw attitude: needs a rig with three axes; add --axes 3, or use --own-yaw restlevel")
    return rig.model_copy(update={"base": rig.base.model_copy(update={"own_yaw": own_yaw})})


def _with_axes_block(rig: Rig, axes: ThreeAxes | None) -> Rig:
    return rig.model_copy(update={"base": rig.base.model_copy(update={"three_axes": axes})})


def with_replaced(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """Rig with effects that replace those of the same names, after all others."""
    names = {effect.name for effect in effects}
    kept = tuple(effect for effect in rig.effects if effect.name not in names)
    return rig.model_copy(update={"effects": (*kept, *effects)})
