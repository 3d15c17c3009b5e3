"""Stretches of a session without rates or angles."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.diagnose.recording.checked import between_outages
from gyrodrift.session.session import Session
from gyrodrift.values.arrays import Integers, Mask

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
    there = without(begin_s, begin_s + lasts_s)
    session = session_of(there if what == "row" else whole(), counter=counter)
    is_missing = ~np.isin(whole(), there)
    if what == "rate":
        session = replace(session, rate_dps=np.where(is_missing, np.nan, session.rate_dps))
    elif what == "angle":
        session = with_angles_at(session, ~is_missing)
    result = between_outages(session)
    break_at = int(np.searchsorted(there, begin_s * HZ))
    expected = [part for part in (there[:break_at], there[break_at:]) if len(part) >= 20.0 * HZ]
    assert [len(part.t_device_s) for part in result.sessions] == [len(part) for part in expected]
    for part, numbers in zip(result.sessions, expected, strict=True):
        np.testing.assert_allclose(part.t_device_s, 7.0 + numbers / HZ)
        assert part.encoder_deg is not None
        assert np.isfinite(part.rate_dps).all()
        assert np.isfinite(part.encoder_deg).all()
    (remark,) = result.remarks
    assert f"are missing for {len(whole()) / HZ - len(there) / HZ:.1f} s" in remark
    left_out = len(there) - sum(map(len, expected))
    assert (f"without {left_out / HZ:.1f} s in parts of less than 20 s" in remark) == (left_out > 0)


def test_parts_have_names_of_their_own_and_the_rest_alone_keeps_its_own() -> None:
    """A part that stands alone is the session."""
    two = between_outages(session_of(without(50.0, 52.0)))
    assert [part.name for part in two.sessions] == ["bench, part 1", "bench, part 2"]
    item = between_outages(session_of(without(5.0, 7.0)))
    assert [part.name for part in item.sessions] == ["bench"]
    (remark,) = item.remarks
    assert remark.startswith("bench: rates or angles are missing for 2.0 s; the rest is one session, without 5.0 s")


def test_an_encoder_that_comes_late_or_goes_early_cuts_the_ends() -> None:
    """Held at its first value it would rest while the gyro turns."""
    session = session_of(whole())
    at_s = whole() / HZ
    result = between_outages(with_angles_at(session, (at_s >= 30.0) & (at_s < 100.0)))
    (part,) = result.sessions
    assert (part.t_device_s[0], part.t_device_s[-1]) == pytest.approx((37.0, 106.98))
    assert "missing for 50.0 s in 2 pieces" in result.remarks[0]


@pytest.mark.parametrize("seed", range(5))
@pytest.mark.parametrize("share", [0.0, 0.01, 0.2])
def test_samples_that_a_link_loses_one_by_one_are_no_outage(share: float, seed: int) -> None:
    session = session_of(whole()[np.random.default_rng(seed).random(len(whole())) >= share])
    assert between_outages(session).sessions == (session,)


def test_a_reference_that_is_slower_than_the_gyro_is_no_outage() -> None:
    """An angle with every thirteenth sample."""
    session = with_angles_at(session_of(whole()), whole() % 13 == 0)
    assert between_outages(session).sessions == (session,)


def test_a_link_that_fails_all_the_time_leaves_the_session_as_it_is() -> None:
    """A second of every ten: no part is long enough, and what the link does is what there is to be seen."""
    session = session_of(whole()[whole() % 500 >= 50])
    result = between_outages(session)
    assert result.sessions == (session,)
    assert not result.remarks


@pytest.mark.parametrize("has_host", [True, False])
@pytest.mark.parametrize("counter", [True, False])
def test_a_device_that_began_anew_begins_another_session(*, counter: bool, has_host: bool) -> None:
    number, again = whole(), 2500
    session = session_of(number)
    session = replace(
        session,
        t_device_s=np.where(number < again, number, number - again) / HZ,
        seq=np.where(number < again, number, number - again) if counter else None,
        t_host_s=session.t_host_s if has_host else None,
    )
    result = between_outages(session)
    assert [len(part.t_device_s) for part in result.sessions] == [again, len(number) - again]
    assert [part.t_device_s[0] for part in result.sessions] == [0.0, 0.0]
    assert result.remarks == (
        "bench: the device restarted, or a clock was set; the 2 parts of the rest are taken as sessions",
    )


@pytest.mark.parametrize("later_s", [2.5, -3600.0])
def test_a_device_that_was_gone_or_a_host_clock_that_was_set_parts_a_session(later_s: float) -> None:
    """A recorder has the device's clock go on; only arrivals tell that it was gone, and turned on meanwhile."""
    session = session_of(whole())
    assert session.t_host_s is not None
    later = np.where(whole() < 3000, 0.0, later_s)
    result = between_outages(replace(session, t_host_s=session.t_host_s + later))
    assert [len(part.t_device_s) for part in result.sessions] == [3000, len(whole()) - 3000]


def test_a_host_that_was_busy_for_three_seconds_parts_nothing() -> None:
    session = session_of(whole())
    assert session.t_host_s is not None
    waits = (whole() >= 3000) & (whole() < 3150)
    busy = replace(session, t_host_s=np.where(waits, session.t_host_s[3150], session.t_host_s))
    assert between_outages(busy).sessions == (busy,)


def test_an_outage_and_a_new_beginning_are_told_together() -> None:
    number = without(30.0, 32.0)
    session = session_of(number)
    result = between_outages(replace(session, t_device_s=session.t_device_s - np.where(number < 5500, 0.0, 60.0)))
    assert len(result.sessions) == 2
    remark = result.remarks[0]
    assert "missing for 2.0 s, and the device restarted, or a clock was set; the 2 parts" in remark
    assert remark.endswith("without 10.0 s in parts of less than 20 s")


def test_what_has_no_encoder_or_no_rest_to_speak_of_stays_as_it_is() -> None:
    session = session_of(whole())
    torn = replace(session, t_device_s=np.where(whole() < 3000, session.t_device_s, session.t_device_s - 60.0))
    for item in (
        replace(torn, encoder_deg=None),
        replace(torn, encoder_deg=np.full(len(whole()), np.nan)),
        torn.part(2500, 3500),
    ):
        assert between_outages(item).sessions == (item,)
