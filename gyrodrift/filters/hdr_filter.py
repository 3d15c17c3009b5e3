"""HDR as a filter of the registry: records, step, and the meaning and search range of each parameter."""

from gyrodrift.filters import hdr
from gyrodrift.filters.filter import Filter, FilterParameter, ReducedModel, SearchRange

EULER = hdr.HdrParams(0.0, 0.0, 1.0, 0.0, 1.0)
"""Parameters of plain integration."""

PARAMETERS = (
    FilterParameter(
        "i_c_dps",
        "deg/s per sample",
        "integrator step per sample, deg/s: large learns fast and oscillates",
        "Change of the drift estimate per sample. Small: learns slowly. Large: the estimate oscillates.",
        "it needs sessions with drift",
        SearchRange(1e-6, 0.1, is_log=True),
    ),
    FilterParameter(
        "tau_s",
        "s",
        "time constant of the low-pass before the sign is taken, s",
        "Averaging time before the sign of the rate is taken. Small: noise decides the sign. Large: the sign is late.",
        "it needs rests long enough for noise to matter, and turns that begin sharply",
        SearchRange(1e-3, 30.0, is_log=True),
    ),
    FilterParameter(
        "theta_w_dps",
        "deg/s",
        "no learning above this rate, deg/s; a larger bias is never learned",
        "Turn switch: no learning above this rate. Small: learns only near rest, and never a larger bias. "
        "Large: slow turns are taken for drift.",
        "it needs motion at all rates, slow turns too",
        SearchRange(0.02, 20.0, is_log=True),
    ),
    FilterParameter(
        "c1",
        "",
        "attenuation of repeated steps: 0 switches it off",
        "Attenuation of the step while the rate keeps its sign. 0: no attenuation. Large: long runs count little.",
        "it needs long turns in one direction, and rests",
        SearchRange(0.0, 3.0),
    ),
    FilterParameter(
        "c2",
        "",
        "exponent of the attenuation",
        "Growth of the attenuation with the length of a run. Above 1: the correction by one run is bounded.",
        "it needs long turns in one direction, rests, and c1 above 0",
        SearchRange(0.0, 3.0),
    ),
)
"""The search ranges suit sensors with 0.01 to 10 deg/s of bias at 2 Hz to 10 kHz."""

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
    about="Published parameters, or those of --config. Integrates rate times step, as published.",
    color="six",
    dash="-",
)
