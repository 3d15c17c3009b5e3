"""A rig file as text, and an effect in the words of a rig file, which has the forms of the simulator."""

from collections.abc import Iterable, Mapping

from gyrogap.physics.kinds import InjectedEffect

NOT_IN_A_RIG = ("curve_dps_per_c2", "dwell_shape", "fast_s", "fast_share")
"""Parameters of this generator that a rig does not have."""

IN_A_RIG = {"slow_s": "time_constant_s"}

Number = float | int | bool


def rig_text(
    base: Mapping[str, Number], effects: Iterable[InjectedEffect] = (), three_axes: Mapping[str, Number] | None = None
) -> str:
    """The file."""
    lines = ["base:", *(f"  {name}: {_number(value)}" for name, value in base.items())]
    if three_axes is not None:
        lines += ["  three_axes:", *(f"    {name}: {_number(value)}" for name, value in three_axes.items())]
    listed = [f"  - {{name: {fault.name}, {_pairs(rig_form(fault))}}}" for fault in effects]
    return "\n".join([*lines, "effects:", *listed] if listed else [*lines, "effects: []"]) + "\n"


def rig_form(fault: InjectedEffect) -> dict[str, float]:
    """Parameters of an effect as a rig states them."""
    return {IN_A_RIG.get(name, name): value for name, value in fault.parameters.items() if name not in NOT_IN_A_RIG}


def _pairs(parameters: Mapping[str, float]) -> str:
    return ", ".join(f"{name}: {_number(value)}" for name, value in parameters.items())


def _number(value: Number) -> str:
    """YAML takes 1e-05 for a word, so that small ones are written out."""
    if isinstance(value, bool):
        return str(value).lower()
    return format(value, ".12f") if isinstance(value, float) and "e" in repr(value) else str(value)
