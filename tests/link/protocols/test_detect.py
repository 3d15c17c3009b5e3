"""Detection of the protocol from the bytes, without a loss."""

from random import Random

import pytest

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Rig
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.registry import AUTO, PROTOCOLS, candidates
from gyrodrift.values.errors import UsageError

RIG = Rig()


def spoken(protocol: str, count: int) -> list[bytes]:
    frames = ENCODERS[protocol].frames(measure(RIG, load_profile("turntable"), 1), RIG.base)
    return [next(frames).content for _ in range(count)]


@pytest.mark.parametrize("protocol", [name for name in ENCODERS if PROTOCOLS[name].is_detected])
@pytest.mark.parametrize("start", [0, 7, 33])
def test_a_protocol_is_found_wherever_the_reader_joins(protocol: str, start: int) -> None:
    stream = b"".join(spoken(protocol, 40))[start:]
    detector = Detector(candidates(AUTO))
    for end in range(1, len(stream)):
        result = detector.push(stream[end - 1 : end])
        if result is not None:
            break
    assert result is not None
    decoder, readings = result
    assert decoder.name == protocol
    rest = decoder.push(stream[end:])
    assert [repr(r) for r in readings + rest] == [repr(r) for r in PROTOCOLS[protocol].decoder().push(stream)]


def test_noise_is_no_protocol() -> None:
    detector, random = Detector(candidates(AUTO)), Random(1)
    assert all(detector.push(random.randbytes(1 << 16)) is None for _ in range(160))


def test_readings_are_not_kept_of_protocols_that_do_not_win() -> None:
    stream = spoken("csv", 12)
    result = Detector(candidates(AUTO)).push(b"\x55\x52\x00garbage\n" + b"".join(stream))
    assert result is not None
    assert len(result[1]) == 11


def test_an_unknown_protocol_is_named_with_those_there_are() -> None:
    with pytest.raises(UsageError, match=r"unknown protocol .nmea2000.; there are auto, native, .*csv, "):
        candidates("nmea2000")
