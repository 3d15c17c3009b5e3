"""All compared methods in their order: plain methods, the filters of this package, that of the device, others."""

from collections.abc import Callable, Mapping
from dataclasses import replace

from gyrodrift.compare.methods.filter_method import AIDED, ON_DEVICE, filter_method
from gyrodrift.compare.methods.method import Method, Params
from gyrodrift.compare.methods.packages import run_fusion, run_vqf, run_vqf_offline
from gyrodrift.compare.methods.plain import run_euler, run_kalman, run_sign, run_start_calibration
from gyrodrift.compare.methods.six_axes import (
    fusion_heading,
    madgwick_heading,
    mahony_heading,
    vqf_heading,
    vqf_offline_heading,
)
from gyrodrift.evaluation.auxiliary import Auxiliary, InertialColumns
from gyrodrift.evaluation.space import Axis
from gyrodrift.filters.filter import FilterParams
from gyrodrift.filters.registry import FILTERS
from gyrodrift.values.arrays import Floats

Heading = Callable[[Floats, InertialColumns, Params], Floats]
"""From device times in s, three axes and parameters to heading in deg, shape (n,)."""

VQF_DEFAULTS = {
    "restThGyr": 2.0,
    "restFilterTau": 0.5,
    "restMinT": 1.5,
    "biasSigmaInit": 0.5,
    "biasForgettingTime": 100.0,
    "biasClip": 2.0,
    "biasSigmaRest": 0.03,
}
"""Parameters of VQF that affect the bias about the vertical, 7 of 25, in deg/s and s: defaults of the package."""

VQF_AXES = (
    Axis("restThGyr", 0.02, 20.0, is_log=True),
    Axis("restFilterTau", 0.02, 10.0, is_log=True),
    Axis("restMinT", 0.05, 20.0, is_log=True),
    Axis("biasSigmaInit", 0.01, 20.0, is_log=True),
    Axis("biasForgettingTime", 1.0, 1e5, is_log=True),
    Axis("biasClip", 0.1, 20.0, is_log=True),
    Axis("biasSigmaRest", 1e-4, 1.0, is_log=True),
)


def missing_axes(_t_s: Floats, _rate_dps: Floats, _params: Params) -> Floats:
    """A method of three axes has no yaw for one axis."""
    raise ValueError("the method needs accelerations")


def on_axes(key: str, heading: Heading) -> Callable[[InertialColumns, Auxiliary], Method]:
    """Function that gives the method of this key with its heading on three axes."""

    def bound(axes: InertialColumns, _auxiliary: Auxiliary) -> Method:
        return replace(by_key()[key], run=lambda t_s, _rate_dps, params: heading(t_s, axes, params))

    return bound


PLAIN = (
    Method("euler", "Euler", run_euler, about="Integral of the rate without correction.", color="plain"),
    Method(
        "start",
        "start calibration",
        run_start_calibration,
        {"calibration_s": 3.0},
        about="Subtracts the mean rate of the first three seconds; not tuned.",
        color="quiet",
    ),
    Method(
        "sign",
        "sign integrator",
        run_sign,
        {"step_dps": 0.0006, "theta_dps": 2.0},
        (Axis("step_dps", 1e-6, 0.1, is_log=True), Axis("theta_dps", 0.02, 20.0, is_log=True)),
        about="No published defaults: the step is taken from HDR, the threshold from the rest detection of VQF.",
        counts_samples=True,
        color="two",
    ),
    Method(
        "kalman",
        "zero-rate Kalman",
        run_kalman,
        {"rest_dps": 1.0, "rest_s": 1.5, "bias_most_dps": 3.0, "noise_dps": 0.1, "walk_dps_rts": 0.002},
        (
            Axis("rest_dps", 0.02, 20.0, is_log=True),
            Axis("rest_s", 0.05, 20.0, is_log=True),
            Axis("bias_most_dps", 0.1, 20.0, is_log=True),
            Axis("noise_dps", 1e-3, 10.0, is_log=True),
            Axis("walk_dps_rts", 1e-6, 1.0, is_log=True),
        ),
        about="No published defaults: noise and walk of a typical MEMS gyro, rest as in VQF, largest bias as in "
        "x-io Fusion.",
        color="three",
    ),
)

PEERS = (
    Method(
        "xio",
        "x-io Fusion",
        run_fusion,
        {"stationary_threshold": 3.0, "stationary_period": 3.0},
        (Axis("stationary_threshold", 0.02, 20.0, is_log=True), Axis("stationary_period", 0.05, 20.0, is_log=True)),
        package="imufusion",
        with_axes=on_axes("xio", fusion_heading),
        about="The package has two parameters, threshold (deg/s) and period (s); its learning rate is fixed.",
        color="four",
    ),
    Method(
        "vqf",
        "VQF",
        run_vqf,
        VQF_DEFAULTS,
        VQF_AXES,
        package="vqf",
        with_axes=on_axes("vqf", vqf_heading),
        about="On one axis it runs as on a level device, and cannot learn from tilt.",
        color="five",
    ),
    Method(
        "vqf_offline",
        "OfflineVQF",
        run_vqf_offline,
        VQF_DEFAULTS,
        VQF_AXES,
        package="vqf",
        with_axes=on_axes("vqf_offline", vqf_offline_heading),
        is_offline=True,
        about="Runs forward and backward over a session: a bound for real-time filters.",
        color="five",
        dash="--",
    ),
    Method(
        "madgwick",
        "Madgwick",
        missing_axes,
        {"gain": 0.033},
        package="ahrs",
        needs_axes=True,
        with_axes=on_axes("madgwick", madgwick_heading),
        about="Package ahrs with its default gain; it estimates no bias.",
        color="quiet",
        dash="--",
    ),
    Method(
        "mahony",
        "Mahony",
        missing_axes,
        {"k_p": 1.0, "k_i": 0.3},
        package="ahrs",
        needs_axes=True,
        with_axes=on_axes("mahony", mahony_heading),
        about="Package ahrs with its default gains.",
        color="three",
        dash="--",
    ),
)


def methods(params: Mapping[str, FilterParams] | None = None) -> tuple[Method, ...]:
    """All methods; filters have these parameters by name, or their defaults."""
    given = params or {}
    own = (filter_method(chosen, given.get(name)) for name, chosen in FILTERS.items())
    return (*PLAIN, *own, AIDED, ON_DEVICE, *PEERS)


def by_key() -> dict[str, Method]:
    """All methods by key."""
    return {method.key: method for method in methods()}
