"""The firmware of `gyrodrift/firmware`, compiled and run: on this machine, in simavr, and in MicroPython."""

import json
import re
import shutil
import subprocess
import time
from pathlib import Path
from types import TracebackType
from typing import Any, NamedTuple, Self

import numpy as np
import pytest
from built_once import built_once
from clients_support import node_client
from numpy.typing import NDArray
from support import PATIENCE_S

ROOT = Path(__file__).parent.parent
HERE = Path(__file__).parent / "firmware"
FILES = ROOT / "gyrodrift" / "firmware" / "files"
HEADERS = FILES / "c"
SKETCH = FILES / "arduino" / "examples" / "gyrodrift_gyro"
MICROPYTHON = FILES / "micropython"
ARDUINO = Path("/usr/share/arduino/hardware/arduino/avr")
SIMAVR = Path("/usr/include/simavr")

CORE = (
    "-DF_CPU=16000000L",
    "-DARDUINO=10819",
    "-DARDUINO_ARCH_AVR",
    "-DDECIMAL_DIG=__DECIMAL_DIG__",  # the core asks for it, and the avr-libc of Debian tells it to C alone
    "-Os",
    "-ffunction-sections",
    "-fdata-sections",
    f"-I{ARDUINO}/cores/arduino",
    f"-I{ARDUINO}/libraries/Wire/src",
)
"""Options of the Arduino IDE."""

UNO = ("-mmcu=atmega328p", f"-I{ARDUINO}/variants/standard", *CORE)
MEGA = ("-mmcu=atmega2560", f"-I{ARDUINO}/variants/mega", *CORE)
LEONARDO = ("-mmcu=atmega32u4", f"-I{ARDUINO}/variants/leonardo", "-DUSB_VID=0x2341", "-DUSB_PID=0x8036", *CORE)

CPP = ("-std=gnu++11", "-fno-exceptions", "-fno-threadsafe-statics")
STRICT = ("-Wall", "-Wextra", "-Werror")
LTO = ("-flto", "-fuse-linker-plugin")
"""The IDE optimizes while it links, too; symbols of such an object cannot be listed."""


class Truth(NamedTuple):
    """Measurements of a simulated gyro: device clock in µs, counts of rates and accelerations, °C; shape (samples,).

    rate_raw
        About z.
    """

    t_us: NDArray[np.float64]
    rate_raw: NDArray[np.float64]
    temp_c: NDArray[np.float64]
    gyro_x_raw: NDArray[np.float64]
    gyro_y_raw: NDArray[np.float64]
    accel_x_raw: NDArray[np.float64]
    accel_y_raw: NDArray[np.float64]
    accel_z_raw: NDArray[np.float64]

    def gyro_raw(self) -> NDArray[np.float64]:
        """Counts of the rates about x, y and z, shape (samples, 3)."""
        return np.stack([self.gyro_x_raw, self.gyro_y_raw, self.rate_raw], axis=1)

    def accel_raw(self) -> NDArray[np.float64]:
        """Counts of the accelerations along x, y and z, shape (samples, 3)."""
        return np.stack([self.accel_x_raw, self.accel_y_raw, self.accel_z_raw], axis=1)


