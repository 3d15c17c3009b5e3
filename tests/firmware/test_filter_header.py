"""`gyrodrift.h`: joined from its parts, without a warning of any compiler, and with the parameters of the registry."""

import re
import shutil
from dataclasses import fields
from itertools import product
from math import nan
from pathlib import Path

import pytest
from c_filter_support import WARNINGS, CFilters, words, write_header
from firmware_support import run
from support import quick

from gyrodrift.filters.registry import FILTERS
from gyrodrift.firmware.parameters import FILTERS_FOLDER, initializer, parameters_h
from gyrodrift.firmware.targets import ROOT_PART, gyrodrift_h, joined

M4F = ("-mcpu=cortex-m4", "-mthumb", "-mfpu=fpv4-sp-d16", "-mfloat-abi=hard")

# Clang finds its warnings before it optimizes.
COMPILERS = {
    "gcc": ("gcc", "-std=c11", "-O2"),
    "g++": ("g++", "-std=c++11", "-O1", "-x", "c++"),
    "clang": ("clang", "-std=c11", "-O0"),
    "clang++": ("clang++", "-std=c++11", "-O0", "-x", "c++"),
    "avr-gcc": ("avr-gcc", "-std=c11", "-Os", "-mmcu=atmega328p"),
    "avr-g++": ("avr-g++", "-std=c++11", "-Os", "-mmcu=atmega328p", "-x", "c++"),
    "arm-gcc": ("arm-none-eabi-gcc", "-std=c11", "-Os", "-mcpu=cortex-m0plus", "-mthumb"),
    "arm-g++": ("arm-none-eabi-g++", "-std=c++11", "-O2", *M4F, "-x", "c++"),
}


@pytest.mark.parametrize(
    ("name", "real"),
    quick(product(COMPILERS, ("float", "double")), *product(("gcc", "clang++", "avr-g++", "arm-gcc"), ("float",))),
)
def test_no_compiler_warns_of_the_header(tmp_path: Path, name: str, real: str) -> None:
    """C11 and C++11, on this machine, on AVR and on ARM."""
    program, *flags = COMPILERS[name]
    if shutil.which(program) is None:
        pytest.skip(f"there is no {program}")
    write_header(tmp_path)
    run(program, *flags, *words("use_filters.c", real), "-c", "-o", "use.o", folder=tmp_path)
    assert (tmp_path / "use.o").stat().st_size > 0


