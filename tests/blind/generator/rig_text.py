"""A rig file as text, and an effect in the words of a rig file, which has the forms of the simulator."""

from collections.abc import Iterable, Mapping

from blind.generator.kinds import Fault

NOT_IN_A_RIG = ("curve_dps_per_c2", "dwell_shape", "fast_s", "fast_share")
"""What the forms of this generator have beyond those of a rig."""

IN_A_RIG = {"slow_s": "time_constant_s"}

Number = float | int | bool


def rig_text(base: Mapping[str, Number], effects: Iterable[Fault] = ()) -> str:
    """The file."""
    lines = ["base:", *(f"  {name}: {_number(value)}" for name, value in base.items())]
    listed = [f"  - {{name: {fault.name}, {_pairs(rig_form(fault))}}}" for fault in effects]
    return "\n".join([*lines, "effects:", *listed] if listed else [*lines, "effects: []"]) + "\n"


def rig_form(fault: Fault) -> dict[str, float]:
    """Parameters of an effect as a rig states them."""
    return {IN_A_RIG.get(name, name): value for name, value in fault.parameters.items() if name not in NOT_IN_A_RIG}


def _pairs(parameters: Mapping[str, float]) -> str:
    return ", ".join(f"{name}: {_number(value)}" for name, value in parameters.items())


def _number(value: Number) -> str:
    """YAML takes 1e-05 for a word, so that small ones are written out."""
    if isinstance(value, bool):
        return str(value).lower()
    return format(value, ".12f") if isinstance(value, float) and "e" in repr(value) else str(value)
