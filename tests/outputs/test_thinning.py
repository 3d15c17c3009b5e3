"""At most so many samples a second, whatever the device's clock does."""

from collections.abc import Sequence

from outputs_support import corrected

from gyrodrift.outputs.thinning import Thinning


def kept(thinning: Thinning, seqs: Sequence[int]) -> list[int]:
    return [item.sample.seq for item in thinning.due([corrected(seq=seq) for seq in seqs])]


def test_every_fourth_of_100_hz_is_25_hz_over_batches() -> None:
    thinning = Thinning(25.0)
    assert kept(thinning, range(10)) + kept(thinning, range(10, 20)) == [0, 4, 8, 12, 16]


def test_a_rate_that_divides_no_other_is_kept_over_time() -> None:
    assert len(kept(Thinning(30.0), range(1000))) == 300


def test_a_hole_is_not_made_up_for() -> None:
    assert kept(Thinning(25.0), [0, 1, 50, 51, 52, 53, 54]) == [0, 50, 54]


def test_a_clock_that_begins_again_is_not_waited_for() -> None:
    assert kept(Thinning(25.0), [500, 501, 0, 1, 2, 3, 4]) == [500, 0, 4]
