"""`imu.yaml` of Kalibr, which many Allan variance tools write: noise density and random walk of the gyro.

The noise model of Kalibr is in continuous time. `gyroscope_noise_density` is in rad/s/√Hz: a sample at a rate f has the
standard deviation density·√f. `gyroscope_random_walk` is in rad/s²/√Hz, which is rad/s/√s. Kalibr refuses 0 and a file
without the accelerometer.
"""

from gyrodrift.diagnose.export.exported import Exported
from gyrodrift.diagnose.export.formats import RAD, FormatExport, comment_lines, off_the_rate

FILE = "imu.yaml"
NO_FIELD = "Kalibr knows white noise and a random walk only"


def kalibr(exported: Exported) -> FormatExport:
    """Values that were not diagnosed stay comments, with the bound that the recordings give."""
    walk = exported.effect("rate_random_walk")
    missing = {effect.name: NO_FIELD for effect in exported.effects if effect is not walk}
    missing |= off_the_rate(exported.effects)
    lines = [f"# {line}" for line in comment_lines(exported, missing)]
    lines += [
        "# Only the gyro about z is measured: fill in the accelerometer, which Kalibr needs.",
        "#accelerometer_noise_density:   # m/s^2/sqrt(Hz)",
        "#accelerometer_random_walk:     # m/s^3/sqrt(Hz)",
        _noise_line(exported),
        _walk_line(exported),
        "rostopic: /imu",
        f"update_rate: {exported.sample_rate_hz:.6g}   # Hz",
    ]
    expressed = () if walk is None else (walk.name,)
    return FormatExport("kalibr", {FILE: "\n".join(lines) + "\n"}, expressed, missing)


def _noise_line(exported: Exported) -> str:
    noise = exported.noise_dps_rthz.times(RAD)
    if noise.value <= 0.0:
        return "#gyroscope_noise_density:   # rad/s/sqrt(Hz): the recordings have no more noise than the baseline"
    between = f"measured, {noise.low:.4g} to {noise.high:.4g}"
    return f"gyroscope_noise_density: {_number(noise.value)}   # rad/s/sqrt(Hz), {between}"


def _walk_line(exported: Exported) -> str:
    walk = exported.effect("rate_random_walk")
    if walk is not None:
        low, high = (bound * RAD for bound in walk.intervals["density_dps_rts"])
        value = _number(walk.parameters["density_dps_rts"] * RAD)
        return f"gyroscope_random_walk: {value}   # rad/s^2/sqrt(Hz), {low:.4g} to {high:.4g}"
    bound = exported.upper_bounds.get("rate_random_walk")
    below = "" if bound is None else f", below {_number(bound * RAD)}"
    return f"#gyroscope_random_walk:   # rad/s^2/sqrt(Hz): no walk is diagnosed{below}"


def _number(value: float) -> str:
    """A number that YAML 1.1 reads as one: with a point in front of an exponent."""
    text = f"{value:.6g}"
    return text.replace("e", ".0e") if "e" in text and "." not in text else text
