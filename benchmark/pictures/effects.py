"""Picture of every effect at its typical size: output of the rig without and with it.

`python -m benchmark pictures.effects --out docs/effects` draws all pictures, those of effects on all axes in a folder
`triaxial`; it needs matplotlib from the lab extra.
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from itertools import islice
from math import ceil
from pathlib import Path

import matplotlib as mpl
import numpy as np

mpl.use("Agg")
from matplotlib import pyplot as plt

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect, Floats
from firmware_sim.effects.triaxial.catalogue import TRIAXIAL
from firmware_sim.measure import BLOCK_SAMPLES, joined, measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Rig, load_rig, with_effects
from pictures.effects_of_axes import draw_axes

WITHOUT, WITH = "0.6", "tab:red"
SEED = 1
TRIAXIAL_FOLDER = "triaxial"
"""Folder of the pictures of effects on all axes."""


@dataclass(frozen=True, slots=True)
class Trace:
    """Run in physical units; every array has the shape (n,)."""

    device_s: Floats
    host_s: Floats
    rate_dps: Floats
    encoder_deg: Floats
    temp_c: Floats
    true_rate_dps: Floats
    true_angle_deg: Floats

    def part(self, from_s: float, to_s: float) -> "Trace":
        """Samples between two device times."""
        kept = (self.device_s >= from_s) & (self.device_s < to_s)
        return Trace(*(getattr(self, name)[kept] for name in self.__slots__))


def _turning(rate_dps: Floats) -> Floats:
    """Rate if it is large enough for a division, else NaN."""
    return np.where(np.abs(rate_dps) > 10.0, rate_dps, np.nan)


Axis = tuple[str, Callable[[Trace], Floats]]

TIME: Axis = ("time, s", lambda r: r.device_s)
RATE: Axis = ("measured rate, deg/s", lambda r: r.rate_dps)
TRUE_RATE: Axis = ("true rate, deg/s", lambda r: r.true_rate_dps)
ERROR: Axis = ("measured − true rate, deg/s", lambda r: r.rate_dps - r.true_rate_dps)
TURN: Axis = ("table angle, deg", lambda r: r.true_angle_deg % 360.0)
TEMP: Axis = ("temperature, °C", lambda r: r.temp_c)
GAIN: Axis = ("measured / true rate − 1, %", lambda r: 100.0 * (r.rate_dps / _turning(r.true_rate_dps) - 1.0))
ENCODER: Axis = ("encoder angle, deg", lambda r: r.encoder_deg)
ENCODER_ERROR: Axis = ("encoder − true angle, deg", lambda r: r.encoder_deg - r.true_angle_deg)
CLOCK_ERROR: Axis = ("device − host time, s", lambda r: r.device_s - r.host_s)
DEVICE_STEP: Axis = ("step of device time, ms", lambda r: 1e3 * np.diff(r.device_s, prepend=r.device_s[0] - 0.01))
HOST_STEP: Axis = ("step of arrival, ms", lambda r: 1e3 * np.diff(r.host_s, prepend=r.host_s[0] - 0.01))


@dataclass(frozen=True, slots=True)
class Scene:
    """Scene of a picture: part of a motion, two quantities, and the number of samples per mean."""

    profile: str
    from_s: float
    to_s: float
    x: Axis
    y: Axis
    mean_of: int = 1
    line: str = "."


STEPS = ("identify", 60.0, 162.0)
SCENES = {
    "scale_factor": Scene(*STEPS, TRUE_RATE, ERROR, 50),
    "misalignment": Scene(*STEPS, TRUE_RATE, ERROR, 50),
    "scale_asymmetry": Scene(*STEPS, TRUE_RATE, ERROR, 50),
    "nonlinearity": Scene(*STEPS, TRUE_RATE, ERROR, 50),
    "deadband": Scene("identify", 503.0, 545.0, TIME, RATE),
    "saturation": Scene("identify", 130.0, 164.0, TIME, RATE, line="-"),
    "quantization": Scene("identify", 520.0, 530.0, TIME, RATE, line="-"),
    "bandwidth": Scene("identify", 440.0, 442.0, TIME, RATE, line="-"),
    "latency": Scene("identify", 440.0, 441.0, TIME, RATE, line="-"),
    "bias_instability": Scene("rest", 0.0, 3600.0, TIME, ERROR, 1000, "-"),
    "rate_random_walk": Scene("rest", 0.0, 3600.0, TIME, ERROR, 1000, "-"),
    "popcorn": Scene("rest", 0.0, 300.0, TIME, ERROR, 20, "-"),
    "spikes": Scene("identify", 0.0, 120.0, TIME, ERROR, line="-"),
    "vibration": Scene("rest", 0.0, 0.6, TIME, ERROR, line=".-"),
    "vibration_rectification": Scene(*STEPS, TRUE_RATE, ERROR, 50),
    "g_sensitivity": Scene("identify", 284.0, 404.0, TURN, ERROR, 10),
    "temp_bias": Scene("identify", 0.0, 594.0, TEMP, ERROR, 50),
    "temp_scale": Scene("identify", 284.0, 404.0, TEMP, GAIN, 100),
    "warmup": Scene("rest", 0.0, 600.0, TIME, ERROR, 100, "-"),
    "encoder_eccentricity": Scene("identify", 284.0, 404.0, TURN, ENCODER_ERROR),
    "encoder_slip": Scene("identify", 0.0, 594.0, TIME, ENCODER_ERROR, line="-"),
    "encoder_quantization": Scene("identify", 60.0, 60.9, TIME, ENCODER, line="-"),
    "backlash": Scene("identify", 60.0, 90.0, TIME, ENCODER_ERROR, line="-"),
    "clock_drift": Scene("rest", 0.0, 60.0, TIME, CLOCK_ERROR, line="-"),
    "timestamp_jitter": Scene("rest", 0.0, 3.0, TIME, DEVICE_STEP),
    "usb_batching": Scene("rest", 0.0, 1.0, TIME, HOST_STEP, line=".-"),
    "sample_drop": Scene("rest", 0.0, 10.0, TIME, DEVICE_STEP),
    "stale_hold": Scene("identify", 440.0, 441.5, TIME, RATE, line=".-"),
}
PLAIN = Scene("identify", 0.0, 594.0, TIME, ERROR, 50, "-")
"""Scene of an effect without its own."""


def record(rig: Rig, profile_name: str, seconds: float) -> Trace:
    """Run a rig for some seconds."""
    profile = load_profile(profile_name)
    blocks = list(islice(measure(rig, profile, SEED), ceil(seconds * rig.base.sample_rate_hz / BLOCK_SAMPLES)))
    whole = reduce(joined, blocks)
    angle_deg, rate_dps = profile.motion_at(whole.seq / rig.base.sample_rate_hz)
    return Trace(
        device_s=whole.t_device_us / 1e6,
        host_s=whole.t_host_s,
        rate_dps=whole.rate_raw.astype(np.float64) * rig.base.dps_per_lsb,
        encoder_deg=whole.encoder_counts * 360.0 / rig.base.encoder_cpr,
        temp_c=whole.temp_centi_c / 100.0,
        true_rate_dps=rate_dps,
        true_angle_deg=angle_deg,
    ).part(0.0, seconds)


def draw(effect: Effect, path: Path) -> None:
    """Draw a picture: gray without the effect, red with it."""
    scene, shipped = SCENES.get(effect.name, PLAIN), load_rig(None)
    rig = shipped.model_copy(update={"base": shipped.base.model_copy(update={"bias_dps": 0.0})})
    figure, axes = plt.subplots(figsize=(4.2, 2.7), layout="constrained")
    for color, shown in ((WITHOUT, rig), (WITH, with_effects(rig, [effect]))):
        part = record(shown, scene.profile, scene.to_s).part(scene.from_s, scene.to_s)
        x, y = (_means(axis(part), scene.mean_of) for axis in (scene.x[1], scene.y[1]))
        axes.plot(x, y, scene.line, color=color, markersize=3, linewidth=1)
    parameters = ", ".join(f"{key} {value:g}" for key, value in effect.model_dump(exclude={"name"}).items())
    axes.set_title(f"{effect.name}\n{parameters}", fontsize=9)
    axes.set_xlabel(scene.x[0], fontsize=8)
    axes.set_ylabel(scene.y[0], fontsize=8)
    axes.tick_params(labelsize=7)
    axes.grid(alpha=0.3)
    figure.savefig(path, dpi=90, metadata={"Software": None})
    plt.close(figure)


def _means(values: Floats, count: int) -> Floats:
    whole = len(values) // count * count
    means: Floats = values[:whole].reshape(-1, count).mean(axis=1)
    return means


def main(argv: list[str] | None = None) -> int:
    """Draw all pictures, or those of the given effects."""
    parser = argparse.ArgumentParser(
        prog="python -m benchmark pictures.effects", description=__doc__, allow_abbrev=False
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder for the pictures")
    parser.add_argument("names", nargs="*", metavar="NAME", help="effects to draw (default: all)")
    arguments = parser.parse_args(argv)
    unknown = sorted(set(arguments.names) - {*CATALOGUE, *TRIAXIAL})
    if unknown:
        parser.error(f"there is no effect {unknown[0]!r}; there are {', '.join([*CATALOGUE, *TRIAXIAL])}")
    triaxial = arguments.out / TRIAXIAL_FOLDER
    triaxial.mkdir(parents=True, exist_ok=True)
    for name in arguments.names or [*CATALOGUE, *TRIAXIAL]:
        if name in TRIAXIAL:
            draw_axes(name, triaxial / f"{name}.png")
        else:
            draw(CATALOGUE[name].model_validate(CATALOGUE[name].typical), arguments.out / f"{name}.png")
    return 0


if __name__ == "__main__":
    sys.exit(main())
