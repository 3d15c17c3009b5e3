"""Effects that are linear in their size: two simulations tell of all sizes."""

from gyrodrift.diagnose.simulate.candidate import CandidateKind, Need, Touches
from gyrodrift.diagnose.simulate.grids import linear, linear_grid, one_of, turned
from gyrodrift.diagnose.simulate.kinds.groups import CLOCK, EVEN_IN_RATE, ONCE_PER_TURN, SCALE, SLOW_BIAS

WARMUP_TAUS_S = (20.0, 35.0, 60.0, 100.0, 160.0, 260.0, 450.0)

FAST_SHARE, SLOWER = 0.35, 5.0
"""Of a warm-up in two stages: what decays with the die, and by how many times slower the package is."""

IN_TWO_STAGES = [
    {"time_constant_s": tau_s, "fast_share": FAST_SHARE, "fast_time_constant_s": tau_s / SLOWER}
    for tau_s in (100.0, 160.0, 260.0)
]

CURVES_PER_C = (-0.01, 0.01)
"""10 °C from 25 °C a tenth of the line."""

LINEAR = (
    CandidateKind(
        "scale_factor",
        "error_percent",
        linear(0.01, 10.0),
        "the rate is too large or too small by the same share at every speed",
        SCALE,
        (Need.MOTION,),
        Touches.SLOW_RATE,
        is_exact=True,
        matters_from=0.06,
    ),
    CandidateKind(
        "scale_asymmetry",
        "error_percent",
        linear(0.005, 5.0),
        "the rate is too large in one direction and too small in the other",
        EVEN_IN_RATE,
        (Need.MOTION,),
        Touches.SLOW_RATE,
        is_exact=True,
        matters_from=0.03,
    ),
    CandidateKind(
        "nonlinearity",
        "error_percent_fs",
        linear(0.003, 3.0),
        "the gain changes with the rate, most at full speed",
        None,
        (Need.MOTION,),
        Touches.SLOW_RATE,
        matters_from=0.02,
    ),
    CandidateKind(
        "vibration_rectification",
        "bias_dps_at_100_dps",
        linear(0.002, 2.0),
        "the bias grows with the square of the rate",
        EVEN_IN_RATE,
        (Need.MOTION,),
        Touches.SLOW_RATE,
        matters_from=0.006,
    ),
    CandidateKind(
        "temp_bias",
        "slope_dps_per_c",
        one_of(linear_grid(0.0005, 0.5), [{}, *({"curve_per_c": curve} for curve in CURVES_PER_C)]),
        "the bias follows the temperature",
        SLOW_BIAS,
        (Need.TEMPERATURE,),
        Touches.SLOW_RATE,
        matters_from=0.0012,
    ),
    CandidateKind(
        "temp_scale",
        "slope_percent_per_c",
        linear(0.0005, 0.5),
        "the gain follows the temperature",
        None,
        (Need.MOTION, Need.TEMPERATURE),
        Touches.SLOW_RATE,
        matters_from=0.006,
    ),
    CandidateKind(
        "warmup",
        "amplitude_dps",
        one_of(linear_grid(0.003, 3.0), [*({"time_constant_s": tau_s} for tau_s in WARMUP_TAUS_S), *IN_TWO_STAGES]),
        "the bias settles after power-on, quickly first and then slower",
        SLOW_BIAS,
        (),
        Touches.SLOW_RATE,
        matters_from=0.012,
    ),
    CandidateKind(
        "clock_drift",
        "ppm",
        linear(10.0, 50000.0),
        "the device's clock runs fast or slow against the host's",
        CLOCK,
        (Need.HOST,),
        Touches.TIMES,
        is_exact=True,
        matters_from=30.0,
    ),
    CandidateKind(
        "g_sensitivity",
        "amplitude_dps",
        turned(0.001, 1.0),
        "the bias changes once per turn, as on a tilted table",
        ONCE_PER_TURN,
        (Need.MOTION,),
        Touches.SLOW_RATE,
        is_exact=True,
        matters_from=0.004,
    ),
    CandidateKind(
        "encoder_eccentricity",
        "amplitude_deg",
        turned(0.005, 5.0),
        "the encoder's angle errs once per turn, as with a disc off its centre",
        ONCE_PER_TURN,
        (Need.MOTION,),
        Touches.VALUES,
        is_exact=True,
        matters_from=0.02,
    ),
)
