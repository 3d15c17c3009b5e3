"""Effects of a device with three axes: how the turn and gravity reach its axes.

On the table only the turn about z and gravity along z are large. So the effects are those that send a share of them to
other axes.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

import numpy as np

from gyrogap.physics.dice import Rng
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.motion import Floats
from gyrogap.physics.sizes import SIZES, EffectSizes, varied

ON_EVERY_AXIS = frozenset({"latency", "bandwidth", "one_pole", "deadband", "saturation", "quantization", "stale_hold"})
"""Effects of the electronics that all axes of a part share; all other effects on rates act on z."""


@dataclass(frozen=True, slots=True)
class AxisMount:
    """How a device feels the table.

    turn
        Share of the turn that each axis of the gyro reads, shape (3,).
    force
        Matrix from the force in the frame of the table to that of the accelerometer, shape (3, 3).
    offset_mps2
        Offset of the accelerometer, shape (3,).
    """

    turn: Floats
    force: Floats
    offset_mps2: Floats


def misalignment(mount: AxisMount, *, tilt_deg: float, about_deg: float) -> AxisMount:
    """The part is tilted about a level axis; `about_deg` is the direction of that axis, from x to y."""
    tilt, about = np.radians(tilt_deg), np.radians(about_deg)
    x, y, c, s = np.cos(about), np.sin(about), np.cos(tilt), np.sin(tilt)
    turn = np.array(
        [
            [c + x * x * (1.0 - c), x * y * (1.0 - c), -y * s],
            [x * y * (1.0 - c), c + y * y * (1.0 - c), x * s],
            [y * s, -x * s, c],
        ]
    )
    return AxisMount(turn @ mount.turn, turn @ mount.force, mount.offset_mps2)


def gyro_cross_axis(mount: AxisMount, *, xz_percent: float, yz_percent: float) -> AxisMount:
    """The axes x and y of the gyro read a share of z; the accelerometer does not."""
    shares = np.array([xz_percent, yz_percent, 0.0]) / 100.0
    return AxisMount(mount.turn + shares * mount.turn[2], mount.force, mount.offset_mps2)


def accel_bias(mount: AxisMount, *, offset_mps2: float, about_deg: float) -> AxisMount:
    """A level offset of the accelerometer, in the direction `about_deg` from x to y."""
    about = np.radians(about_deg)
    return AxisMount(
        mount.turn, mount.force, mount.offset_mps2 + offset_mps2 * np.array([np.cos(about), np.sin(about), 0])
    )


def accel_scale(mount: AxisMount, *, error_percent: float) -> AxisMount:
    """Gain of all axes of the accelerometer."""
    return AxisMount(mount.turn, (1.0 + error_percent / 100.0) * mount.force, mount.offset_mps2)


THREE_AXIS_KINDS: dict[str, Callable[..., AxisMount]] = {
    "misalignment": misalignment,
    "gyro_cross_axis": gyro_cross_axis,
    "accel_scale": accel_scale,
    "accel_bias": accel_bias,
}
"""Effects by name, in the order in which they act."""

THREE_AXIS_STRENGTHS = {
    "misalignment": EffectSizes("tilt_deg", (3.0, 6.0, 12.0)),
    "gyro_cross_axis": EffectSizes("xz_percent", (1.5, 4.0, 10.0), signed=True),
    "accel_scale": EffectSizes("error_percent", (0.6, 2.0, 6.0), signed=True),
    "accel_bias": EffectSizes("offset_mps2", (0.15, 0.5, 1.5)),
}
"""Small, typical and large. Typical lies within the tolerances of an MPU-6050 (6.1, 6.2): 2 % of cross-axis
sensitivity, 3 % of scale, 50 to 80 mg of zero-g offset; a board that is fixed by hand tilts by some degrees."""


def mount_of(faults: Iterable[InjectedEffect]) -> AxisMount:
    """AxisMount of a device with these effects; a healthy one turns and weighs along z."""
    mount = AxisMount(np.array([0.0, 0.0, 1.0]), np.eye(3), np.zeros(3))
    parameters = {fault.name: fault.parameters for fault in faults}
    for name, kind in THREE_AXIS_KINDS.items():
        mount = kind(mount, **parameters[name]) if name in parameters else mount
    return mount


def draw_three_axis_effect(rng: Rng, name: str, size: str) -> InjectedEffect:
    """An effect of THREE_AXIS_KINDS at a size."""
    sized = THREE_AXIS_STRENGTHS[name]
    strength = float(f"{varied(rng, sized.sizes[SIZES.index(size)], sized.spread):.4g}")
    strength *= float(rng.choice([-1.0, 1.0])) if sized.signed else 1.0
    rest = {"about_deg": round(rng.uniform(-180.0, 180.0), 3)} if name in {"misalignment", "accel_bias"} else {}
    if name == "gyro_cross_axis":
        rest = {"yz_percent": round(strength * rng.uniform(-1.0, 1.0), 4)}
    return InjectedEffect(name, {sized.parameter: strength, **rest})
