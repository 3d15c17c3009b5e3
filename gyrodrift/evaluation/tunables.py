"""What tuning knows of each filter: ranges, a compiled kernel, and what its parameters mean to a person."""

from collections.abc import Callable, Mapping
from dataclasses import astuple, dataclass, fields
from typing import Any

import numpy as np

from gyrodrift.arrays import Floats
from gyrodrift.evaluation.kernels import hdr as kernel
from gyrodrift.evaluation.kernels import restlevel as kernel_restlevel
from gyrodrift.evaluation.space import AXES, RESTLEVEL_AXES, Axis
from gyrodrift.filters.registry import HDR, RESTLEVEL, Filter
from gyrodrift.filters.restlevel.model import RestlevelParams


@dataclass(frozen=True, slots=True)
class Kernel:
    """The filter, compiled.

    prepare
        From a group of candidates, shape (c, k), to what they need on every course.
    sums
        From steps in s, rates in deg/s, reference in deg, candidates and what was prepared to the sums of
        `kernel.group_sums`, shape (3, c).
    yaw
        From steps, rates and one candidate to yaw in deg, shape (n,).
    """

    prepare: Callable[[Floats], Any]
    sums: Callable[[Floats, Floats, Floats, Floats, Any], Floats]
    yaw: Callable[[Floats, Floats, Floats], Floats]


@dataclass(frozen=True, slots=True)
class Meaning:
    """Of a parameter: its unit, a line for the config, a few sentences for the report, and what decides it."""

    unit: str
    line: str
    words: str
    takes: str


@dataclass(frozen=True, slots=True)
class Tunable:
    """A filter that can be tuned.

    nothing
        Parameters with which it learns nothing and filters nothing: plain integration.
    idle
        What parameters are while they are not searched.
    few, few_title
        Names of the parameters of a smaller search that the whole one is held against, and what it is called.
    note
        For the head of the config.
    """

    filter: Filter
    axes: tuple[Axis, ...]
    kernel: Kernel
    nothing: tuple[float, ...]
    idle: tuple[float, ...]
    few: tuple[str, ...]
    few_title: str
    note: str
    meanings: Mapping[str, Meaning]

    @property
    def names(self) -> tuple[str, ...]:
        """Of the parameters, in the order of a candidate's columns."""
        return tuple(field.name for field in fields(self.filter.params))

    def full(self, axes: tuple[Axis, ...], found: Floats) -> Floats:
        """Candidates with all their columns, from those of the axes that were searched."""
        whole = np.repeat([self.idle], len(found), axis=0)
        for number, axis in enumerate(axes):
            whole[:, self.names.index(axis.name)] = found[:, number]
        return whole

    def params(self, row: Floats) -> Any:
        """A candidate as the record of its filter."""
        return self.filter.params(*row.tolist())


EULER = (0.0, 0.0, 1.0, 0.0, 1.0)

HDR_TUNABLE = Tunable(
    filter=HDR,
    axes=AXES,
    kernel=Kernel(lambda lanes: kernel.unknown_steps(len(lanes)), kernel.group_sums, kernel.yaw),
    nothing=EULER,
    idle=EULER,
    few=("i_c_dps", "theta_w_dps"),
    few_title="two parameters",
    note="i_c_dps and the attenuator count samples: the numbers belong to sample_rate_hz.",
    meanings={
        "i_c_dps": Meaning(
            "deg/s per sample",
            "integrator step per sample, deg/s: larger learns faster and hunts more",
            "How far the drift estimate moves at each sample. Small: drift is learnt slowly. "
            "Large: the estimate hunts to and fro.",
            "it takes sessions with a drift to learn",
        ),
        "tau_s": Meaning(
            "s",
            "low-pass before the decision, s",
            "How long the rate is averaged before its sign is looked at. Small: the noise of single samples decides. "
            "Large: it decides late.",
            "it takes rests long enough for noise to matter, and turns that begin sharply",
        ),
        "theta_w_dps": Meaning(
            "deg/s",
            "nothing is learnt above this rate, deg/s; a bias above it is never learnt",
            "Turn switch: above this rate nothing is learnt. Small: learns only near rest, and a bias larger "
            "than this never. Large: slow turns pass for drift.",
            "it takes motion at all rates, slow turns too",
        ),
        "c1": Meaning(
            "",
            "attenuator of repeated steps: 0 switches it off",
            "How strongly the step shrinks while the rate keeps its sign. 0: not at all. "
            "Large: long runs count little.",
            "it takes long stretches of one direction as well as rests",
        ),
        "c2": Meaning(
            "",
            "its steepness",
            "How steeply it shrinks as the run gets longer. Small: hardly. Above 1: what one run can correct is "
            "bounded.",
            "it takes long stretches of one direction as well as rests, and a c1 above 0",
        ),
    },
)

RESTLEVEL_TUNABLE = Tunable(
    filter=RESTLEVEL,
    axes=RESTLEVEL_AXES,
    kernel=Kernel(
        lambda _lanes: None,
        lambda dt_s, rate_dps, reference_deg, lanes, _: kernel_restlevel.sums(dt_s, rate_dps, reference_deg, lanes),
        kernel_restlevel.yaw,
    ),
    nothing=astuple(RestlevelParams(still_start=0.0, rest_share=0.0)),
    idle=astuple(RestlevelParams()),
    few=("walk_dps_rts", "drift_dps_s"),
    few_title="its two speeds of drift",
    note="Nothing in them counts samples: they hold at any rate of this sensor.",
    meanings={
        "window_s": Meaning(
            "s",
            "length of the blocks that rest is looked for in, s",
            "How much of the rate is looked at together. Small: short stops are found. Large: noise averages out.",
            "it takes stops of all lengths",
        ),
        "quiet": Meaning(
            "",
            "how far above the sensor's noise a block may lie to be quiet, in standard errors",
            "Small: noisy rests are missed. Large: gentle motion passes for rest until its level gives it away.",
            "it takes rests of uneven noise, and gentle motion",
        ),
        "turn_on_dps": Meaning(
            "deg/s",
            "standard deviation of the bias at power-on, deg/s",
            "Small: a first level far from zero is taken for a spin. Large: a slow spin is taken for a bias.",
            "it takes sessions that begin in motion, each after a power-on of its own",
        ),
        "walk_dps_rts": Meaning(
            "deg/s/√s",
            "how fast the bias walks, deg/s/√s",
            "Small: rests are averaged for long. Large: every rest begins anew.",
            "it takes sessions longer than the bias takes to walk",
        ),
        "drift_dps_s": Meaning(
            "deg/s²",
            "the fastest that the bias drifts, deg/s²",
            "Small: a rest after a fast change is taken for a spin. Large: a slow change of a true rate is taken for "
            "drift.",
            "it takes a warm-up or a change of temperature, and gentle curves",
        ),
        "still_start": Meaning(
            "",
            "probability that the device stands still when its first sample comes",
            "Near 1: a level from the first sample on is a bias. Small: it is a spin until the rate comes back to it.",
            "it takes sessions that begin at rest and sessions that begin in motion",
        ),
        "rest_share": Meaning(
            "",
            "probability that a later constant level is a rest",
            "Small: a level has to come back before it is believed. Large: the first one is.",
            "it takes constant turns as well as rests",
        ),
        "scale_percent": Meaning(
            "%",
            "standard deviation of the scale factor, %: for yaw_sigma_deg alone",
            "It changes nothing but how certain yaw is said to be.",
            "yaw does not depend on it",
        ),
    },
)

TUNABLES: Mapping[str, Tunable] = {each.filter.name: each for each in (HDR_TUNABLE, RESTLEVEL_TUNABLE)}
