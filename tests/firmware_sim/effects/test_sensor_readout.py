"""Between measurement and register: wild samples and repeated ones, counted in a thousand seconds with noise."""

import numpy as np
import pytest
from effects_bench import Record, profile_of, put_in, record, rig_of, share_bound, sized
from numpy.typing import NDArray

from firmware_sim.effects.effect import Effect
from firmware_sim.effects.sensor_readout import StaleHold

SWING = profile_of({"kind": "sine", "seconds": 1000.0, "amplitude_dps": 100.0, "frequency_hz": 1.0})
SAMPLES = 100_000


def swung(effect: Effect | None) -> Record:
    return record(rig_of(effect), SWING, SAMPLES / 100.0)


@sized("spikes")
def test_spikes_have_their_height_and_their_share(effect: Effect | None) -> None:
    error_dps = swung(effect).error_dps
    off_dps = (error_dps - np.median(error_dps))[np.abs(error_dps) > 2.0]
    share = put_in(effect, "share_percent") / 100.0
    assert abs(off_dps.size / SAMPLES - share) <= share_bound(share, SAMPLES)
    for side in (1.0, -1.0) if effect else ():
        same = off_dps[np.sign(off_dps) == side]
        assert np.median(same) == pytest.approx(side * put_in(effect, "height_dps"), abs=0.02)
        assert abs(same.size / off_dps.size - 0.5) <= share_bound(0.5, off_dps.size)


def stale(run: Record) -> NDArray[np.bool_]:
    """Samples that repeat the one before, although the table moved on by over 1 deg/s (14 times the noise)."""
    moved = np.abs(np.diff(run.true_dps)) > 1.0
    repeated: NDArray[np.bool_] = np.diff(run.rate_dps) == 0.0
    return repeated[moved]


@sized("stale_hold")
def test_a_share_of_the_samples_repeats_the_one_before(effect: Effect | None) -> None:
    """Equal while the table moves on; none without the effect."""
    result = stale(swung(effect))
    share = put_in(effect, "share_percent") / 100.0
    assert abs(result.mean() - share) <= share_bound(share, result.size)


def test_stale_samples_come_in_rows_by_chance() -> None:
    result = stale(swung(StaleHold(share_percent=50.0)))
    assert result[1:][result[:-1]].mean() == pytest.approx(0.5, abs=0.02)
