"""A format of another simulator: the text of its files, and what it cannot express."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import pi

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import EffectSlot
from gyrodrift.diagnose.export.exported import Exported, ExportedEffect
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.report.numbers import significant

RAD = pi / 180.0
"""Radians per degree. By definition."""

RESTRICTIONS = {
    EffectSlot.ENCODER: "it changes the angle of the encoder, not the rate",
    EffectSlot.COUNTS: "it changes the angle of the encoder, not the rate",
    EffectSlot.CLOCK: "it changes the time stamps, not the rate",
    EffectSlot.ARRIVAL: "it changes when samples arrive, not the rate",
}
"""Reasons why an effect is not part of a model of the rate, by its slot."""


@dataclass(frozen=True, slots=True)
class FormatExport:
    """Files of one format.

    files
        Text by file name.
    expressed
        Effects that the files contain.
    not_expressed
        Effects that they do not contain, with the reason.
    """

    format: str
    files: Mapping[str, str]
    expressed: tuple[str, ...]
    not_expressed: Mapping[str, str]


Express = Callable[[Exported], FormatExport]


def off_the_rate(effects: Sequence[ExportedEffect]) -> dict[str, str]:
    """Effects that no model of a gyro can express, with the reason."""
    slots = {effect.name: CATALOGUE[effect.name].slot for effect in effects}
    return {name: RESTRICTIONS[slot] for name, slot in slots.items() if slot in RESTRICTIONS}


def comment_lines(exported: Exported, not_expressed: Mapping[str, str]) -> list[str]:
    """Verdict, effects with size and probability, and what is missing, for the comment of a file."""
    lines = [f"gyrodrift diagnose: {exported.says}"]
    if not exported.effects:
        lines.append("No effect is diagnosed, so none is exported; noise, bias and sample rate are measured.")
    lines += [effect_words(effect) for effect in exported.effects]
    lines += [f"NOT in this file: {name}: {why}." for name, why in not_expressed.items()]
    return [line.replace("--", "- -") for line in lines]  # a comment of XML holds no two hyphens


def effect_words(effect: ExportedEffect) -> str:
    """An effect with its parameters, intervals and probability in one line."""
    sizes = ", ".join(_size_words(name, value, effect) for name, value in effect.parameters.items())
    tied = f", or instead {' or '.join(effect.tied_with)}" if effect.tied_with else ""
    has = ""
    if effect.in_simulator is not None:
        sizes_now = ", ".join(f"{name} {value:.4g}" for name, value in effect.in_simulator.items())
        has = f"; the simulator already has {sizes_now}"
    return f"{effect.name}: {sizes}, probability {effect.probability:.2f}{tied}{has}"


def _size_words(name: str, value: float, effect: ExportedEffect) -> str:
    between = ""
    if name in effect.intervals:
        low, high = effect.intervals[name]
        between = f" ({significant(low, 4)} to {significant(high, 4)})"
    return f"{name} {significant(value, 4)}{f' {unit}' if (unit := unit_of(name)) else ''}{between}"
