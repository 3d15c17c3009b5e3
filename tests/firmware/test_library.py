"""`gyrodrift firmware`: files of each target, files of users that stay, and the library for C with CMake."""

import io
import re
import subprocess
from pathlib import Path

import numpy as np
import pytest
from firmware_library import calibrated_config, cmake_built, library
from firmware_support import FILES, run

from gyrodrift import __version__
from gyrodrift.cli import main
from gyrodrift.firmware.targets import TARGETS, VERSION_MARK, files_of


def written(out: Path) -> set[str]:
    """Paths in a library, without the record of the command."""
    return {str(path.relative_to(out)) for path in out.rglob("*") if path.is_file() and path.name[0] != "."}


@pytest.mark.parametrize("name", TARGETS)
def test_each_target_is_written_as_its_tool_chain_takes_it(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The command names all files and the next step, and no mark of a template stays."""
    out = tmp_path / "gyrodrift"
    assert main(["firmware", "--out", str(out), "--target", name]) == 0
    texts = files_of(TARGETS[name])
    assert written(out) == set(texts)
    first, *listed, following = capsys.readouterr().out.splitlines()
    assert first.startswith(f"{out} written: {TARGETS[name].about}, {len(texts)} files")
    assert [line.strip() for line in listed] == sorted(texts)
    assert following.startswith("next: ")
    assert str(out) in following
    assert not any(VERSION_MARK in (out / path).read_text() for path in texts)


def test_the_next_step_can_be_pasted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A folder with a blank is quoted, and Zephyr gets an absolute path."""
    monkeypatch.chdir(tmp_path)
    assert main(["firmware", "--out", "my gyro", "--target", "zephyr"]) == 0
    following = capsys.readouterr().out.splitlines()[-1]
    assert following.endswith(f"'my gyro'/samples/yaw -- -DZEPHYR_EXTRA_MODULES='{tmp_path}/my gyro'")


def test_quiet_prints_nothing(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    library(tmp_path, "c")
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize("name", ["c", "arduino", "platformio", "zephyr", "esphome"])
def test_the_headers_are_one_file_for_all_chips(name: str, tmp_path: Path) -> None:
    """`gyrodrift.h` needs no other file, and the encoder of frames neither."""
    out = library(tmp_path, name)
    folder = out / (TARGETS[name].headers or ".")
    assert re.findall(r'^#include "', (folder / "gyrodrift.h").read_text(), re.MULTILINE) == []
    stamp, _, text = (folder / "gyrodrift_native.h").read_text().partition("\n")
    assert stamp == f"// SPDX-License-Identifier: MIT; gyrodrift {__version__}"
    assert text == (FILES / "c" / "gyrodrift_native.h").read_text()


@pytest.mark.parametrize("name", TARGETS)
def test_each_file_has_its_license_and_version(name: str, tmp_path: Path) -> None:
    out = library(tmp_path, name)
    bare = {"LICENSE", "library.json", ".gyrodrift-firmware.json"}
    files = [path for path in out.rglob("*") if path.is_file() and path.name not in bare]
    assert [path.name for path in files if f"MIT; gyrodrift {__version__}" not in path.read_text()] == []
    assert (out / "LICENSE").is_file()


def test_a_second_run_replaces_what_the_first_has_written(tmp_path: Path) -> None:
    """A newer version of gyrodrift does so too, because the record has the old hashes."""
    out = library(tmp_path, "c")
    header = out / "gyrodrift.h"
    before = header.read_text()
    assert library(tmp_path, "c", "--config", calibrated_config(tmp_path)) == out
    assert header.read_text() == before
    assert (out / "my_gyro.h").is_file()


def test_a_changed_file_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = library(tmp_path, "c")
    (out / "main.c").write_text("mine\n")
    (out / "notes.txt").write_text("mine too\n")
    assert main(["firmware", "--out", str(out)]) == 2
    statement = capsys.readouterr().err
    reason = "not as gyrodrift firmware wrote it; choose another --out, or --force replaces it"
    assert statement == f"gyrodrift: {out / 'main.c'}: {reason}\n"
    assert (out / "main.c").read_text() == "mine\n"
    assert library(tmp_path, "c", "--force") == out
    assert (out / "main.c").read_text() != "mine\n"
    assert (out / "notes.txt").read_text() == "mine too\n"


def test_a_file_of_another_origin_is_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "CMakeLists.txt").write_text("project(robot)\n")
    assert main(["firmware", "--out", str(tmp_path)]) == 2
    assert "CMakeLists.txt: not as gyrodrift firmware wrote it" in capsys.readouterr().err
    assert written(tmp_path) == {"CMakeLists.txt"}


def test_a_damaged_record_protects_all_files(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file with the text that is to be written is no loss; any other one is."""
    out = library(tmp_path, "c")
    (out / ".gyrodrift-firmware.json").write_text("[")
    assert library(tmp_path, "c") == out
    (out / ".gyrodrift-firmware.json").write_text("[]")
    (out / "main.c").write_text("old\n")
    assert main(["firmware", "--out", str(out)]) == 2
    assert f"{out / 'main.c'}: not as" in capsys.readouterr().err


def test_a_folder_that_cannot_be_written_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A file of that name, for instance."""
    (tmp_path / "taken").write_text("")
    assert main(["firmware", "--out", str(tmp_path / "taken")]) == 2
    assert f"gyrodrift: {tmp_path / 'taken'}: cannot be written to: File exists" in capsys.readouterr().err


def test_a_name_that_arduino_does_not_load_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["firmware", "--out", str(tmp_path / "my gyro"), "--target", "arduino"]) == 2
    assert "Arduino loads libraries from folders named with letters" in capsys.readouterr().err
    assert not (tmp_path / "my gyro").exists()


def filtered(table: Path, *words: str) -> "np.ndarray[tuple[int], np.dtype[np.void]]":
    out = table.with_name("filtered.csv")
    assert main(["filter", str(table), "--out", str(out), "--force", "--quiet", *words]) == 0
    return np.genfromtxt(out, delimiter=",", names=True)


def a_session(folder: Path) -> Path:
    """A minute of the simulated rig as a table."""
    assert main(["simulate", "--out", str(folder / "sim"), "--minutes", "1", "--quiet"]) == 0
    table = folder / "session.csv"
    assert main(["convert", str(folder / "sim" / "session-01.mcap"), str(table), "--quiet"]) == 0
    return table


@pytest.mark.parametrize("is_calibrated", [False, True])
@pytest.mark.parametrize("name", ["hdr", "restlevel"])
def test_the_c_library_is_built_with_cmake_and_filters_as_python_does(
    name: str,
    is_calibrated: bool,  # noqa: FBT001 - a parameter
    tmp_path: Path,
) -> None:
    words = ["--config", str(calibrated_config(tmp_path, name, device_id=""))] if is_calibrated else []
    out = library(tmp_path, "c", *words)
    cmake_built(out, out / "build")
    table = a_session(tmp_path)
    printed = run("sh", "-c", f"{out}/build/gyrodrift_example {name} < {table}")
    rows = np.genfromtxt(io.StringIO(printed), delimiter=",", names=True)
    expected = filtered(table, *(words or ["--filter", name]))
    assert len(rows) == len(expected) == 6000
    for column in ("rate_dps", "yaw_deg", *(("yaw_sigma_deg", "bias_dps") if name == "restlevel" else ())):
        np.testing.assert_allclose(rows[column], expected[column], rtol=0, atol=1e-9)


def test_a_table_without_columns_is_told(tmp_path: Path) -> None:
    out = library(tmp_path, "c")
    cmake_built(out, out / "build")
    done = subprocess.run([out / "build" / "gyrodrift_example"], input=b"a,b\n1,2\n", capture_output=True, check=False)
    assert (done.returncode, done.stdout) == (1, b"")
    assert done.stderr == b"the first line names no columns t_device_s and rate_dps\n"


def test_a_project_takes_the_folder_as_an_interface_library(tmp_path: Path) -> None:
    out = library(tmp_path, "c")
    (tmp_path / "CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.13)\nproject(robot C)\n"
        f"add_subdirectory({out.name})\nadd_executable(robot robot.c)\ntarget_link_libraries(robot PRIVATE gyrodrift)\n"
    )
    (tmp_path / "robot.c").write_text(
        '#include "gyrodrift.h"\nint main(void) { gd_hdr h; return gd_hdr_init(&h, NULL) - 1; }\n'
    )
    cmake_built(tmp_path, tmp_path / "build")
    assert run(tmp_path / "build" / "robot") == ""
    assert not list((tmp_path / "build").rglob("gyrodrift_example*"))


def test_the_version_is_that_of_gyrodrift(tmp_path: Path) -> None:
    assert f"\nversion={__version__}\n" in (library(tmp_path, "arduino") / "library.properties").read_text()
    assert f"VERSION {__version__} " in (library(tmp_path, "c") / "CMakeLists.txt").read_text()
