"""Sentences about the results of six positions and turns."""

from collections.abc import Iterable, Iterator

from gyrodrift.calibrate.positions.accelerometer import AccelerometerFit
from gyrodrift.calibrate.positions.matrix import MatrixFit
from gyrodrift.calibrate.positions.sides import AXES


def instructions(turns: int, rest_s: float, *, has_turns: bool, is_by_hand: bool) -> Iterator[str]:
    """Instructions, a sentence each."""
    yield (
        f"Lay the board down on each of its six sides, in any order, and let go for {rest_s + 1.0:.0f} s. A side may "
        "be askew: lean the board against a book."
    )
    if has_turns:
        yield (
            f"Once with x, once with y and once with z upright, also turn it {turns_text(turns)} on the table, stop at "
            "a mark, and turn it back."
        )
    if is_by_hand:
        yield "u removes the last measurement, q ends the calibration."


def turns_text(turns: int) -> str:
    """Words for a number of turns."""
    return "one whole turn" if turns == 1 else f"{turns} whole turns"


def accelerometer_sentences(fit: AccelerometerFit) -> Iterator[str]:
    """Offset and scale with their standard errors."""
    yield f"  accelerometer offset {_entries(fit.offset_mps2, fit.offset_se_mps2, AXES, '.3f')} m/s²"
    yield f"  accelerometer scale {_entries(fit.scale, fit.scale_se, AXES, '.4f')}"


def matrix_sentences(fit: MatrixFit) -> Iterator[str]:
    """Matrix with its standard errors, and the stops at the mark."""
    for axis, row, errors in zip(AXES, fit.matrix, fit.matrix_se, strict=True):
        yield f"  gyro {axis} = {_entries(row, errors, AXES, '.4f')}"
    yield f"  stops at the mark ± {fit.mark_deg:.2f} deg"


def _entries(values: Iterable[float], errors: Iterable[float], names: str, form: str) -> str:
    return ", ".join(
        f"{name} {value:+{form}} ± {error:{form}}" for name, value, error in zip(names, values, errors, strict=True)
    )
