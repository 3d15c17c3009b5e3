"""All methods that are compared, in the order in which they are listed: plain ones, our filters, other people's."""

from collections.abc import Mapping

from gyrodrift.compare.methods.filter_method import filter_method
from gyrodrift.compare.methods.fusion import run_fusion
from gyrodrift.compare.methods.kalman import run_kalman
from gyrodrift.compare.methods.method import Method
from gyrodrift.compare.methods.plain import run_euler, run_start_calibration
from gyrodrift.compare.methods.sign import run_sign
from gyrodrift.compare.methods.vqf import run_vqf, run_vqf_offline
from gyrodrift.evaluation.space import Axis
from gyrodrift.filters.filter import FilterParams
from gyrodrift.filters.registry import FILTERS

VQF_DEFAULTS = {
    "restThGyr": 2.0,
    "restFilterTau": 0.5,
    "restMinT": 1.5,
    "biasSigmaInit": 0.5,
    "biasForgettingTime": 100.0,
    "biasClip": 2.0,
    "biasSigmaRest": 0.03,
}
"""Of its 25 parameters those that matter for the bias about the vertical; deg/s and s."""

VQF_AXES = (
    Axis("restThGyr", 0.02, 20.0, is_log=True),
    Axis("restFilterTau", 0.02, 10.0, is_log=True),
    Axis("restMinT", 0.05, 20.0, is_log=True),
    Axis("biasSigmaInit", 0.01, 20.0, is_log=True),
    Axis("biasForgettingTime", 1.0, 1e5, is_log=True),
    Axis("biasClip", 0.1, 20.0, is_log=True),
    Axis("biasSigmaRest", 1e-4, 1.0, is_log=True),
)

PLAIN = (
    Method("euler", "Euler", run_euler, about="The rate as it is, added up.", colour="plain"),
    Method(
        "start",
        "start calibration",
        run_start_calibration,
        {"calibration_s": 3.0},
        about="The mean of the first three seconds is taken off; nothing is learnt later, and nothing is tuned.",
        colour="quiet",
    ),
    Method(
        "sign",
        "sign integrator",
        run_sign,
        {"step_dps": 0.0006, "theta_dps": 2.0},
        (Axis("step_dps", 1e-6, 0.1, is_log=True), Axis("theta_dps", 0.02, 20.0, is_log=True)),
        about="No defaults are published for it: the step is HDR's, the threshold the one that VQF calls rest.",
        counts_samples=True,
        colour="two",
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
        about="No defaults are published for it: noise and walk are those of a usual MEMS part, rest takes as long as "
        "VQF's, and the largest bias is what x-io Fusion takes for one.",
        colour="three",
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
        about="Threshold (deg/s) and period (s) are all that its package lets be changed: how fast it learns is fixed.",
        colour="four",
    ),
    Method(
        "vqf",
        "VQF",
        run_vqf,
        VQF_DEFAULTS,
        VQF_AXES,
        package="vqf",
        about="It is told that the device lies level; what it learns from tilting is not there to be had.",
        colour="five",
    ),
    Method(
        "vqf_offline",
        "OfflineVQF",
        run_vqf_offline,
        VQF_DEFAULTS,
        VQF_AXES,
        package="vqf",
        is_offline=True,
        about="It walks through a session forwards and backwards: a bound for filters that stream, not one of them.",
        colour="five",
        dash="--",
    ),
)


def methods(params: Mapping[str, FilterParams] | None = None) -> tuple[Method, ...]:
    """All of them, our filters with these parameters by their names, or else their defaults."""
    given = params or {}
    return (*PLAIN, *(filter_method(known, given.get(name)) for name, known in FILTERS.items()), *PEERS)


def by_key() -> dict[str, Method]:
    """All of them by their names in files."""
    return {method.key: method for method in methods()}
