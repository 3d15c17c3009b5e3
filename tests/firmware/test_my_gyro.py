"""`my_gyro.h` and `my_gyro.py`: parameters and calibration of a config, applied as Python applies them."""

import ctypes
from dataclasses import astuple
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from c_filter_support import EXACT, WARNINGS
from firmware_library import calibrated_config, library, need
from firmware_support import HERE, run
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.cli import main
from gyrodrift.config.model import Config, load_config
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.firmware.my_gyro import TunedGyro, my_gyro_h, my_gyro_py, prefix_of
from gyrodrift.values.calibration import NO_CALIBRATION
from gyrodrift.values.errors import UsageError
from gyrodrift.values.mount import Mount
from gyrodrift.values.sample import Inertial

pytestmark = pytest.mark.xdist_group("my_gyro")  # they share what is compiled

C11 = ("-std=c11", *EXACT, *WARNINGS)


class Compiled:
    """`my_gyro.h` of a config, compiled for a number type."""

    def __init__(self, out: Path, real: str = "double") -> None:
        need("cc", "gcc")
        library_file = out / f"calibration-{real}.so"
        run("cc", *C11, f"-DGD_REAL={real}", "-shared", "-fPIC", f"-I{out}", HERE / "use_calibration.c",
            "-o", library_file, "-lm")  # fmt: skip
        self._library = ctypes.CDLL(str(library_file))
        self._library.calibrated_dps.restype = ctypes.c_double
        self._library.calibrated_dps.argtypes = [ctypes.c_double, ctypes.c_double]
        self._library.calibrate_axes.argtypes = [ctypes.c_void_p, ctypes.c_double]

    def rate_dps(self, rate_dps: float, temp_c: float) -> float:
        return float(self._library.calibrated_dps(rate_dps, temp_c))

    def axes(self, measured: list[float], temp_c: float) -> list[float]:
        values = (ctypes.c_double * 6)(*measured)
        self._library.calibrate_axes(values, temp_c)
        return list(values)

    def params(self) -> list[list[float]]:
        values = [(ctypes.c_double * size)() for size in (5, 8, 8)]
        self._library.params(*values)
        return [list(value) for value in values]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("my_gyro")
    return library(folder, "c", "--config", calibrated_config(folder))


@pytest.fixture(scope="module")
def config(written: Path) -> Config:
    return load_config(written.parent / "my.yaml")


@pytest.fixture(scope="module")
def in_double(written: Path) -> Compiled:
    return Compiled(written)


rates = st.floats(-2000.0, 2000.0)
temps = st.one_of(st.just(nan), st.floats(-40.0, 90.0))


@given(rate_dps=rates, temp_c=temps)
def test_a_rate_is_calibrated_as_in_python(in_double: Compiled, config: Config, rate_dps: float, temp_c: float) -> None:
    """Bias over temperature with its ends, sign, and the scale of each direction."""
    assert config.calibration is not None
    expected = config.calibration.rate_dps(rate_dps, temp_c)
    assert in_double.rate_dps(rate_dps, temp_c) == pytest.approx(expected, abs=1e-9)


@given(measured=st.lists(rates, min_size=6, max_size=6), temp_c=temps)
def test_three_axes_are_calibrated_and_mounted_as_in_python(
    in_double: Compiled, config: Config, measured: list[float], temp_c: float
) -> None:
    """Matrix, offsets and scales, then the frame of the device as the filter gets it."""
    assert config.calibration is not None
    true = config.calibration.inertial(Inertial(*measured), temp_c)
    expected = [*config.mount.to_device(true[:3]), *config.mount.to_device(true[3:])]
    np.testing.assert_allclose(in_double.axes(measured, temp_c), expected, rtol=1e-13, atol=1e-9)


def test_floats_are_calibrated_to_their_resolution(written: Path, config: Config) -> None:
    """A rate of 250 deg/s has a resolution of 1.5e-5 deg/s in a float."""
    compiled = Compiled(written, "float")
    assert config.calibration is not None
    for rate_dps in np.linspace(-250.0, 250.0, 101).tolist():
        assert compiled.rate_dps(rate_dps, 31.0) == pytest.approx(config.calibration.rate_dps(rate_dps, 31.0), abs=2e-4)


def test_parameters_are_those_of_the_config(in_double: Compiled, config: Config) -> None:
    """A calibrated scale narrows `scale_percent` on one axis; on three axes the matrix has no standard error."""
    hdr, restlevel, attitude = in_double.params()
    assert hdr == list(astuple(HdrParams(i_c_dps=0.001)))
    assert restlevel == list(astuple(RestlevelParams(window_s=0.4, scale_percent=0.2)))
    assert attitude == list(astuple(RestlevelParams(window_s=0.4)))


def test_a_config_without_calibration_changes_nothing(tmp_path: Path) -> None:
    (tmp_path / "plain.yaml").write_text("filter: hdr\n")
    compiled = Compiled(library(tmp_path, "c", "--config", tmp_path / "plain.yaml"))
    assert [compiled.rate_dps(rate_dps, 20.0) for rate_dps in (-1.5, 0.0, 7.25)] == [-1.5, 0.0, 7.25]
    assert compiled.axes([1.0, -2.0, 3.0, 4.0, -5.0, 9.8], nan) == [1.0, -2.0, 3.0, 4.0, -5.0, 9.8]
    assert compiled.params()[1] == list(astuple(RestlevelParams()))


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_compilers_take_the_header_without_a_warning(compiler: str, written: Path) -> None:
    need(compiler, compiler)
    program = f'#include "{written}/my_gyro.h"\nint main(void) {{ return 0; }}\n'
    for name, flags in (("use.c", ["-std=c11"]), ("use.cpp", ["-std=c++11", "-x", "c++"])):
        (written / name).write_text(program)
        run(compiler, *WARNINGS, *flags, "-fsyntax-only", written / name)
    assert "of 'mine'" not in (written / "my_gyro.h").read_text()
    assert (written / "my_gyro.h").read_text().count("*/") == (written / "my_gyro.h").read_text().count("/*")


