"""Effects in which chance plays a part, tones, and the steps of the encoder."""

from gyrodrift.diagnose.simulate.candidate import CandidateKind, Need, Touches
from gyrodrift.diagnose.simulate.grids import hinted, one_of, read_off, simulated, simulated_grid
from gyrodrift.diagnose.simulate.kinds.groups import OUTLIERS, STOCHASTIC_BIAS

DWELLS_S = (8.0, 16.0, 32.0, 80.0)

REALISATIONS = 16
"""Of an effect that a slow disturbance is drawn for in milliseconds: with two sessions, more than thirty."""


def _counts_per_turn(step_deg: float) -> int:
    return max(1, round(360.0 / step_deg))


NOISE_AND_ENCODER = (
    CandidateKind(
        "bias_instability",
        "floor_dph",
        simulated(3.0, 12.0, 50.0, 200.0),
        "the bias wanders slowly, and stays about where it is (1/f noise)",
        STOCHASTIC_BIAS,
        (),
        Touches.RATE,
        realisations=REALISATIONS,
        matters_from=3.0,
    ),
    CandidateKind(
        "rate_random_walk",
        "density_dps_rts",
        simulated(0.0002, 0.001, 0.005, 0.02),
        "the bias walks away by small random steps",
        STOCHASTIC_BIAS,
        (),
        Touches.SLOW_RATE,
        realisations=REALISATIONS,
        matters_from=0.0003,
    ),
    CandidateKind(
        "popcorn",
        "step_dps",
        one_of(simulated_grid(0.01, 0.1, 1.0), [{"dwell_s": dwell_s} for dwell_s in DWELLS_S]),
        "the bias jumps to and fro between two levels",
        STOCHASTIC_BIAS,
        (),
        Touches.SLOW_RATE,
        realisations=REALISATIONS,
        matters_from=0.01,
    ),
    CandidateKind(
        "spikes",
        "share_percent",
        hinted("height_dps", lambda hints: hints.spike_dps, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 2.0),
        "now and then a single rate is wild",
        OUTLIERS,
        (),
        Touches.VALUES,
        realisations=4,
    ),
    CandidateKind(
        "encoder_slip",
        "per_hour",
        hinted("step_deg", lambda hints: hints.slip_deg, 6.0, 30.0, 120.0),
        "the encoder's angle jumps, and stays there",
        OUTLIERS,
        (Need.MOTION,),
        Touches.VALUES,
        realisations=4,
    ),
    CandidateKind(
        "vibration",
        "amplitude_dps",
        hinted("frequency_hz", lambda hints: hints.line_hz, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0),
        "a tone of one frequency lies in the rate",
        None,
        (),
        Touches.VALUES,
        matters_from=0.02,
    ),
    CandidateKind(
        "encoder_quantization",
        "cpr",
        read_off(lambda hints: hints.angle_step_deg),
        "the encoder has fewer counts per turn than the rig says",
        None,
        (Need.MOTION,),
        Touches.VALUES,
        of_size=_counts_per_turn,
    ),
)
