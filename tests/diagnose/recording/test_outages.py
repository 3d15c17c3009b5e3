"""Stretches of a session without rates or angles."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.arrays import Integers, Mask
from gyrodrift.diagnose.recording.outages import between_outages
from gyrodrift.session.session import Session

HZ, SECONDS = 50.0, 120.0


def session_of(number: Integers, *, counter: bool = True) -> Session:
    """Samples of these numbers, of a clock that began a while ago."""
    t_s = 7.0 + number / HZ
    seq = number if counter else None
    return Session("bench", t_s, np.sin(t_s), t_host_s=t_s + 0.002, seq=seq, encoder_deg=5.0 * t_s)


def with_angles_at(session: Session, is_there: Mask) -> Session:
    """Elsewhere the reference says nothing."""
    assert session.encoder_deg is not None
    return replace(session, encoder_deg=np.where(is_there, session.encoder_deg, np.nan))


def whole() -> Integers:
    return np.arange(round(SECONDS * HZ))


def without(begin_s: float, end_s: float) -> Integers:
    number = whole()
    return number[(number < begin_s * HZ) | (number >= end_s * HZ)]


@pytest.mark.parametrize("counter", [True, False])
@given(begin_s=st.floats(0.5, 100.0), lasts_s=st.floats(0.5, 15.0), what=st.sampled_from(["row", "rate", "angle"]))
def test_what_lies_between_outages_is_kept_to_the_sample(
    begin_s: float, lasts_s: float, what: str, *, counter: bool
) -> None:
    """Whether rows do not come, or come without a rate or without an angle; what is shorter than 20 s is left out."""
    there = without(begin_s, begin_s + lasts_s)
    session = session_of(there if what == "row" else whole(), counter=counter)
    is_missing = ~np.isin(whole(), there)
    if what == "rate":
        session = replace(session, rate_dps=np.where(is_missing, np.nan, session.rate_dps))
    elif what == "angle":
        session = with_angles_at(session, ~is_missing)
    found = between_outages(session)
    break_at = int(np.searchsorted(there, begin_s * HZ))
    expected = [part for part in (there[:break_at], there[break_at:]) if len(part) >= 20.0 * HZ]
    assert [len(part.t_device_s) for part in found.sessions] == [len(part) for part in expected]
    for part, numbers in zip(found.sessions, expected, strict=True):
        np.testing.assert_allclose(part.t_device_s, 7.0 + numbers / HZ)
        assert part.encoder_deg is not None
        assert np.isfinite(part.rate_dps).all()
        assert np.isfinite(part.encoder_deg).all()
    (remark,) = found.remarks
    assert f"are missing for {len(whole()) / HZ - len(there) / HZ:.1f} s" in remark
    left_out = len(there) - sum(map(len, expected))
    assert (f"without {left_out / HZ:.1f} s in parts of less than 20 s" in remark) == (left_out > 0)


def test_parts_have_names_of_their_own_and_the_rest_alone_keeps_its_own() -> None:
    """A part that stands alone is the session."""
    two = between_outages(session_of(without(50.0, 52.0)))
    assert [part.name for part in two.sessions] == ["bench, part 1", "bench, part 2"]
    one = between_outages(session_of(without(5.0, 7.0)))
    assert [part.name for part in one.sessions] == ["bench"]
    (remark,) = one.remarks
    assert remark.startswith("bench: rates or angles are missing for 2.0 s; the rest is one session, without 5.0 s")


def test_an_encoder_that_comes_late_or_goes_early_cuts_the_ends() -> None:
    """Held at its first value it would rest while the gyro turns."""
    session = session_of(whole())
    at_s = whole() / HZ
    found = between_outages(with_angles_at(session, (at_s >= 30.0) & (at_s < 100.0)))
    (part,) = found.sessions
    assert (part.t_device_s[0], part.t_device_s[-1]) == pytest.approx((37.0, 106.98))
    assert "missing for 50.0 s in 2 pieces" in found.remarks[0]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.0, 0.01, 0.2])
def test_samples_that_a_link_loses_one_by_one_are_no_outage(share: float, seed: int) -> None:
    """That is an effect, and there to be seen."""
    session = session_of(whole()[np.random.default_rng(seed).random(len(whole())) >= share])
    assert between_outages(session).sessions == (session,)


def test_a_reference_that_is_slower_than_the_gyro_is_no_outage() -> None:
    """An angle with every thirteenth sample."""
    session = with_angles_at(session_of(whole()), whole() % 13 == 0)
    assert between_outages(session).sessions == (session,)


def test_a_link_that_fails_all_the_time_leaves_the_session_as_it_is() -> None:
    """A second of every ten: no part is long enough, and what the link does is what there is to be seen."""
    session = session_of(whole()[whole() % 500 >= 50])
    found = between_outages(session)
    assert found.sessions == (session,)
    assert not found.remarks
