"""Restlevel as a filter of the registry: records, step, and the meaning and search range of each parameter."""

from gyrodrift.filters.filter import Filter, FilterMemory, FilterParameter, ReducedModel, SearchRange
from gyrodrift.filters.restlevel import aided, memory
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.restlevel.zero import scale_sigma_deg, with_scale_sigma, zero_yaw

PARAMETERS = (
    FilterParameter(
        "window_s",
        "s",
        "length of the blocks tested for rest, s",
        "Length of the blocks tested for rest. Small: finds short stops. Large: averages more noise.",
        "it needs stops of all lengths",
        SearchRange(0.05, 5.0, is_log=True),
    ),
    FilterParameter(
        "quiet",
        "",
        "variance of a block above the noise up to which it is quiet, in standard errors",
        "Small: misses noisy rests. Large: takes slow motion for rest until its mean rate contradicts.",
        "it needs rests with uneven noise, and slow motion",
        SearchRange(1.0, 50.0, is_log=True),
    ),
    FilterParameter(
        "turn_on_dps",
        "deg/s",
        "standard deviation of the bias at power-on, deg/s (0: the sensor subtracts it)",
        "Small: takes a first constant rate far from 0 for a turn. Large: takes a slow constant turn for a bias.",
        "it needs sessions that begin in motion after separate power-ons",
        SearchRange(0.02, 20.0, is_log=True),
    ),
    FilterParameter(
        "walk_dps_rts",
        "deg/s/√s",
        "random walk of the bias, deg/s/√s",
        "Small: averages over long rests. Large: each rest replaces the estimate.",
        "it needs sessions long enough for the bias to walk",
        SearchRange(1e-6, 0.1, is_log=True),
    ),
    FilterParameter(
        "drift_dps_s",
        "deg/s²",
        "fastest drift of the bias, deg/s²",
        "Small: takes a rest after a fast change for a turn. Large: takes a slow change of the true rate for drift.",
        "it needs a warm-up or a change of temperature, and slow turns",
        SearchRange(1e-4, 0.3, is_log=True),
    ),
    FilterParameter(
        "still_start",
        "",
        "probability of rest at the first sample",
        "Near 1: takes a constant rate from the first sample on for a bias. Small: waits until the rate returns to it.",
        "it needs sessions that begin at rest and sessions that begin in motion",
        SearchRange(0.0, 0.9999),
    ),
    FilterParameter(
        "rest_share",
        "",
        "probability that a later constant rate is a rest",
        "Small: a constant rate counts as bias when it returns. Large: it counts at once.",
        "it needs constant turns and rests",
        SearchRange(0.001, 0.9, is_log=True),
    ),
    FilterParameter(
        "scale_percent",
        "%",
        "standard deviation of the scale factor, %; changes only yaw_sigma_deg",
        "It changes only the uncertainty of yaw.",
        "yaw does not depend on it",
    ),
)

RESTLEVEL = Filter(
    name="restlevel",
    params=RestlevelParams,
    coefficients=coefficients,
    state=RestlevelState,
    step=step,
    columns=("bias_dps", "bias_sigma_dps", "rest_probability", "confidence", "yaw_deg", "yaw_sigma_deg"),
    parameters=PARAMETERS,
    baseline=RestlevelParams(still_start=0.0, rest_share=0.0),
    reduced=ReducedModel(("walk_dps_rts", "drift_dps_s"), "its two speeds of drift"),
    kernel="gyrodrift.evaluation.kernels.restlevel:KERNEL",
    title="restlevel",
    color="tuned",
    dash="-",
    uses_auxiliary=True,
    memory=FilterMemory(memory.learned, memory.begun, memory.knowledge, memory.count_axes),
    aided=aided.AIDED,
    zero=zero_yaw,
    with_scale_sigma=with_scale_sigma,
    scale_sigma_deg=scale_sigma_deg,
)
