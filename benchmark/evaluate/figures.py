"""Figures over random cases: a share or a mean, each with its 95 % interval."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from gyrogap.chance import wilson

RESAMPLES = 2000
"""Of a bootstrap: percentiles ask for a thousand or more (Efron & Tibshirani 1993, ch. 13)."""


@dataclass(frozen=True, slots=True)
class Figure:
    """One row of the table.

    name
        What was measured, with its unit.
    value, low, high
        The share or the mean, and its 95 % interval.
    count
        Number of cases.
    is_share
        Whether the value is a share of the cases.
    is_less_better
        Whether a smaller value is the better one.
    """

    name: str
    value: float
    low: float
    high: float
    count: int
    is_share: bool
    is_less_better: bool


def share_figure(name: str, hits: int, total: int, *, is_less_better: bool = False) -> Figure:
    """Share of cases with Wilson's interval."""
    low, high = wilson(hits, total)
    return Figure(
        name, _short(hits / total), _short(low), _short(high), total, is_share=True, is_less_better=is_less_better
    )


def mean_figure(name: str, values: Sequence[float]) -> Figure:
    """Mean of an error, of which less is better, with the percentile interval of a bootstrap."""
    cases = np.asarray(values)
    drawn = np.random.default_rng(0).integers(0, len(cases), (RESAMPLES, len(cases)))
    low, high = np.percentile(cases[drawn].mean(axis=1), [2.5, 97.5])
    return Figure(
        name, _short(cases.mean()), _short(low), _short(high), len(cases), is_share=False, is_less_better=True
    )


def _short(value: float) -> float:
    return float(f"{value:.4g}")
