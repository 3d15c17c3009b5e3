"""Properties of every decoder: any split, any damage, any noise."""

import tracemalloc
from collections.abc import Iterator
from itertools import islice, pairwise
from random import Random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.measure import measure
from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import Base, Rig
from firmware_sim.wire.encoder import Frame
from firmware_sim.wire.registry import ENCODERS
from gyrodrift.link.protocols.decoder import Decoder
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.values.sample import Reading

RIG = Rig(base=Base(bias_dps=0.3))


def frames(protocol: str, count: int) -> list[Frame]:
    spoken = ENCODERS[protocol].frames(measure(RIG, load_profile("turntable"), seed=3), RIG.base)
    return list(islice(spoken, count))


FRAMES = {protocol: frames(protocol, 150) for protocol in PROTOCOLS}
STREAMS = {protocol: [frame.content for frame in spoken] for protocol, spoken in FRAMES.items()}
ONE_PUSH = {protocol: PROTOCOLS[protocol].decoder().push(b"".join(stream)) for protocol, stream in STREAMS.items()}


def pieces(stream: bytes, cuts: list[int]) -> Iterator[bytes]:
    places = [0, *sorted(cut % (len(stream) + 1) for cut in cuts), len(stream)]
    return (stream[start:end] for start, end in pairwise(places))


def pushed(decoder: Decoder, chunks: Iterator[bytes]) -> list[str]:
    """Readings as text, in which NaN equals NaN."""
    return [repr(reading) for chunk in chunks for reading in decoder.push(chunk)]


protocols = st.sampled_from(sorted(PROTOCOLS))
cuts = st.lists(st.integers(0, 1 << 20), max_size=40)


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_everything_the_device_says_is_read(protocol: str) -> None:
    assert len(ONE_PUSH[protocol]) == sum(frame.rows for frame in FRAMES[protocol])


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_protocol_says_whether_it_has_a_clock(protocol: str) -> None:
    assert {reading.t_us is not None for reading in ONE_PUSH[protocol]} == {PROTOCOLS[protocol].has_clock}


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_a_decoder_has_the_name_of_its_protocol(protocol: str) -> None:
    assert PROTOCOLS[protocol].decoder().name == protocol


@given(protocols, cuts)
def test_any_split_of_the_stream_gives_the_same_readings(protocol: str, cuts: list[int]) -> None:
    split = pushed(PROTOCOLS[protocol].decoder(), pieces(b"".join(STREAMS[protocol]), cuts))
    assert split == [repr(reading) for reading in ONE_PUSH[protocol]]


@given(protocols, cuts, st.lists(st.tuples(st.integers(0, 1 << 20), st.binary(max_size=30)), max_size=8))
def test_any_split_of_a_damaged_stream_gives_the_same_readings_and_counts(
    protocol: str, cuts: list[int], damage: list[tuple[int, bytes]]
) -> None:
    """Damage is bytes written over others, at any place."""
    stream = bytearray(b"".join(STREAMS[protocol]))
    for position, junk in damage:
        start = position % len(stream)
        stream[start : start + len(junk)] = junk
    whole, split = PROTOCOLS[protocol].decoder(), PROTOCOLS[protocol].decoder()
    assert pushed(whole, iter([bytes(stream)])) == pushed(split, pieces(bytes(stream), cuts))
    assert whole.counters == split.counters


@given(protocols, st.integers(20, 120), st.integers(0, 200), st.integers(1, 255))
def test_a_flipped_byte_costs_its_own_frame_and_at_most_one_more(
    protocol: str, index: int, location: int, flip: int
) -> None:
    stream = list(STREAMS[protocol])
    broken = bytearray(stream[index])
    broken[location % len(broken)] ^= flip
    readings = PROTOCOLS[protocol].decoder().push(b"".join([*stream[:index], bytes(broken), *stream[index + 1 :]]))
    assert len(readings) >= len(ONE_PUSH[protocol]) - 2
    assert readings[-20:] == ONE_PUSH[protocol][-20:] or protocol == "witmotion"
    assert [reading.rate_dps for reading in readings[-20:]] == [r.rate_dps for r in ONE_PUSH[protocol][-20:]]


@given(protocols, st.binary(max_size=2000))
def test_noise_is_never_more_than_counted(protocol: str, noise: bytes) -> None:
    decoder = PROTOCOLS[protocol].decoder()
    decoder.push(noise)
    assert decoder.counters.damaged >= 0


@pytest.mark.promise("Memory and the end")
@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_after_megabytes_of_noise_the_next_good_frame_counts(protocol: str) -> None:
    """Noise of any length needs bounded memory."""
    random = Random(5)
    decoder = PROTOCOLS[protocol].decoder()
    decoder.push(b"".join(STREAMS[protocol][:5]))
    any_byte = random.randbytes(1 << 20)
    no_end = bytes(byte or 1 for byte in any_byte.replace(b"\n", b"x"))
    decoder.push(any_byte)  # patterns that are compiled at their first use stay with the module
    tracemalloc.start()
    for _ in range(5):
        decoder.push(any_byte)
        decoder.push(no_end)
    kept_bytes, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert kept_bytes < 150_000
    readings = decoder.push(b"".join(STREAMS[protocol][5:25]))
    assert len(readings) >= 20 - 2
    assert decoder.counters.damaged > 0


@pytest.mark.parametrize("protocol", PROTOCOLS)
def test_half_a_frame_at_the_end_waits_for_its_other_half(protocol: str) -> None:
    decoder = PROTOCOLS[protocol].decoder()
    *whole, last = STREAMS[decoder.name]
    before = len(decoder.push(b"".join(whole) + last[: len(last) // 2]))
    after = decoder.push(last[len(last) // 2 :])
    assert (before + 1, len(after)) == (len(ONE_PUSH[decoder.name]), 1)
    assert decoder.counters.damaged == 0
    assert isinstance(after[0], Reading)
