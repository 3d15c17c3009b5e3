"""Libraries of Arduino, PlatformIO, Zephyr and ESPHome: rules of their tools, as far as they can be checked here."""

import json
import re
import shutil
import subprocess
from pathlib import Path

import pytest
import yaml
from firmware_library import calibrated_config, library, need
from firmware_support import (
    ARDUINO,
    HERE,
    LEONARDO,
    LTO,
    MEGA,
    ROOT,
    STRICT,
    UNO,
    library_object,
    linked,
    run,
)
from support import quick

from gyrodrift import __version__

EXAMPLES = ("LSM6DS3", "MPU6050", "SerialYaw", "StreamWithYaw", "gyrodrift_gyro")
FLASH = 32 * 1024 - 512
"""Flash of an Uno without its boot loader, bytes."""

UNO_RAM = 2048
STACK = 350
"""Memory for the stack on an Uno, bytes: 258 of restlevel (benchmark/bench/test_filter_cycles.py), and interrupts."""

FIELDS = {"name", "version", "author", "maintainer", "sentence", "paragraph", "category", "url", "architectures"}
"""Required in library.properties (Arduino library specification)."""

CATEGORIES = {
    "Display",
    "Communication",
    "Signal Input/Output",
    "Sensors",
    "Device Control",
    "Timing",
    "Data Storage",
    "Data Processing",
    "Other",
}


@pytest.fixture(scope="module")
def arduino(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return library(tmp_path_factory.mktemp("libraries"), "arduino")


def properties(folder: Path) -> dict[str, str]:
    """Fields of library.properties."""
    lines = (folder / "library.properties").read_text().splitlines()
    return dict(line.split("=", 1) for line in lines if not line.startswith("#"))


def test_library_properties_fulfill_the_specification(arduino: Path) -> None:
    """Rules LP001 to LP046 of arduino-lint that need no network."""
    result = properties(arduino)
    assert result.keys() == FIELDS | {"includes"}
    assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9 _.-]{0,15}", result["name"])
    assert "arduino" not in result["name"].lower()
    assert re.fullmatch(r"\d+\.\d+\.\d+(-[0-9A-Za-z.-]+)?", result["version"])
    assert result["version"] == __version__
    assert result["category"] in CATEGORIES
    assert result["url"].startswith("https://")
    assert all(result.values())
    assert not result["paragraph"].startswith(result["sentence"])
    assert (arduino / "src" / result["includes"]).is_file()


