"""A device can send anything at all: odd lines are counted, whoever listens and however."""

from collections.abc import Iterable
from itertools import cycle, islice
from pathlib import Path
from typing import Any

import pytest
from sources_support import Host
from support import Command, never, speaking_on

from gyrodrift.values.errors import DeviceSilentError
from gyrodrift.values.sample import Sample

ODD = (
    b"{[]: 1}\n",
    b"{[1], 2}\n",
    b"{" * 700 + b"\n",
    b'{"t_ms": ' + b"[" * 700 + b"\n",
    b'{"gz": ' + b"9" * 700 + b"}\n",
    b"{'gz': 1e999, 'gz': nan}\n",
    b"{'gz': __import__('os')}\n",
    b'{"gz": "\\ud800"}\n',
    b"\xff\xfe\x00{\n",
    "\u0664\u0662, \u0661\n".encode(),
)
BOOT = tuple(b"boot %d\n" % i for i in range(len(ODD)))


def heard(port: Path, lines: Iterable[bytes], step_s: float, **options: Any) -> tuple[Host, list[Sample]]:
    """Host with a closed link, and the samples of these lines, one every `step_s`."""
    with speaking_on(port) as device, Host(port, **options) as host:
        return host, host.hear(device, lines, step_s)


def test_between_samples_they_are_damage(port: Path) -> None:
    """Every sample is handed on, and the decoder never failed."""
    good = [b"%d, 0.5\n" % (10 * i) for i in range(200)]
    lines = [part for i, line in enumerate(good) for part in (line, ODD[i % len(ODD)])]
    host, samples = heard(port, lines, 0.005, baud=115200, columns="t_ms, rate")
    assert len(samples) == 200
    assert host.link.counted()["damaged"] == 200
    assert "decoder_failed" not in host.names()


def test_who_waits_for_ever_is_told_what_they_look_like(port: Path) -> None:
    lines = [line for pair in zip(BOOT, ODD, strict=True) for line in pair]
    host, samples = heard(port, islice(cycle(lines), 700), 0.02, timeout_s=0.0)
    assert samples == []
    assert "not_understood" in host.names()


@pytest.mark.parametrize("options", [{}, {"columns": "gyro=rate"}, {"columns": "t_ms, rate"}])
def test_who_waits_gives_up_as_with_any_other_text(port: Path, options: dict[str, str]) -> None:
    lines = [line for pair in zip(BOOT, ODD, strict=True) for line in pair]
    with pytest.raises(DeviceSilentError, match=r"within 10 s|prints text"):
        heard(port, islice(cycle(lines), 700), 0.02, **options)


@pytest.mark.promise("Recovery")
def test_the_service_goes_on(port: Path) -> None:
    """The service continues on any text, including text that only a language parser accepts."""
    good = b"".join(b"%d, 0.5\n" % (10 * i) for i in range(50))
    extra = b"".join(b"%d, 0.5\n" % (10 * i) for i in range(50, 100))
    with speaking_on(port) as device, Command("serve", "--port", port, "--columns", "t_ms, rate") as serve:
        device.wait_for_reader(never)
        device.send_all(good + b"".join(ODD) + extra, never)
        assert len(serve.take_lines(100)) == 100
        assert serve.stop() == 0
    assert f"damaged={len(ODD)}" in serve.log
    assert "Traceback" not in serve.log
