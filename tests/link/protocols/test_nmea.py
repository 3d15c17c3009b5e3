"""NMEA 0183 rate of turn: the example of its description, and what a library of others writes."""

import golden_frames as golden
import pytest
from pynmeagps import GET, NMEAMessage

from gyrodrift.link.protocols.nmea import NmeaDecoder


def test_the_golden_sentence_is_read() -> None:
    (reading,) = NmeaDecoder().push(golden.NMEA_ROT)
    assert (reading.t_us, reading.seq) == (None, None)
    assert reading.rate_dps == pytest.approx(-35.6 / 60.0)


@pytest.mark.parametrize(("talker", "per_minute", "rate_dps"), [("HE", -720.0, 12.0), ("TI", 0.5, -1 / 120)])
def test_sentences_of_a_library_are_read(talker: str, per_minute: float, rate_dps: float) -> None:
    sent = NMEAMessage(talker, "ROT", GET, rot=per_minute, valid="A").serialize()
    (reading,) = NmeaDecoder().push(sent)
    assert reading.rate_dps == pytest.approx(rate_dps)


def test_a_rate_that_is_not_valid_is_no_rate() -> None:
    """Status V, and a rate that is left out; both are good sentences."""
    decoder = NmeaDecoder()
    not_valid = NMEAMessage("HE", "ROT", GET, rot=0.0, valid="V").serialize()
    assert decoder.push(not_valid + b"$HEROT,,A*05\r\n") == []
    assert (decoder.counters.frames, decoder.counters.other_frames, decoder.counters.damaged) == (2, 2, 0)


def test_a_receiver_without_rate_of_turn_is_not_of_this_protocol() -> None:
    """Positions alone make nothing sure; beside rates they are passed over."""
    decoder = NmeaDecoder()
    position = NMEAMessage("GP", "GLL", GET, lat=43.2, NS="N", lon=2.3, EW="W", status="A").serialize()
    decoder.push(position * 9)
    assert decoder.counters.frames == 0
    assert len(decoder.push((golden.NMEA_ROT + position) * 3)) == 3
    assert (decoder.counters.frames, decoder.counters.other_frames, decoder.counters.damaged) == (6, 3, 0)


@pytest.mark.parametrize("line", [b"$GPROT,35.6,A*02", b"$GPROT,35.6,A", b"GPROT,35.6,A*01", b"$GPROT,35.6,A*1"])
def test_a_sentence_needs_its_checksum(line: bytes) -> None:
    decoder = NmeaDecoder()
    assert decoder.push(line + b"\r\n") == []
    assert decoder.counters.damaged == 1


def test_one_of_two_talkers_is_listened_to_and_the_other_is_named() -> None:
    """Together they would be half a turn."""
    decoder = NmeaDecoder()
    gyro, compass = (
        NMEAMessage(name, "ROT", GET, rot=rot, valid="A").serialize() for name, rot in (("TI", -600.0), ("GP", 0.0))
    )
    readings = decoder.push((gyro + compass) * 5)
    assert [reading.rate_dps for reading in readings] == [10.0] * 5
    assert decoder.counters.passed_over == {"GPROT"}
