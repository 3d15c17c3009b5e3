"""SDFormat for Gazebo: the noise of the rate about z of an IMU.

`noise.sdf` and the implementation `gz-sensors/src/GaussianNoiseModel.cc` define the elements:

- `mean` and `stddev` are those of a normal number that is added to each sample, rad/s.
- `bias_mean` gets a random sign, and decays if there is a dynamic bias. So a constant bias goes into `mean`.
- `bias_stddev` is the standard deviation of the bias from start to start.
- `dynamic_bias_stddev` drives a first-order Gauss-Markov process: it is the random walk in rad/s/√s, not the standard
  deviation of the bias, which is dynamic_bias_stddev · √(correlation time / 2).
- `precision` rounds the sum, if the type is `gaussian_quantized`.
"""

from collections.abc import Sequence
from math import sqrt

from gyrodrift.diagnose.export.exported import Exported, ExportedEffect
from gyrodrift.diagnose.export.formats import RAD, FormatExport, comment_lines, off_the_rate

FILE = "gazebo.sdf"

WALK_S = 1e5
"""Correlation time of a walk, s. Chosen: longer than a run, so that the bias does not decay."""

FLICKER_S = 100.0
FLICKER_SIGMA = 0.664 / 0.617
"""A Gauss-Markov process instead of 1/f noise: its largest Allan deviation, 0.617 sigma (IEEE Std 952), equals the
flat one, 0.664 B. Its correlation time is chosen: between a second and an hour."""

DYNAMIC = ("rate_random_walk", "popcorn", "bias_instability")
"""Effects that a dynamic bias stands for; the first of those that are named is taken."""

ONE_ONLY = "SDFormat has one dynamic bias, and another effect takes it"
NO_ELEMENT = "SDFormat has no element for it"


def gazebo(exported: Exported) -> FormatExport:
    """The sensor in a link of a model, so that the file can be checked as it is."""
    dynamic = next((effect for name in DYNAMIC if (effect := exported.effect(name)) is not None), None)
    expressed = [effect for effect in exported.effects if effect is dynamic or effect.name == "quantization"]
    missing = {effect.name: _why(effect) for effect in exported.effects if effect not in expressed}
    missing |= {name: why for name, why in off_the_rate(exported.effects).items() if name in missing}
    text = _text(exported, dynamic, missing)
    return FormatExport("gazebo", {FILE: text}, tuple(effect.name for effect in expressed), missing)


def _why(effect: ExportedEffect) -> str:
    return ONE_ONLY if effect.name in DYNAMIC else NO_ELEMENT


def _text(exported: Exported, dynamic: ExportedEffect | None, missing: dict[str, str]) -> str:
    comment = "\n     ".join([*comment_lines(exported, missing), *_dynamic_words(dynamic)])
    noise = "\n".join(f"              {line}" for line in _noise_lines(exported, dynamic))
    return f"""<?xml version="1.0"?>
<!-- {comment}
     Only the rate about z is measured. Values are in rad/s, at this update rate. -->
<sdf version="1.9">
  <model name="imu">
    <link name="imu_link">
      <sensor name="imu" type="imu">
        <update_rate>{exported.sample_rate_hz:.6g}</update_rate>
        <imu>
          <angular_velocity>
            <z>
{noise}
            </z>
          </angular_velocity>
        </imu>
      </sensor>
    </link>
  </model>
</sdf>
"""


def _noise_lines(exported: Exported, dynamic: ExportedEffect | None) -> Sequence[str]:
    quantization = exported.effect("quantization")
    bias = exported.bias_dps.times(RAD)
    values = {
        "mean": bias.value,
        "stddev": exported.noise_dps_rthz.value * RAD * sqrt(exported.sample_rate_hz),
        "bias_mean": 0.0,
        "bias_stddev": (bias.high - bias.low) / 2.0,
    }
    if dynamic is not None:
        names = ("dynamic_bias_stddev", "dynamic_bias_correlation_time")
        values |= dict(zip(names, dynamic_bias(dynamic), strict=True))
    if quantization is not None:
        values["precision"] = quantization.parameters["step_dps"] * RAD
    kind = "gaussian" if quantization is None else "gaussian_quantized"
    inner = [f"  <{name}>{value:.6g}</{name}>" for name, value in values.items()]
    return [f'<noise type="{kind}">', *inner, "</noise>"]


def dynamic_bias(effect: ExportedEffect) -> tuple[float, float]:
    """Driving noise, rad/s/√s, and correlation time, s, of the process that stands for an effect."""
    match effect.name:
        case "rate_random_walk":
            return effect.parameters["density_dps_rts"] * RAD, WALK_S
        case "popcorn":  # a telegraph signal has the covariance (step/2)² · exp(−2·|t|/dwell)
            sigma, time_s = effect.parameters["step_dps"] / 2.0, effect.parameters["dwell_s"] / 2.0
        case _:
            sigma, time_s = FLICKER_SIGMA * effect.parameters["floor_dph"] / 3600.0, FLICKER_S
    return sigma * RAD * sqrt(2.0 / time_s), time_s


def _dynamic_words(dynamic: ExportedEffect | None) -> list[str]:
    if dynamic is None or dynamic.name == "rate_random_walk":
        return []
    what = (
        "its spectrum, but not its two levels" if dynamic.name == "popcorn" else "its Allan deviation near 100 s only"
    )
    return [f"The dynamic bias approximates {dynamic.name}: it has {what}."]
