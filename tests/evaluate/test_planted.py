"""Flaws planted into recordings: each changes its column as it says."""

import numpy as np
import pytest
from blind.rows.recordings import Rows
from evaluate.planted import CASES, PlantedFlaw, planted
from evaluate.planted_part import names_flaw, sure_and_wrong, ties_flaw

from gyrodrift.diagnose.simulate.candidates import KINDS


def rows() -> Rows:
    t_s = np.arange(1000, dtype=np.float64) * 0.01
    rate_dps = 150.0 * np.sin(t_s)
    return Rows({"t_device_s": t_s, "rate_dps": rate_dps, "encoder_deg": np.cumsum(rate_dps) * 0.01})


@pytest.mark.parametrize("flaw", CASES, ids=lambda flaw: flaw.name)
def test_a_flaw_is_there_and_is_the_same_again(flaw: PlantedFlaw) -> None:
    flawed, again = (planted(flaw, rows(), 0) for _ in range(2))
    assert flawed.text() == again.text()
    assert (flawed.text() == rows().text()) is not bool(flaw.effects)
    assert set(flaw.effects) <= KINDS.keys()


def test_a_delay_is_a_number_of_samples() -> None:
    flaw = next(flaw for flaw in CASES if flaw.name == "delay of 3 samples")
    delayed = planted(flaw, rows(), 0).columns["rate_dps"]
    assert delayed[10:] == pytest.approx(rows().columns["rate_dps"][7:-3])


def test_a_verdict_is_right_by_the_group_of_the_flaw() -> None:
    flaw = next(flaw for flaw in CASES if flaw.name == "delay of 4 samples")
    causes = [{"effect": "bandwidth", "probability": 0.9, "tied_with": ["latency"]}]
    gap = {"causes": causes, "negligible": []}
    assert names_flaw(flaw, gap)
    assert ties_flaw(flaw, gap)
    assert not sure_and_wrong(flaw, gap)
    assert sure_and_wrong(flaw, {"causes": [{"effect": "popcorn", "probability": 0.9}]}) == ["popcorn"]
