"""JSON messages that others wrote: what may be missing, and how a wrong value is told."""

import math
from pathlib import Path

import numpy as np
import pytest
from foreign_support import as_json, in_json, refused, written

from gyrodrift.session.foreign.read import read_foreign


def test_json_says_what_is_missing_with_null_or_by_silence(tmp_path: Path) -> None:
    """Host time alone has something to fall back to: the log time, where it is not mentioned."""
    first = {"t_device_s": 0.0, "rate_dps": None, "temp_c": 20.5, "t_host_s": None, "encoder_deg": None}
    payloads = [as_json(first), b'{"t_device_s": 1e-2, "rate_dps": NaN, "seq": null}']
    session = read_foreign(written(tmp_path, in_json(payloads)))
    assert np.isnan(session.rate_dps).all()
    assert session.t_host_s is not None
    assert session.temp_c is not None
    assert session.t_host_s.tolist() == pytest.approx([math.nan, 1_600_000_000.01], nan_ok=True)
    assert session.temp_c.tolist() == pytest.approx([20.5, math.nan], nan_ok=True)
    assert (session.seq, session.encoder_deg) == (None, None)


@pytest.mark.parametrize(
    ("payload", "message"),
    [
        (b"", "is not JSON"),
        (b"{", "is not JSON"),
        (b"\xff\xfe", "is not JSON"),
        (b"[" * 100_000, "is not JSON"),
        (b'{"t_device_s": ' + b"9" * 5000 + b"}", "is not JSON"),
        (b"[1, 2]", "is [1, 2], expected an object with t_device_s and rate_dps"),
        (b"{}", "has no t_device_s, which is required"),
        (b'{"t_device_s": 1}', "has no rate_dps, which is required"),
        (b'{"t_device_s": "1", "rate_dps": 1}', "has '1' as t_device_s, expected a number"),
        (b'{"t_device_s": 1, "rate_dps": true}', "has True as rate_dps, expected a number"),
        (b'{"t_device_s": 1, "rate_dps": {"z": 1}}', "has {'z': 1} as rate_dps, expected a number"),
        (
            b'{"t_device_s": 1, "rate_dps": 1%s}' % (b"0" * 400),
            "has a number as rate_dps that is too large for a float",
        ),
        (b'{"t_device_s": 1, "rate_dps": 1, "seq": 1.5}', "has 1.5 as seq, expected a 64-bit integer"),
        (b'{"t_device_s": 1, "rate_dps": 1, "seq": 1e400}', "has inf as seq, expected a 64-bit integer"),
        (b'{"t_device_s": 1, "rate_dps": 1, "seq": 9223372036854775808}', "as seq, expected a 64-bit integer"),
    ],
)
def test_a_wrong_message_is_told_with_its_place(tmp_path: Path, payload: bytes, message: str) -> None:
    """Topic, number and what is wrong."""
    good = b'{"t_device_s": 0, "rate_dps": 0}'
    text = refused(tmp_path, in_json([good, payload, good], topic="/imu"))
    assert text.startswith("/imu: message 2 ")
    assert message in text
