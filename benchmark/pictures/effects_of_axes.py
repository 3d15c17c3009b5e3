"""Pictures of the effects on all axes: errors of x, y and z in a hand."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt

from firmware_sim.effects.effect import Floats
from firmware_sim.effects.triaxial.catalogue import TRIAXIAL
from firmware_sim.effects.triaxial.effect import TriaxialEffect
from firmware_sim.measure import ACCEL_MISSING, TriaxialBlock, measure
from firmware_sim.motion.profile import load_motion
from firmware_sim.rig import Base, Rig, ThreeAxes, with_effects
from firmware_sim.triaxial import kinematics_of

SEED = 1
COLORS = ("tab:red", "tab:green", "tab:blue")
FINE = ThreeAxes(mps2_per_lsb=1e-3, accel_noise_mps2_rthz=0.0)
"""No noise, and fine counts, so that the effect alone shows."""

SHOWN = {"accel_range": {"limit_mps2": 7.0}, "accel_dropout": {"from_s": 14.0, "to_s": 20.0}}
"""Parameters of effects whose typical size does not show in this motion."""


@dataclass(frozen=True, slots=True)
class AxesScene:
    """Profile, its part, whether acceleration or rates are shown, and their errors or readings."""

    profile: str = "hand"
    from_s: float = 5.0
    to_s: float = 30.0
    is_accel: bool = False
    is_error: bool = True


SCENES = {
    "motor_vibration": AxesScene("hand", 10.0, 10.3),
    "accel_walk": AxesScene("rest", 0.0, 600.0, is_accel=True),
    "accel_steps": AxesScene("hand", 5.3, 5.7, is_accel=True),
    "accel_range": AxesScene(is_accel=True, is_error=False),
    "accel_dropout": AxesScene(is_accel=True, is_error=False),
}


def draw_axes(name: str, path: Path) -> None:
    """Draw the errors of x, y and z by an effect at its typical size."""
    kind = TRIAXIAL[name]
    effect = kind.model_validate({**kind.typical, **SHOWN.get(name, {})})
    scene = SCENES.get(name, AxesScene(is_accel=name.startswith("accel")))
    t_s, values = _values(effect, scene)
    figure, axes = plt.subplots(figsize=(4.2, 2.7), layout="constrained")
    for index, color in enumerate(COLORS):
        axes.plot(t_s, values[:, index], color=color, linewidth=1, label="xyz"[index])
    parameters = {key: value for key, value in effect.model_dump(exclude={"name"}).items() if value}
    axes.set_title(f"{name}\n{', '.join(f'{key} {value:g}' for key, value in parameters.items())}", fontsize=7)
    axes.set_xlabel("time, s", fontsize=8)
    axes.set_ylabel(f"{'error' if scene.is_error else 'reading'}, {'m/s²' if scene.is_accel else 'deg/s'}", fontsize=8)
    axes.legend(fontsize=7, loc="best", ncols=3)
    axes.tick_params(labelsize=7)
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)


def _values(effect: TriaxialEffect, scene: AxesScene) -> tuple[Floats, Floats]:
    """Times, and readings or their errors, shape (n, 3)."""
    base = Base(noise_dps_rthz=0.0, dps_per_lsb=1e-2, three_axes=FINE)
    motion = load_motion(scene.profile)
    block = next(measure(with_effects(Rig(base=base), [effect]), motion, SEED, block_samples=round(scene.to_s * 100.0)))
    assert isinstance(block, TriaxialBlock)
    t_s = block.seq / base.sample_rate_hz
    truth = kinematics_of(motion, t_s)
    if scene.is_accel:
        read = np.where(block.accel_raw == ACCEL_MISSING, np.nan, block.accel_raw * FINE.mps2_per_lsb)
        true = truth.specific_force_mps2(FINE.gravity_mps2)
    else:
        read, true = np.column_stack([block.gyro_xy_raw, block.rate_raw]) * base.dps_per_lsb, truth.rates_dps
    is_shown = t_s >= scene.from_s
    return t_s[is_shown], (read - true if scene.is_error else read)[is_shown]
