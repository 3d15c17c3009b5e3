"""The WT901 family, from frames worked out by hand."""

import golden_frames as golden
import pytest

from gyrodrift.link.protocols.witmotion import WitmotionDecoder
from gyrodrift.values.sample import Reading


def test_golden_frames_are_read() -> None:
    """Rate × 2000/32768 deg/s, temperature in hundredths."""
    readings = WitmotionDecoder().push(b"".join(golden.WT901_RATES.values()))
    expected = [(raw * 2000 / 32768, temp / 100) for raw, temp in golden.WT901_RATES]
    assert [(reading.rate_dps, reading.temp_c) for reading in readings] == expected
    assert all(reading.t_us is None and reading.seq is None for reading in readings)


def test_frames_of_other_kinds_are_counted_and_skipped() -> None:
    decoder = WitmotionDecoder()
    assert decoder.push(golden.WT901_ACCELERATION * 5) == []
    assert (decoder.counters.frames, decoder.counters.other_frames, decoder.counters.damaged) == (5, 5, 0)


def test_a_frame_that_stands_alone_in_noise_is_not_believed() -> None:
    (frame, *_) = golden.WT901_RATES.values()
    assert WitmotionDecoder().push(b"\x55\x52" + b"noise" * 5 + frame + b"\x00" * 30) == []


@pytest.mark.parametrize("junk", [b"\x55", b"\x55\x52", b"U" * 25, b"\x55\x52" * 9])
def test_headers_inside_junk_do_not_hide_the_frames_behind_it(junk: bytes) -> None:
    """The search goes on at the next header, not behind a frame that was none."""
    frames = list(golden.WT901_RATES.values())
    decoder = WitmotionDecoder()
    readings: list[Reading] = decoder.push(b"".join(frames) + junk + b"".join(frames))
    assert len(readings) == 4
    assert decoder.counters.damaged == 1
