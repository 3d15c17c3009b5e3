"""The pages on filters for microcontrollers, walked as a newcomer does: commands, sketches, code, and printed lines."""

import re
import shlex
import sys
import time
import types
from pathlib import Path

import pytest
from firmware_library import calibrated_config, library, need
from firmware_support import CPP, LTO, ROOT, STRICT, UNO, library_object, linked, run

from gyrodrift.cli import main
from gyrodrift.firmware.micropython import restlevel_py

TEN_MINUTES = ROOT / "docs" / "firmware" / "yaw-on-an-arduino.md"
FILTER = ROOT / "docs" / "firmware" / "filter.md"
FIRMWARE = ROOT / "docs" / "firmware" / "README.md"
PRINTED = re.compile(r"yaw -?\d+\.\d\d \+- \d+\.\d\d deg, bias \d+\.\d{3} deg/s")


def blocks(page: Path, language: str) -> list[str]:
    """Code of a page in a language."""
    return re.findall(rf"^```{language}\n(.*?)^```$", page.read_text(), re.MULTILINE | re.DOTALL)


def commands(page: Path, name: str) -> list[list[str]]:
    """Words of the lines of a page that run a program."""
    lines = "".join(blocks(page, "sh")).splitlines()
    return [words for line in lines if (words := shlex.split(line, comments=True)) and words[0] == name]


def at_home(words: list[str], home: Path) -> list[str]:
    """Words of a command with another home folder, as a shell passes them."""
    return [word.replace("~", str(home), 1) if word.startswith("~") else word for word in words]


def test_the_ten_minutes_lead_to_a_sketch_for_an_uno(tmp_path: Path) -> None:
    """The first command writes the library, and the sketch that arduino-cli is told of is there and fits."""
    need("avr-g++", "gcc-avr")
    first, *_ = (at_home(words, tmp_path) for words in commands(TEN_MINUTES, "gyrodrift"))
    assert main(first[1:]) == 0
    (upload,) = (at_home(words, tmp_path) for words in commands(TEN_MINUTES, "arduino-cli"))
    sketch = Path(upload[-1])
    assert (sketch / f"{sketch.name}.ino").is_file()
    assert linked(library_object(sketch.parent.parent, sketch.name, tmp_path, *UNO, *LTO), tmp_path).is_file()


def test_the_lines_of_the_page_are_those_of_the_sketch(tmp_path: Path) -> None:
    shown = next(block for block in blocks(TEN_MINUTES, "") if "yaw" in block).splitlines()
    assert all(PRINTED.fullmatch(line) for line in shown)
    sketch = (library(tmp_path, "arduino") / "examples" / "SerialYaw" / "SerialYaw.ino").read_text()
    assert "no gyro at this address" in TEN_MINUTES.read_text()
    assert '"no gyro at this address: check VCC, GND, SCL and SDA"' in sketch


def test_the_sketch_of_the_page_compiles(tmp_path: Path) -> None:
    need("avr-g++", "gcc-avr")
    (code,) = blocks(TEN_MINUTES, "cpp")
    sketch = tmp_path / "own.ino"
    sketch.write_text(f"{code}\nvoid setup() {{}}\nvoid loop() {{ on_measurement(0.0f); }}\n")
    include = [f"-I{library(tmp_path, 'arduino') / 'src'}", "-x", "c++", "-include", "Arduino.h"]
    assert run("avr-g++", *UNO, *STRICT, *CPP, *include, "-c", sketch, "-o", tmp_path / "own.o") == ""


@pytest.mark.parametrize(("compiler", "language"), [("cc", "c"), ("c++", "cpp")])
def test_the_code_of_the_filter_page_compiles(compiler: str, language: str, tmp_path: Path) -> None:
    need(compiler, "gcc")
    out = library(tmp_path, "c", "--config", calibrated_config(tmp_path))
    code = blocks(FILTER, language)
    source = tmp_path / f"use.{language}"
    kinds = "float a, float b, float c"
    source.write_text(f"#include <stdint.h>\nstatic void use({kinds}) {{ (void)a, (void)b, (void)c; }}\n{code[0]}")
    assert run(compiler, *STRICT, "-Wno-unused-function", f"-I{out}", "-fsyntax-only", source) == ""


def test_the_code_with_the_values_of_a_gyro_compiles(tmp_path: Path) -> None:
    need("cc", "gcc")
    out = library(tmp_path, "c", "--config", calibrated_config(tmp_path))
    include, _, body = blocks(FILTER, "c")[2].partition("\n")
    source = tmp_path / "use.c"
    arguments = "gd_restlevel filter, uint32_t t_us, float rate_dps, float temp_c"
    source.write_text(f"{include}\nvoid own({arguments});\nvoid own({arguments}) {{\n{body}}}\n")
    assert run("cc", "-std=c11", *STRICT, f"-I{out}", "-fsyntax-only", source) == ""


def test_the_code_for_micropython_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(time, "ticks_us", lambda: 0, raising=False)
    monkeypatch.setattr(time, "ticks_diff", lambda end, start: end - start, raising=False)
    out = library(tmp_path, "micropython", "--config", calibrated_config(tmp_path))
    for name in ("my_gyro", "gyrodrift_restlevel"):
        module = types.ModuleType(name)
        exec((out / f"{name}.py").read_text(), module.__dict__)
        monkeypatch.setitem(sys.modules, name, module)
    names = {"rate_dps": 0.5, "temp_c": 25.0}
    (code,) = blocks(FILTER, "python")
    exec(code, names)
    assert names["restlevel"].samples == 1  # type: ignore[attr-defined]


def test_the_sizes_of_the_page_are_those_of_the_files(tmp_path: Path) -> None:
    row = re.search(r"\| file, and compiled by mpy-cross \| (\d+) KB \| (\d+) KB, 20 KB \|\n", FILTER.read_text())
    assert row is not None
    hdr = (library(tmp_path, "micropython") / "gyrodrift_hdr.py").stat().st_size
    assert int(row[1]) == round(hdr / 1024)
    assert int(row[2]) == pytest.approx(len(restlevel_py()) / 1024, abs=2)


@pytest.mark.parametrize("page", [TEN_MINUTES, FILTER, FIRMWARE], ids=lambda page: page.name)
def test_the_targets_of_the_pages_exist(page: Path, tmp_path: Path) -> None:
    for words in commands(page, "gyrodrift"):
        if words[1] != "firmware":
            continue
        words[words.index("--out") + 1] = str(tmp_path / "out" / words[words.index("--out") + 1].replace("~", "home"))
        if "--config" in words:
            words[words.index("--config") + 1] = str(calibrated_config(tmp_path))
        assert main(words[1:]) == 0
