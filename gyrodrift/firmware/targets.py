"""Targets of `gyrodrift firmware`: the files of a library in the layout of each tool chain."""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from gyrodrift import __version__
from gyrodrift.firmware.micropython import restlevel_py
from gyrodrift.firmware.my_gyro import TunedGyro, my_gyro_h, my_gyro_py
from gyrodrift.firmware.parameters import FILTERS_FOLDER
from gyrodrift.firmware.switched import SWITCH, contents, mark, switched

ROOT_PART = "gyrodrift.h"
"""Part that includes all others, with the comment at the head of the result."""

GUARD = re.compile(r"#ifndef (GD_\w+_H|GYRODRIFT_H)\n#define \1\n(.*)#endif\n\Z", re.DOTALL)

INCLUDE = re.compile(r'^#include "(\w+\.h)"\n', re.MULTILINE)


def gyrodrift_h() -> str:
    """Text of `gyrodrift.h` for users, with its contents and switches at the head."""
    guard = "#define GYRODRIFT_H\n"
    head, _, body = joined(ROOT_PART).partition(guard)
    listed = contents((part for part in _in_order(ROOT_PART, set()) if part != ROOT_PART), body)
    version = f'#define GYRODRIFT_RELEASE "{__version__}"\n'
    return f"{head}{guard}{version}\n{listed}\n\n{SWITCH}{switched(body)}"


def joined(part: str) -> str:
    """One header of a part and all parts that it includes, each once and in the order of need."""
    head, body = _head_and_body(part)
    guard = part.upper().replace(".", "_")
    needed = [name for name in _in_order(part, set()) if name != part]
    texts = [mark(name, _text_alone(name)) + _text_alone(name) for name in needed] + [INCLUDE.sub("", body).strip()]
    inner = "\n\n".join(text for text in texts if text)
    return f"{head}#ifndef {guard}\n#define {guard}\n\n{inner}\n\n#endif\n"


def _in_order(part: str, visited: set[str]) -> Iterator[str]:
    """Names of a part and of those that it needs, which come first; `visited` is changed."""
    visited.add(part)
    for name in INCLUDE.findall(_head_and_body(part)[1]):
        if name not in visited:
            yield from _in_order(name, visited)
    yield part


def _text_alone(part: str) -> str:
    """Text of a part without its guard and its includes."""
    head, body = _head_and_body(part)
    return head + INCLUDE.sub("", body).strip()


def _head_and_body(part: str) -> tuple[str, str]:
    """Comment at the head of a part, and its text within the include guard."""
    text = (FILTERS_FOLDER / part).read_text(encoding="utf-8")
    match = GUARD.search(text)
    if match is None:
        raise ValueError(f"{part} has no include guard of the form GD_..._H")
    return text[: match.start()], match[2]


FILES = Path(__file__).parent / "files"
NATIVE_HEADER = FILES / "c" / "gyrodrift_native.h"
VERSION_MARK = "@VERSION@"
"""Text in a shipped file that becomes the version of gyrodrift."""

GYRO_HEADER = "my_gyro.h"
LICENSE = "LICENSE"

C_LINE, HASH, TAGS = "// {}", "# {}", "<!-- {} -->"
COMMENTS = {
    **dict.fromkeys((".h", ".c", ".cpp", ".ino", ".overlay"), C_LINE),
    **dict.fromkeys(
        (".py", ".yaml", ".yml", ".conf", ".properties", "CMakeLists.txt", "keywords.txt", "Kconfig"), HASH
    ),
    ".md": TAGS,
}
"""Comment of a line, by the ending or the name of a file."""


@dataclass(frozen=True, slots=True)
class Target:
    """A tool chain, and the layout of its library.

    name, about
        Value of `--target`, and its library in a few words.
    source
        Folder of `files` with everything but the headers.
    headers
        Folder of the library for the headers; None for a library without C.
    left_out
        Files of the source folder that this tool chain does not read.
    next_step
        Next step of the user; `{out}` is the folder of the library, `{absolute}` its absolute path.
    """

    name: str
    about: str
    source: str
    next_step: str
    headers: str | None = "."
    left_out: frozenset[str] = frozenset()


TARGETS = {
    target.name: target
    for target in (
        Target(
            "c",
            "a header for C and C++, with CMake",
            "cmake",
            "cmake -S {out} -B {out}/build && cmake --build {out}/build && {out}/build/gyrodrift_example < session.csv",
        ),
        Target(
            "arduino",
            "an Arduino library",
            "arduino",
            "open File > Examples > gyrodrift > SerialYaw in the Arduino IDE, if {out} is in its folder `libraries`; "
            "or arduino-cli compile --fqbn arduino:avr:uno --library {out} {out}/examples/SerialYaw",
            "src",
        ),
        Target(
            "platformio",
            "a PlatformIO library",
            "arduino",
            "pio ci {out}/examples/SerialYaw --lib {out} --board uno; or move {out} into `lib` of your project",
            "src",
            frozenset({"library.properties", "keywords.txt"}),
        ),
        Target(
            "esp-idf",
            "a component for ESP-IDF",
            "espidf",
            "move {out} into `components` of your project, and add REQUIRES gyrodrift to the component that uses it",
            "include",
        ),
        Target(
            "zephyr",
            "a Zephyr module",
            "zephyr",
            "west build -b BOARD {out}/samples/yaw -- -DZEPHYR_EXTRA_MODULES={absolute}",
            "include",
        ),
        Target(
            "esphome",
            "an ESPHome external component",
            "esphome",
            "esphome run {out}/example.yaml, after its pins and board are yours",
            "components/gyrodrift",
        ),
        Target(
            "micropython",
            "modules for MicroPython",
            "micropython",
            "mpremote cp {out}/*.py : and mpremote reset",
            None,
        ),
    )
}
"""Targets by name; the first is the default."""


def files_of(target: Target, gyro: TunedGyro | None = None) -> dict[str, str]:
    """Texts of a library by their path in its folder; with a config also the parameters of that gyro."""
    source = FILES / target.source
    texts = {
        str(PurePosixPath(path.relative_to(source).as_posix())): path.read_text(encoding="utf-8")
        for path in sorted(source.rglob("*"))
        if path.is_file() and path.name not in target.left_out and "__pycache__" not in path.parts
    }
    texts |= _modules(gyro) if target.headers is None else _headers(target.headers, gyro)
    texts |= {LICENSE: (FILES / "arduino" / LICENSE).read_text(encoding="utf-8")}
    return {path: _stamped(path, text.replace(VERSION_MARK, __version__)) for path, text in sorted(texts.items())}


def _stamped(path: str, text: str) -> str:
    """Text with the license and the version in a comment as its first line; JSON has fields for both."""
    pure = PurePosixPath(path)
    mark = COMMENTS.get(pure.suffix) or COMMENTS.get(pure.name)
    return text if mark is None else mark.format(f"SPDX-License-Identifier: MIT; gyrodrift {__version__}") + "\n" + text


def _headers(folder: str, gyro: TunedGyro | None) -> dict[str, str]:
    named = {"gyrodrift.h": gyrodrift_h(), NATIVE_HEADER.name: NATIVE_HEADER.read_text(encoding="utf-8")}
    if gyro is not None:
        named[GYRO_HEADER] = my_gyro_h(gyro, GYRO_HEADER)
    return {str(PurePosixPath(folder, name)): text for name, text in named.items()}


def _modules(gyro: TunedGyro | None) -> dict[str, str]:
    modules = {"gyrodrift_restlevel.py": restlevel_py()}
    return modules if gyro is None else {**modules, "my_gyro.py": my_gyro_py(gyro)}