def run(*words: str | Path, folder: Path | None = None) -> str:
    done = subprocess.run([str(word) for word in words], cwd=folder, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def compiled(source: str, into: Path, *flags: str) -> Path:
    """A C program or library of tests/firmware, for this machine."""
    if shutil.which("cc") is None:
        pytest.skip("there is no C compiler: apt-get install gcc")
    program = into / Path(source).stem
    run("cc", "-std=c11", "-O2", *STRICT, f"-I{SKETCH}", f"-I{HEADERS}", HERE / source, "-o", program, *flags)
    return program


def sketch_object(into: Path, *board: str, folder: Path = SKETCH) -> Path:
    """The sketch for a board, with the Arduino core of Debian; a warning is an error."""
    if shutil.which("avr-g++") is None or not ARDUINO.is_dir():
        pytest.skip("the sketch cannot be compiled: apt-get install gcc-avr avr-libc arduino-core-avr")
    built = into / "sketch.o"
    ino = ("-x", "c++", "-include", "Arduino.h", folder / "gyrodrift_gyro.ino")
    run("avr-g++", *board, *STRICT, *CPP, f"-I{HEADERS}", *ino, "-c", "-o", built)
    return built


def library_object(library: Path, example: str, into: Path, *board: str) -> Path:
    """An example of an Arduino library for a board, with the headers of that library; a warning is an error."""
    if shutil.which("avr-g++") is None or not ARDUINO.is_dir():
        pytest.skip("the sketch cannot be compiled: apt-get install gcc-avr avr-libc arduino-core-avr")
    built = into / "sketch.o"
    ino = ("-x", "c++", "-include", "Arduino.h", library / "examples" / example / f"{example}.ino")
    run("avr-g++", *board, *STRICT, *CPP, f"-I{library / 'src'}", *ino, "-c", "-o", built)
    return built


def changed_sketch(into: Path, **settings: str) -> Path:
    """Folder with the sketch after other settings at its top."""
    folder = into / "changed"
    shutil.copytree(SKETCH, folder)
    source = folder / "gyrodrift_gyro.ino"
    text = source.read_text()
    for name, value in settings.items():
        text, count = re.subn(rf"({name} = )\w+;", rf"\g<1>{value};", text)
        assert count == 1, name
    source.write_text(text)
    return folder


def built_sketch(into: Path, folder: Path = SKETCH) -> Path:
    """The sketch for an Uno, to run."""
    return linked(sketch_object(into, *UNO, folder=folder), into)


def linked(sketch: Path, into: Path) -> Path:
    """A compiled sketch with the core, for an Uno."""
    elf = into / "sketch.elf"
    run("avr-gcc", "-mmcu=atmega328p", "-Os", *LTO, "-Wl,--gc-sections", sketch, *core_objects(), "-o", elf, "-lm")
    return elf


def core_objects() -> list[Path]:
    """The core for an Uno."""

    def build(folder: Path) -> None:
        core, wire = ARDUINO / "cores" / "arduino", ARDUINO / "libraries" / "Wire" / "src"
        for compiler, suffix, *flags in (("avr-gcc", "c", "-std=gnu11"), ("avr-g++", "cpp", *CPP)):
            sources = [*core.glob(f"*.{suffix}"), *wire.rglob(f"*.{suffix}")]
            run(compiler, *UNO, "-w", *flags, "-c", *sources, folder=folder)

    return sorted(built_once("core", build).glob("*.o"))


def built_board(into: Path) -> Path:
    """The program that plays an Uno."""
    if not SIMAVR.is_dir():
        pytest.skip("there is no simavr: apt-get install libsimavr-dev")
    return compiled("avr_board.c", into, "-lsimavr", "-lm")


class Board:
    """An Uno with the sketch, at the port `link` until its time is over; see tests/firmware/avr_board.c."""

    def __init__(self, program: Path, sketch: Path, link: Path, **options: object) -> None:
        self.link = link
        self._truth = link.with_suffix(".truth")
        words = [f"{name}={value}" for name, value in options.items()]
        command = [str(program), str(sketch), str(link), f"truth={self._truth}", *words]
        self._process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)

    def __enter__(self) -> Self:
        until_s = time.monotonic() + PATIENCE_S
        while not self.link.is_symlink():
            assert time.monotonic() < until_s, "the board makes no port"
            assert self._process.poll() is None, self._process.communicate()[1]
            time.sleep(0.01)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._process.kill()
        self._process.communicate()

    def is_over(self) -> bool:
        """Whether it has come to its end."""
        return self._process.poll() is not None

    def result(self, patience_s: float = PATIENCE_S) -> tuple[dict[str, Any], Truth]:
        statement, complaint = self._process.communicate(timeout=patience_s)
        assert self._process.returncode == 0, complaint
        rows = np.loadtxt(self._truth, delimiter=",", ndmin=2)
        return json.loads(statement), Truth(*rows.T)


def in_micropython(program: str, request: object, folder: Path, *further: Path) -> bytes:
    question = folder / "asked.json"
    question.write_text(json.dumps(request))
    files = [*sorted(MICROPYTHON.glob("*.py")), question, *further]
    package = "@micropython/micropython-webassembly-pyscript"
    node = node_client(package, "micropython.mjs", str(HERE / "micropython" / program), *map(str, files))
    statement, complaint = node.communicate(timeout=3 * PATIENCE_S)
    assert node.returncode == 0, complaint
    return bytes.fromhex(statement)


def same_sensor(record: dict[str, Any], sensor: Any) -> bool:
    """Whether a record of the sketch and one of MicroPython, a named tuple, say the same."""
    ours = json.loads(json.dumps(sensor._asdict()))
    factor, divisor, at_zero = ours.pop("centi_c")
    scales = (ours.pop("dps_per_lsb"), ours.pop("mps2_per_lsb"), factor / divisor / 100, at_zero / 100)
    theirs = [record.pop(name) for name in ("dps_per_lsb", "mps2_per_lsb", "c_per_lsb", "c_at_zero")]
    return bool(ours == record and np.allclose(scales, theirs, rtol=1e-5, atol=0.0))
