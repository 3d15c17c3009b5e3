"""BNO08x in UART-RVC mode: the frame of its data sheet, and yaw made into a rate."""

from struct import pack

import golden_frames as golden

from firmware_sim.wire.bno08x_rvc import rvc_frame
from gyrodrift.link.protocols.bno08x_rvc import RvcDecoder
from gyrodrift.values.sample import Reading


def turning(*indexed_yaw: tuple[int, int]) -> list[Reading]:
    """Readings of frames with these indices and yaws in hundredths of a degree."""
    return RvcDecoder().push(b"".join(rvc_frame(index & 0xFF, yaw, 0, 0, 0, 0, 1000) for index, yaw in indexed_yaw))


def test_the_frame_of_the_data_sheet_is_whole() -> None:
    """A second frame one hundredth of a degree on is 1 deg/s, and the index is its clock."""
    index, yaw, *rest = (222, 1, -110, 2085, -371, -20, 977)
    assert rvc_frame(index, yaw, *rest) == golden.RVC_FRAME
    (reading,) = RvcDecoder().push(golden.RVC_FRAME + rvc_frame(223, 2, *rest))
    assert (reading.rate_dps, reading.t_us, reading.seq) == (1.0, 223 * 10_000, 223)


def test_yaw_goes_on_over_half_a_turn_and_the_index_over_its_end() -> None:
    readings = turning((254, 17990), (255, -17990), (256, -17970), (257, -17990))
    assert [reading.rate_dps for reading in readings] == [20.0, 20.0, -20.0]
    assert [reading.t_us for reading in readings] == [2_550_000, 2_560_000, 2_570_000]


def test_a_lost_frame_costs_no_yaw() -> None:
    """The rate is the mean over the hole, and the clock tells how long that was."""
    readings = turning((0, 0), (1, 10), (4, 40), (5, 50))
    assert [reading.rate_dps for reading in readings] == [10.0, 10.0, 10.0]
    assert [reading.seq for reading in readings] == [1, 4, 5]


def test_yaw_that_is_set_anew_is_no_turn() -> None:
    """Faster than the chip's gyro can see; a frame that is repeated is none either."""
    assert [reading.rate_dps for reading in turning((0, 0), (1, 9000), (1, 9000), (2, 9001))] == [1.0]


def test_a_byte_too_many_that_looks_like_a_head_costs_no_frame() -> None:
    """The search goes on behind the first byte of what was no head."""
    frames = [rvc_frame(index, 10 * index, 0, 0, 0, 0, 1000) for index in range(6)]
    decoder = RvcDecoder()
    readings = decoder.push(b"".join(frames[:3]) + b"\xaa" + b"".join(frames[3:]))
    assert [reading.seq for reading in readings] == [1, 2, 3, 4, 5]
    assert (decoder.counters.frames, decoder.counters.damaged) == (6, 1)


def test_a_frame_that_stands_alone_is_not_believed() -> None:
    decoder = RvcDecoder()
    decoder.push(b"\xaa" * 5 + golden.RVC_FRAME + pack("<30x") + b"\xaa")
    assert decoder.counters.frames == 0
