"""MuJoCo: sensors for a model, and a callback that puts the effects on the gyro.

`noise` is the standard deviation of a sensor value. Since version 3.1.4 MuJoCo only stores it (XML reference, sensor),
so the callback adds the noise. `cutoff` limits the value. All other effects are in the callback, which fills a sensor
of the type `user` from the ideal gyro.
"""

import json
from math import sqrt

from gyrodrift.diagnose.export.effects_json import UNKNOWN, entry_of, noise_entries
from gyrodrift.diagnose.export.exported import Exported
from gyrodrift.diagnose.export.formats import RAD, FormatExport, comment_lines, off_the_rate
from gyrodrift.effects import EFFECTS

XML, CALLBACK = "mujoco.xml", "mujoco_callback.py"


def mujoco(exported: Exported) -> FormatExport:
    """An XML file to include, and a Python file to import."""
    missing = {effect.name: UNKNOWN for effect in exported.effects if effect.name not in EFFECTS}
    missing |= off_the_rate(exported.effects)
    expressed = tuple(effect.name for effect in exported.effects if effect.name not in missing)
    files = {XML: _xml(exported, missing), CALLBACK: _callback(exported, missing)}
    return FormatExport("mujoco", files, expressed, missing)


def _xml(exported: Exported, missing: dict[str, str]) -> str:
    comment = "\n     ".join(comment_lines(exported, missing))
    noise = exported.noise_dps_rthz.value * RAD * sqrt(exported.sample_rate_hz)
    saturation = exported.effect("saturation")
    cutoff = "" if saturation is None else f' cutoff="{saturation.parameters["limit_dps"] * RAD:.6g}"'
    return f"""<!-- {comment}
     Include this file in a model with a site "imu", whose z axis is the yaw axis. Values are in rad/s.
     "gyro" is ideal; {CALLBACK} fills "gyro_measured". MuJoCo adds no noise by itself. -->
<mujoco>
  <sensor>
    <gyro name="gyro" site="imu"/>
    <user name="gyro_measured" dim="3" needstage="vel" datatype="real" noise="{noise:.6g}"{cutoff}/>
  </sensor>
</mujoco>
"""


def _callback(exported: Exported, missing: dict[str, str]) -> str:
    comment = "\n".join(f"# {line}" for line in comment_lines(exported, missing))
    effects = [entry_of(effect) for effect in exported.effects if effect.name not in missing]
    shown = {"effect", "parameters"}
    entries = [
        {name: value for name, value in entry.items() if name in shown}
        for entry in (*effects, *noise_entries(exported))
    ]
    listed = "".join(f"    {json.dumps(entry)},\n" for entry in entries)
    return CALLBACK_TEXT.format(comment=comment, effects=listed, rate_hz=f"{exported.sample_rate_hz:.6g}")


CALLBACK_TEXT = '''"""MuJoCo: the sensor "gyro_measured" reads the yaw rate of "gyro" with the effects of a real gyro.

    mujoco.set_mjcb_sensor(Measured(seed=1))
"""

{comment}

import mujoco
import numpy as np

from gyrodrift.effects import SimulatedGyro

RATE_HZ = {rate_hz}
EFFECTS = [
{effects}]


class Measured:
    """Callback: reads at RATE_HZ and holds the value in between; a time that goes back begins a new run."""

    def __init__(self, seed=None):
        self._random, self._last_s = np.random.default_rng(seed), np.inf

    def __call__(self, model, data, stage):
        if stage != mujoco.mjtStage.mjSTAGE_VEL:
            return
        if data.time < self._last_s - 1e-9:
            self._gyro, self._next = SimulatedGyro(EFFECTS, 1.0 / RATE_HZ, self._random.integers(1 << 31)), 0
        self._last_s = data.time
        true = data.sensor("gyro").data
        if data.time * RATE_HZ > self._next - 1e-6:
            self._rate = np.radians(self._gyro.read(float(np.degrees(true[2])), data.time))
            self._next = np.floor(data.time * RATE_HZ + 1e-6) + 1
        data.sensor("gyro_measured").data[:] = true[0], true[1], self._rate
'''