@pytest.mark.parametrize("compiler", ["gcc", "clang", "avr-gcc"])
@pytest.mark.parametrize("flag", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_fast_mathematics_is_refused(tmp_path: Path, compiler: str, flag: str) -> None:
    if shutil.which(compiler) is None:
        pytest.skip(f"there is no {compiler}")
    write_header(tmp_path)
    with pytest.raises(AssertionError, match="without -ffast-math"):
        run(compiler, flag, *words("use_filters.c", "float"), "-c", "-o", "use.o", folder=tmp_path)


@pytest.mark.parametrize("real", ["int", "int64_t", "long double"])
@pytest.mark.parametrize("name", ["gcc", "clang++"])
def test_a_number_type_that_is_no_float_or_double_is_refused(tmp_path: Path, name: str, real: str) -> None:
    """Integers of the same size would divide by 0."""
    program, *flags = COMPILERS[name]
    if shutil.which(program) is None:
        pytest.skip(f"there is no {program}")
    write_header(tmp_path)
    (tmp_path / "use.c").write_text('#include "gyrodrift.h"\n')
    with pytest.raises(AssertionError, match="GD_REAL must be float or double"):
        run(program, *flags, f"-DGD_REAL={real}", "use.c", "-c", "-o", "use.o", folder=tmp_path)


def test_the_header_holds_each_part_once() -> None:
    text = gyrodrift_h()
    assert re.findall(r'^#include "', text, re.MULTILINE) == []
    for part in FILTERS_FOLDER.glob("*.h"):
        if part.name != ROOT_PART:
            head = part.read_text().split("*/", 1)[0]
            assert text.count(head) == 1, part.name


def test_the_head_comment_shows_use_in_thirty_lines() -> None:
    head = gyrodrift_h().split("*/", 1)[0]
    assert head.count("\n") <= 30
    assert "gd_hdr_init(&h, NULL)" in head


def test_a_part_can_be_joined_alone() -> None:
    text = joined("hdr.h")
    assert "gd_hdr_update" in text
    assert text.index("typedef GD_REAL gd_real") < text.index("} gd_hdr_params;") < text.index("} gd_hdr;")
    assert "gd_restlevel_update" not in text


def test_each_part_is_short_and_guarded() -> None:
    """A part is read in one go."""
    for part in FILTERS_FOLDER.glob("*.h"):
        text = part.read_text()
        assert text.startswith("/* "), part.name
        assert text.count("\n") <= 250, part.name
        assert all(len(line) <= 120 for line in text.splitlines()), part.name


def test_the_parameters_are_those_of_the_registry() -> None:
    """Names, defaults and bounds; `python -m gyrodrift.firmware.parameters` writes the header again."""
    assert (FILTERS_FOLDER / "parameters.h").read_text(encoding="utf-8") == parameters_h()


@pytest.mark.parametrize("name", ["hdr", "restlevel"])
def test_the_defaults_of_the_header_are_those_of_the_registry(name: str) -> None:
    """Values and order of the fields."""
    params = FILTERS[name].params
    text = parameters_h()
    struct = re.search(rf"typedef struct {{([^}}]*)}} gd_{name}_params;", text)
    assert struct is not None
    names = re.findall(r"gd_real (\w+);", struct[1])
    assert names == [field.name for field in fields(params)]
    defaults = re.search(rf"#define GD_{name.upper()}_DEFAULTS \\\n(.*)\n", text)
    assert defaults is not None
    values = [float(value) for value in re.findall(r"GD_R\(([^)]*)\)", defaults[1])]
    assert values == [field.default for field in fields(params)]
    assert initializer(params()) in text


def test_parameters_out_of_bounds_are_refused(c_filters: CFilters) -> None:
    library = c_filters.get("filter_hdr.c", "double")
    t_s, rates = [0.0, 0.01, 0.02, 0.03], [0.1, 0.2, 0.1, 0.2]
    usual = library.run(t_s, rates)
    good = [0.001, 1.0, 1.0, 1.0, 1.0]
    assert library.run(t_s, rates, good).is_valid
    beyond = [(0, -1e-9), (0, 10.1), (1, 1000.1), (2, 0.0), (2, 2001.0), (3, -1.0), (4, 11.0), (1, nan)]
    for index, bad in beyond:
        values = [*good[:index], bad, *good[index + 1 :]]
        refused = library.run(t_s, rates, values)
        assert not refused.is_valid
        assert (refused.rows == usual.rows).all()


def test_warnings_are_errors() -> None:
    assert "-Werror" in WARNINGS


def test_three_users_carry_one_copy(tmp_path: Path) -> None:
    """With the switches three files hold no function of the filter, and the implementation holds it once."""
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")
    write_header(tmp_path)
    users = ("one", "two", "three")
    for name in users:
        use = f"int {name}(gd_hdr *h);\nint {name}(gd_hdr *h) {{ return gd_hdr_update(h, 1.0, 1); }}\n"
        (tmp_path / f"{name}.c").write_text(f'#define GYRODRIFT_SHARED\n#include "gyrodrift.h"\n{use}')
    (tmp_path / "copy.c").write_text('#define GYRODRIFT_IMPLEMENTATION\n#include "gyrodrift.h"\n')
    main = "int one(gd_hdr *h);\nint main(void) { gd_hdr h; return gd_hdr_init(&h, NULL) && one(&h) ? 0 : 1; }\n"
    (tmp_path / "main.c").write_text(f'#define GYRODRIFT_SHARED\n#include "gyrodrift.h"\n{main}')
    for name in (*users, "copy", "main"):
        run("gcc", "-std=c11", "-O0", *WARNINGS, "-c", f"{name}.c", "-o", f"{name}.o", folder=tmp_path)
    run("gcc", *(f"{name}.o" for name in (*users, "copy", "main")), "-lm", "-o", "program", folder=tmp_path)
    run("./program", folder=tmp_path)
    defined = {name: run("nm", "--defined-only", f"{name}.o", folder=tmp_path).split() for name in (*users, "copy")}
    assert [name for name in defined if "gd_hdr_update" in defined[name]] == ["copy"]


def test_both_switches_in_one_file_are_refused(tmp_path: Path) -> None:
    if shutil.which("gcc") is None:
        pytest.skip("there is no gcc")
    write_header(tmp_path)
    switches = "#define GYRODRIFT_SHARED\n#define GYRODRIFT_IMPLEMENTATION\n"
    (tmp_path / "use.c").write_text(f'{switches}#include "gyrodrift.h"\n')
    with pytest.raises(AssertionError, match="GYRODRIFT_IMPLEMENTATION in one file"):
        run("gcc", "use.c", "-c", "-o", "use.o", folder=tmp_path)


def test_the_head_lists_what_users_call_and_marks_the_rest() -> None:
    contents = gyrodrift_h().partition("/* Contents")[2].partition("*/")[0]
    assert {"gd_hdr_init", "gd_restlevel_update_us", "gd_attitude_zero", "gd_calibrate_axes"} <= set(contents.split())
    assert "/* ---- restlevel_kalman.h: internal ---- */" in gyrodrift_h()
    assert "/* ---- restlevel.h ---- */" in gyrodrift_h()
