"""From the start of the process to the first line of yaw, and what is imported on the way."""

import os
import re
import subprocess
import sys
import time
from pathlib import Path
from statistics import median

import pytest
from support import speaking_on

from bench.harness import PATIENCE_S, hello, is_readable, native_frames, repeat, serving, show

STARTS = 15
PERIOD_S = 0.001
CONFIG = Path(__file__).parents[2] / "config" / "gyrodrift.yaml"

UNWANTED = frozenset({"numpy", "scipy", "pandas", "matplotlib", "plotly", "numba", "llvmlite"})
"""Packages that take longer to import than `serve` may take to start."""


def test_first_line_after_start(tmp_path: Path) -> None:
    bare = repeat(STARTS, lambda: _first_line_s(tmp_path))
    with_config = repeat(STARTS, lambda: _first_line_s(tmp_path, "--config", CONFIG))
    show(
        "From process start to the first line",
        [
            ("serve, median", _ms(median(bare))),
            ("serve, worst", _ms(bare[-1])),
            ("serve --config, median", _ms(median(with_config))),
            ("serve --config, worst", _ms(with_config[-1])),
        ],
    )


def test_import_of_the_command_line() -> None:
    python_s = median(repeat(STARTS, lambda: _run_s("pass")))
    import_s = median(repeat(STARTS, lambda: _run_s("import gyrodrift.cli")))
    show("Import", [("python alone", _ms(python_s)), ("gyrodrift.cli on top", _ms(import_s - python_s))])


@pytest.mark.parametrize("options", [(), ("--config", CONFIG)], ids=["bare", "config"])
def test_serve_imports_no_heavy_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, options: tuple[str | Path, ...]
) -> None:
    monkeypatch.setenv("PYTHONPROFILEIMPORTTIME", "1")
    _first_line_s(tmp_path, *options)
    timed = re.findall(r"import time:\s+(\d+) \|\s+\d+ \| +(\S+)", (tmp_path / "serve.log").read_text())
    spent_us: dict[str, int] = {}
    for own_us, module in timed:
        package = module.partition(".")[0]
        spent_us[package] = spent_us.get(package, 0) + int(own_us)
    dearest = sorted(spent_us, key=spent_us.__getitem__, reverse=True)[:8]
    show(
        f"Packages that serve {' '.join(map(str, options[:1]))} imports, the dearest, under -X importtime",
        [(package, _ms(spent_us[package] * 1e-6)) for package in dearest],
    )
    assert "gyrodrift" in spent_us
    assert not UNWANTED & set(spent_us)


def _first_line_s(folder: Path, *options: str | Path) -> float:
    """Start `serve` on a device that boots when it is opened and speaks from then on."""
    frames = iter([hello(), *native_frames(4000, 1000)])
    with speaking_on(folder / "gyro") as device:
        started_s = time.monotonic()
        with serving(device.link, *options, log=folder / "serve.log", stdout=subprocess.PIPE) as serve:
            assert serve.stdout is not None
            device.wait_for_reader(lambda: serve.poll() is not None or time.monotonic() > started_s + PATIENCE_S)
            while not is_readable(serve.stdout.fileno(), PERIOD_S):
                device.send(next(frames))
            first_s = time.monotonic() - started_s
            assert os.read(serve.stdout.fileno(), 1 << 16).startswith(b'{"seq":0,')
            serve.terminate()
            serve.wait(PATIENCE_S)
    return first_s


def _run_s(code: str) -> float:
    started_s = time.monotonic()
    subprocess.run([sys.executable, "-c", code], check=True)
    return time.monotonic() - started_s


def _ms(seconds: float) -> str:
    return f"{seconds * 1e3:.1f} ms"