@pytest.mark.parametrize("compiler", ["g++", pytest.param("clang++", marks=pytest.mark.evaluation)])
def test_the_classes_of_cpp_are_the_functions_of_c(compiler: str, written: Path, tmp_path: Path) -> None:
    need(compiler, compiler)
    program = tmp_path / "wrappers"
    run(compiler, "-std=c++11", *EXACT, *WARNINGS, f"-I{written}", HERE / "use_wrappers.cpp", "-o", program)
    assert run(program) == "1\n"


USE_IN_BOTH = """
#include "gyrodrift.h"
double yaw_of_NAME() {
  gyrodrift::Hdr hdr;
  gyrodrift::Restlevel restlevel;
  gyrodrift::Attitude attitude;
  const gd_real gyro_dps[3] = {0, 0, 1}, accel_mps2[3] = {0, 0, 10};
  for (int i = 0; i < 100; i++) {
    hdr.update(0.01 * i, 1);
    restlevel.update(0.01 * i, 1);
    attitude.update(0.01 * i, gyro_dps, accel_mps2);
  }
  return static_cast<double>(restlevel.yaw_deg() + hdr.yaw_deg() + attitude.yaw_deg());
}
"""

MAIN = """
#include <cstdio>
double yaw_of_plain();
double yaw_of_other();
int main() { std::printf("%.3f %.3f", yaw_of_plain(), yaw_of_other()); }
"""


@pytest.fixture(scope="module")
def compiled_plain(tmp_path_factory: pytest.TempPathFactory, written: Path) -> Path:
    """Folder with the objects of the program and of the file without a setting."""
    need("g++", "g++")
    folder = tmp_path_factory.mktemp("plain")
    plain = USE_IN_BOTH.replace("NAME", "plain")
    (folder / "plain.cpp").write_text(plain.replace("#include", 'extern "C" {\n#include', 1).replace('.h"', '.h"\n}'))
    (folder / "main.cpp").write_text(MAIN)
    run("g++", "-std=c++11", "-O0", f"-I{written}", "-c", "plain.cpp", "main.cpp", folder=folder)
    return folder


@pytest.mark.parametrize(
    "setting", ["GD_REAL double", "GD_RESTLEVEL_HYPOTHESES 2", "GD_RESTLEVEL_AUXILIARY 0", "GD_ATTITUDE_HYPOTHESES 2"]
)
def test_two_files_of_a_program_may_have_another_number_type_or_size(
    tmp_path: Path, written: Path, compiled_plain: Path, setting: str
) -> None:
    """Without optimization the linker keeps one body of each function, and would call it with the struct of the other.

    The include is in extern "C", as many projects include headers of C.
    """
    (tmp_path / "other.cpp").write_text(f"#define {setting}\n{USE_IN_BOTH.replace('NAME', 'other')}")
    run("g++", "-std=c++11", "-O0", f"-I{written}", "-c", "other.cpp", folder=tmp_path)
    objects = [compiled_plain / "plain.o", tmp_path / "other.o"]
    for ordered in (objects, objects[::-1]):
        run("g++", *ordered, compiled_plain / "main.o", "-o", "program", folder=tmp_path)
        plain_deg, other_deg = map(float, run(tmp_path / "program").split())
        assert plain_deg == pytest.approx(other_deg, abs=0.002)
        assert plain_deg > 2.0


@pytest.mark.parametrize(("rate_dps", "temp_c"), [(0.0, None), (1.0, 5.0), (-90.0, 31.0), (90.0, 60.0)])
def test_the_module_for_micropython_calibrates_as_python_does(
    config: Config, rate_dps: float, temp_c: float | None
) -> None:
    module: dict[str, Any] = {}
    exec(my_gyro_py(TunedGyro.of_config(config, "my.yaml")), module)
    assert config.calibration is not None
    expected = config.calibration.rate_dps(rate_dps, nan if temp_c is None else temp_c)
    assert module["calibrated_dps"](rate_dps, temp_c) == pytest.approx(expected, abs=1e-12)
    assert module["HDR"]["i_c_dps"] == 0.001
    assert module["RESTLEVEL"]["window_s"] == 0.4


@pytest.mark.parametrize(
    ("name", "prefix"), [("my_gyro.h", "MY_GYRO"), ("left-2.h", "LEFT_2"), ("2nd.h", "GYRO_2ND"), ("ß.h", "GYRO")]
)
def test_names_begin_with_the_name_of_the_file(name: str, prefix: str) -> None:
    assert prefix_of(name) == prefix
    gyro = TunedGyro("a.yaml", "hdr", HdrParams(), RestlevelParams(), RestlevelParams(), None, NO_CALIBRATION, Mount())
    assert f"static const gd_hdr_params {prefix}_HDR =\n" in my_gyro_h(gyro, name)


def test_a_config_with_mistakes_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bad.yaml").write_text("filter: hdr\nhdr: {tau_s: -1}\n")
    assert main(["firmware", "--out", str(tmp_path / "out"), "--config", str(tmp_path / "bad.yaml")]) == 2
    assert "bad.yaml:2:" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_filter_that_c_does_not_have_is_told() -> None:
    """A program may have registered one."""
    with pytest.raises(UsageError, match=r"a\.yaml: filter mine runs in Python only; expected hdr or restlevel"):
        TunedGyro.of_config(Config("mine"), "a.yaml")