def test_the_folder_is_laid_out_as_the_specification_says(arduino: Path) -> None:
    """Rules LS001 to LS010 and LD001 to LD004: header of the library's name, documents, no program files or links."""
    assert {path.name for path in arduino.iterdir() if path.name[0] != "."} == {
        "LICENSE",
        "README.md",
        "examples",
        "keywords.txt",
        "library.json",
        "library.properties",
        "src",
    }
    assert (arduino / "src" / f"{properties(arduino)['name']}.h").is_file()
    assert (arduino / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    for path in arduino.rglob("*"):
        assert not path.is_symlink()
        assert path.is_dir() or path.suffix in {".h", ".ino", ".json", ".md", ".properties", ".txt", ""}


def test_each_example_is_one_sketch_with_the_name_of_its_folder(arduino: Path) -> None:
    folders = sorted(path.name for path in (arduino / "examples").iterdir())
    assert tuple(folders) == EXAMPLES
    readme = (arduino / "README.md").read_text()
    for name in folders:
        assert [path.name for path in (arduino / "examples" / name).glob("*.ino")] == [f"{name}.ino"]
        assert re.fullmatch(r"[A-Za-z0-9][A-Za-z0-9_.-]{0,62}", name)
        assert name in readme


def test_keywords_are_separated_by_tabs_and_exist(arduino: Path) -> None:
    """Rules of keywords.txt; a keyword that the headers do not have colors nothing."""
    headers = "".join(path.read_text() for path in (arduino / "src").glob("*.h"))
    lines = [line for line in (arduino / "keywords.txt").read_text().splitlines() if not line.startswith("#")]
    for line in lines:
        word, kind = line.split("\t")
        assert kind in {"KEYWORD1", "KEYWORD2", "LITERAL1"}
        assert re.search(rf"\b{word}\b", headers), word


@pytest.mark.parametrize("target", ["arduino", "platformio"])
def test_library_json_has_the_documented_fields(target: str, tmp_path: Path) -> None:
    out = library(tmp_path, target)
    manifest = json.loads((out / "library.json").read_text())
    assert manifest.keys() == {
        *("name", "version", "description", "keywords", "authors", "license", "frameworks", "platforms"),
        *("headers", "examples"),
    }
    assert re.fullmatch(r"\d+\.\d+\.\d+", manifest["version"])
    assert len(manifest["description"]) <= 255
    assert all(re.fullmatch(r"[a-z0-9-]{2,50}", word) for word in manifest["keywords"].split(", "))
    assert {example["name"] for example in manifest["examples"]} == set(EXAMPLES)
    for example in manifest["examples"]:
        assert all((out / example["base"] / file).is_file() for file in example["files"])
    assert all((out / "src" / header).is_file() for header in manifest["headers"])
    assert (out / "library.properties").exists() == (target == "arduino")


@pytest.mark.parametrize("name", EXAMPLES)
def test_each_example_fits_an_uno(name: str, arduino: Path, tmp_path: Path) -> None:
    """Compiled and linked without a warning, with the core of Debian; flash and memory as avr-size counts them."""
    elf = linked(library_object(arduino, name, tmp_path, *UNO, *LTO), tmp_path)
    _, sizes = run("avr-size", elf).splitlines()
    text, data, bss = map(int, sizes.split()[:3])
    print(f"{name}: {text + data} bytes of flash, {data + bss} bytes of memory")
    assert text + data <= FLASH
    assert data + bss <= UNO_RAM - STACK


@pytest.mark.parametrize("name", quick(EXAMPLES, "StreamWithYaw"))
def test_the_builder_of_the_ide_takes_each_example(name: str, arduino: Path, tmp_path: Path) -> None:
    builder, ctags = shutil.which("arduino-builder"), shutil.which("arduino-ctags")
    if builder is None or ctags is None or not ARDUINO.is_dir():
        pytest.skip("there is no arduino-builder: apt-get install arduino-builder arduino-core-avr")
    hardware = Path(builder).parent.parent / "share" / "arduino-builder"
    words = ["-hardware", ARDUINO.parent.parent, "-hardware", hardware, "-tools", "/usr/bin", "-tools", hardware]
    prefs = ["runtime.tools.avr-gcc.path=/usr", f"tools.ctags.cmd.path={ctags}"]
    prefs.append("compiler.cpp.extra_flags=-DDECIMAL_DIG=17")  # as in CORE
    words += [word for pref in prefs for word in ("-prefs", pref)]
    words += ["-libraries", arduino.parent, "-fqbn", "arduino:avr:uno", "-build-path", tmp_path, "-warnings", "all"]
    words += ["-build-cache", arduino.parent]  # of the core
    sketch = arduino / "examples" / name / f"{name}.ino"
    done = subprocess.run(
        [builder, "-compile", *map(str, words), str(sketch)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert [line for line in done.stderr.splitlines() if str(arduino) in line and "warning" in line] == []
    print(*re.findall(r"(?:Sketch|Global).*", done.stdout), sep="\n")


@pytest.mark.parametrize("board", [MEGA, LEONARDO], ids=["mega", "leonardo"])
@pytest.mark.parametrize("name", quick(EXAMPLES, "SerialYaw", "gyrodrift_gyro"))
def test_each_example_is_compiled_for_other_avr_boards(
    name: str, board: tuple[str, ...], arduino: Path, tmp_path: Path
) -> None:
    """A Mega has flash for restlevel."""
    names = run("avr-nm", "-C", library_object(arduino, name, tmp_path, *board))
    assert "setup" in names
    if board is MEGA and name in ("SerialYaw", "MPU6050", "LSM6DS3"):
        assert "gd_rl_" in names


@pytest.mark.parametrize("core", quick(("ESP32", "ESP8266", "ARDUINO_ARCH_RP2040"), "ESP32"))
@pytest.mark.parametrize("name", EXAMPLES)
def test_each_example_is_compiled_where_numbers_have_32_bits(name: str, core: str, arduino: Path) -> None:
    """Against what such a core declares, without a warning."""
    need("c++", "g++")
    include = [f"-I{arduino / 'src'}", f"-I{HERE / 'other_core'}", "-include", "Arduino.h"]
    sketch = arduino / "examples" / name / f"{name}.ino"
    assert run("c++", "-std=gnu++17", *STRICT, f"-D{core}", *include, "-fsyntax-only", "-x", "c++", sketch) == ""


@pytest.mark.parametrize("name", quick(("MPU6050", "LSM6DS3"), "MPU6050"))
def test_an_example_with_a_calibration_fits_an_uno(name: str, tmp_path: Path) -> None:
    out = library(tmp_path, "arduino", "--config", calibrated_config(tmp_path))
    elf = linked(library_object(out, name, tmp_path, *UNO, *LTO), tmp_path)
    _, sizes = run("avr-size", elf).splitlines()
    text, data, bss = map(int, sizes.split()[:3])
    print(f"{name}: {text + data} bytes of flash, {data + bss} bytes of memory")
    assert text + data <= FLASH
    assert data + bss <= UNO_RAM - STACK


def test_examples_take_the_calibration_of_the_library(tmp_path: Path) -> None:
    (tmp_path / "my.yaml").write_text("filter: hdr\nhdr: {i_c_dps: 0.001}\n")
    out = library(tmp_path, "arduino", "--config", tmp_path / "my.yaml")
    assert (out / "src" / "my_gyro.h").is_file()
    need("c++", "g++")
    include = [f"-I{out / 'src'}", f"-I{HERE / 'other_core'}", "-include", "Arduino.h"]
    sketch = out / "examples" / "MPU6050" / "MPU6050.ino"
    printed = run("c++", "-std=gnu++17", *STRICT, "-DESP32", *include, "-E", "-x", "c++", sketch)
    assert "MY_GYRO_CALIBRATION =" in printed


def test_the_zephyr_module_names_files_that_exist(tmp_path: Path) -> None:
    """Keys as in Zephyr's scripts/zephyr_module.py; options of Kconfig that CMake and the sample use are declared."""
    out = library(tmp_path, "zephyr")
    module = yaml.safe_load((out / "zephyr" / "module.yml").read_text())
    assert module.keys() == {"name", "build", "samples"}
    assert (out / module["build"]["cmake"] / "CMakeLists.txt").is_file()
    assert (out / module["build"]["kconfig"]).is_file()
    assert all((out / folder).is_dir() for folder in module["samples"])
    declared = set(re.findall(r"^config (\w+)$", (out / "Kconfig").read_text(), re.MULTILINE))
    texts = [path.read_text() for path in out.rglob("*") if path.is_file() and path.suffix != ".h"]
    assert set(re.findall(r"CONFIG_(GYRODRIFT\w*)", "".join(texts))) == declared
    sample = yaml.safe_load((out / "samples" / "yaw" / "sample.yaml").read_text())
    assert sample["tests"].keys() == {"gyrodrift.sample.yaw"}


def test_the_zephyr_sample_compiles_against_its_declarations(tmp_path: Path) -> None:
    need("cc", "gcc")
    out = library(tmp_path, "zephyr")
    include = [f"-I{HERE / 'zephyr_stubs'}", f"-I{out / 'include'}"]
    words = ["cc", "-std=c11", *STRICT, "-Wdouble-promotion", *include, "-fsyntax-only"]
    assert run(*words, out / "samples" / "yaw" / "src" / "main.c") == ""


@pytest.mark.parametrize("has_config", ["defaults", "my_gyro.h"])
def test_the_esphome_component_compiles_against_its_declarations(has_config: str, tmp_path: Path) -> None:
    need("c++", "g++")
    (tmp_path / "my.yaml").write_text("filter: hdr\n")
    extra: list[str | Path] = [] if has_config == "defaults" else ["--config", tmp_path / "my.yaml"]
    component = library(tmp_path, "esphome", *extra) / "components" / "gyrodrift"
    include = [f"-I{HERE / 'esphome_stubs'}", f"-I{component}"]
    assert run("c++", "-std=gnu++20", *STRICT, *include, "-fsyntax-only", component / "gyro_yaw.cpp") == ""


def test_esphome_accepts_the_example(tmp_path: Path) -> None:
    """`esphome config` checks the schema, and `compile --only-generate` writes the program that sets it up."""
    esphome = shutil.which("esphome")
    if esphome is None:
        pytest.skip("esphome is not installed: pipx install esphome")
    out = library(tmp_path, "esphome")
    checked = subprocess.run([esphome, "config", "example.yaml"], cwd=out, capture_output=True, text=True, check=False)
    assert checked.returncode == 0, checked.stdout + checked.stderr
    words = [esphome, "compile", "--only-generate", "example.yaml"]
    made = subprocess.run(words, cwd=out, capture_output=True, text=True, check=False)
    assert made.returncode == 0, made.stdout + made.stderr
    (program,) = (out / ".esphome").rglob("src/main.cpp")
    assert "set_kind(gyrodrift_yaw::RESTLEVEL)" in program.read_text()


def test_the_core_of_debian_is_that_of_the_ide() -> None:
    platform = ARDUINO / "platform.txt"
    if not platform.is_file():
        pytest.skip("there is no core: apt-get install arduino-core-avr")
    assert "-Os" in platform.read_text()
