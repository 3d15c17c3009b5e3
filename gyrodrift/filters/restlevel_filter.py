"""Restlevel as everything else knows it: records and step, what its parameters mean, and where they are searched."""

from gyrodrift.filters.filter import Filter, FilterMemory, FilterParameter, ReducedModel, SearchRange
from gyrodrift.filters.restlevel import memory
from gyrodrift.filters.restlevel.model import RestlevelParams, RestlevelState
from gyrodrift.filters.restlevel.step import coefficients, step
from gyrodrift.filters.restlevel.zero import scale_sigma_deg, with_scale_sigma, zero_yaw

PARAMETERS = (
    FilterParameter(
        "window_s",
        "s",
        "length of the blocks that rest is looked for in, s",
        "How much of the rate is looked at together. Small: short stops are found. Large: noise averages out.",
        "it takes stops of all lengths",
        SearchRange(0.05, 5.0, is_log=True),
    ),
    FilterParameter(
        "quiet",
        "",
        "how far above the sensor's noise a block may lie to be quiet, in standard errors",
        "Small: noisy rests are missed. Large: gentle motion passes for rest until its level gives it away.",
        "it takes rests of uneven noise, and gentle motion",
        SearchRange(1.0, 50.0, is_log=True),
    ),
    FilterParameter(
        "turn_on_dps",
        "deg/s",
        "standard deviation of the bias at power-on (0: the sensor takes it out itself), deg/s",
        "Small: a first level far from zero is taken for a spin. Large: a slow spin is taken for a bias.",
        "it takes sessions that begin in motion, each after a power-on of its own",
        SearchRange(0.02, 20.0, is_log=True),
    ),
    FilterParameter(
        "walk_dps_rts",
        "deg/s/√s",
        "how fast the bias walks, deg/s/√s",
        "Small: rests are averaged for long. Large: every rest begins anew.",
        "it takes sessions longer than the bias takes to walk",
        SearchRange(1e-6, 0.1, is_log=True),
    ),
    FilterParameter(
        "drift_dps_s",
        "deg/s²",
        "the fastest that the bias drifts, deg/s²",
        "Small: a rest after a fast change is taken for a spin. Large: a slow change of a true rate is taken for "
        "drift.",
        "it takes a warm-up or a change of temperature, and gentle curves",
        SearchRange(1e-4, 0.3, is_log=True),
    ),
    FilterParameter(
        "still_start",
        "",
        "probability that the device stands still when its first sample comes",
        "Near 1: a level from the first sample on is a bias. Small: it is a spin until the rate comes back to it.",
        "it takes sessions that begin at rest and sessions that begin in motion",
        SearchRange(0.0, 0.9999),
    ),
    FilterParameter(
        "rest_share",
        "",
        "probability that a later constant level is a rest",
        "Small: a level has to come back before it is believed. Large: the first one is.",
        "it takes constant turns as well as rests",
        SearchRange(0.001, 0.9, is_log=True),
    ),
    FilterParameter(
        "scale_percent",
        "%",
        "standard deviation of the scale factor, %: for yaw_sigma_deg alone",
        "It changes nothing but how certain yaw is said to be.",
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
    colour="tuned",
    dash="-",
    sees_beside=True,
    memory=FilterMemory(memory.learned, memory.begun, memory.knowledge),
    zero=zero_yaw,
    with_scale_sigma=with_scale_sigma,
    scale_sigma_deg=scale_sigma_deg,
)
