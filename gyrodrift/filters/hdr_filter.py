"""HDR as everything else knows it: records and step, what its parameters mean, and where they are searched."""

from gyrodrift.filters import hdr
from gyrodrift.filters.filter import Filter, FilterParameter, ReducedModel, SearchRange

EULER = hdr.HdrParams(0.0, 0.0, 1.0, 0.0, 1.0)
"""Learns nothing and filters nothing."""

PARAMETERS = (
    FilterParameter(
        "i_c_dps",
        "deg/s per sample",
        "integrator step per sample, deg/s: larger learns faster and hunts more",
        "How far the drift estimate moves at each sample. Small: drift is learnt slowly. "
        "Large: the estimate hunts to and fro.",
        "it takes sessions with a drift to learn",
        SearchRange(1e-6, 0.1, is_log=True),
    ),
    FilterParameter(
        "tau_s",
        "s",
        "low-pass before the decision, s",
        "How long the rate is averaged before its sign is looked at. Small: the noise of single samples decides. "
        "Large: it decides late.",
        "it takes rests long enough for noise to matter, and turns that begin sharply",
        SearchRange(1e-3, 30.0, is_log=True),
    ),
    FilterParameter(
        "theta_w_dps",
        "deg/s",
        "nothing is learnt above this rate, deg/s; a bias above it is never learnt",
        "Turn switch: above this rate nothing is learnt. Small: learns only near rest, and a bias larger "
        "than this never. Large: slow turns pass for drift.",
        "it takes motion at all rates, slow turns too",
        SearchRange(0.02, 20.0, is_log=True),
    ),
    FilterParameter(
        "c1",
        "",
        "attenuator of repeated steps: 0 switches it off",
        "How strongly the step shrinks while the rate keeps its sign. 0: not at all. Large: long runs count little.",
        "it takes long stretches of one direction as well as rests",
        SearchRange(0.0, 3.0),
    ),
    FilterParameter(
        "c2",
        "",
        "its steepness",
        "How steeply it shrinks as the run gets longer. Small: hardly. Above 1: what one run can correct is bounded.",
        "it takes long stretches of one direction as well as rests, and a c1 above 0",
        SearchRange(0.0, 3.0),
    ),
)
"""The ranges are wide enough for sensors of 0.01 to 10 deg/s of bias at 2 Hz to 10 kHz."""

HDR = Filter(
    name="hdr",
    params=hdr.HdrParams,
    coefficients=hdr.coefficients,
    state=hdr.HdrState,
    step=hdr.step,
    columns=("lpf_dps", "i_dps", "omega_dps", "omega_d_dps", "yaw_deg"),
    parameters=PARAMETERS,
    baseline=EULER,
    unsearched=EULER,
    reduced=ReducedModel(("i_c_dps", "theta_w_dps"), "two parameters"),
    sample_counted="i_c_dps and the attenuator",
    kernel="gyrodrift.evaluation.kernels.hdr:KERNEL",
    title="HDR",
    about="The published parameters where no --config is given.",
    colour="six",
    dash="-",
)
