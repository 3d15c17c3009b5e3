"""Text from outside in a unit file of systemd and a rule of udev: read back, it is one word and itself."""

import re
import shutil
import subprocess
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.service.install import (
    CONTROL,
    RULES,
    UNIT,
    UsbIdentity,
    command_line,
    file_url,
    files,
    plain_text,
    usb_identity,
)
from gyrodrift.values.errors import UsageError

HARD = st.text(st.sampled_from("ab /\\\"'%$;{}[]*?|=,!+\n\r\t\0\x1b\x85\u2028ä\udc80"), max_size=12) | st.text(
    max_size=40
)
RULE = re.compile(r'(?:[A-Z]+(?:\{[A-Za-z_]+\})?(?:==|\+=)"[^"\\\n]*"(?:, |$))+')
"""A line of a rule: key, operator and a quoted value, again and again (udev(7))."""


def words_of(line: str) -> list[str]:
    """The words of a command line by systemd.service(5) and systemd.syntax(7): quotes, escapes, `%%` and `$$`."""
    words = re.findall(r'"((?:[^"\\]|\\.)*)"|([^\s"\']+)', line)
    assert re.sub(r'"(?:[^"\\]|\\.)*"|[^\s"\']+', "", line).strip(" ") == ""
    result = [re.sub(r"\\(.)", r"\1", quoted) if quoted else plain for quoted, plain in words]
    assert all(set(re.findall(r"%.?|\$.?", word)) <= {"%%", "$$"} for word in result)
    return [word.replace("%%", "%").replace("$$", "$") for word in result]


def exec_start(unit: str) -> list[str]:
    """The command that a unit starts, of which there is one."""
    (line,) = [line for line in unit.split("\n") if line.startswith("ExecStart=")]
    return words_of(line.removeprefix("ExecStart=").removesuffix(f" --control {CONTROL}"))


@given(st.lists(HARD.filter(bool), min_size=1))
def test_a_command_line_gives_its_words_back_or_is_refused(words: list[str]) -> None:
    try:
        line = command_line(["/usr/bin/python3", *words])
    except UsageError:
        assert not all(word.isprintable() for word in words)
        return
    assert line.isprintable()
    assert words_of(line) == ["/usr/bin/python3", *words]


@given(HARD)
def test_a_description_and_an_address_hold_no_character_that_means_anything(text: str) -> None:
    assert re.fullmatch(r"[A-Za-z0-9/_.:,+=@~-]*", plain_text(text))
    if text.isprintable():
        assert re.fullmatch(r"file:///(?:[A-Za-z0-9/_.~-]|%%[0-9A-F]{2})*", file_url(f"/{text}"))


@given(HARD)
def test_a_unit_has_the_same_settings_whatever_the_port_and_the_config_are_called(text: str) -> None:
    usual = files("/dev/ttyUSB0", None, [], None)[UNIT].split("\n")
    try:
        lines = files(f"/dev/{text}", Path(f"/etc/x{text.replace(chr(0), '')}.yaml"), [], None)[UNIT].split("\n")
    except UsageError:
        assert not text.isprintable()
        return
    differing = [new.partition("=")[0] for old, new in zip(usual, lines, strict=True) if old != new]
    assert set(differing) <= {"Description", "ExecStart", "ProtectHome"}
    words = exec_start("\n".join(lines))
    assert words[words.index("--port") + 1] == f"/dev/{text}"


@given(HARD)
def test_a_serial_number_cannot_add_to_a_rule(serial: str) -> None:
    """A rule is two lines with the usual keys; a character that means something is `?`, which is any one byte."""
    rule = files("/dev/ttyUSB0", None, [], UsbIdentity("10c4", "ea60", serial))[RULES]
    comment, line, end = rule.split("\n")
    assert (comment[0], end) == ("#", "")
    assert RULE.fullmatch(line)
    keys = re.findall(r"(?:^|, )([A-Z]+(?:\{\w+\})?)", line)
    serials = ["ATTRS{serial}"] if serial else []
    assert keys == [
        "SUBSYSTEM",
        "ATTRS{idVendor}",
        "ATTRS{idProduct}",
        *serials,
        "SYMLINK",
        "TAG",
        "ENV{SYSTEMD_WANTS}",
    ]
    assert all(re.fullmatch(r"[A-Za-z0-9_.:?*-]*", value) for value in re.findall(r'ATTRS\{serial\}=="([^"]*)"', line))


def test_a_serial_number_is_read_as_bytes_and_matched_as_far_as_it_is_plain(tmp_path: Path) -> None:
    adapter = tmp_path / "usb1" / "1-2"
    (adapter / "tty").mkdir(parents=True)
    (tmp_path / "class" / "ttyUSB7").mkdir(parents=True)
    (tmp_path / "class" / "ttyUSB7" / "device").symlink_to(adapter / "tty")
    for name, value in {"idVendor": b"10c4\n", "idProduct": b"ea60\n", "serial": b'A7"\nRUN+="\xff \n'}.items():
        (adapter / name).write_bytes(value)
    usb = usb_identity("/dev/ttyUSB7", tmp_path / "class")
    assert usb is not None
    assert 'ATTRS{serial}=="A7??RUN????", SYMLINK' in files("/dev/ttyUSB7", None, [], usb)[RULES]


@pytest.mark.parametrize("number", ["", "10c", '10c4", RUN+="/bin/true', "10c4\n", "*"])
def test_a_number_of_an_adapter_is_four_digits_or_no_rule_is_written(number: str) -> None:
    for usb in (UsbIdentity(number, "ea60"), UsbIdentity("10c4", number)):
        with pytest.raises(UsageError, match="four hexadecimal digits"):
            files("/dev/ttyUSB0", None, [], usb)


@pytest.mark.parametrize("program", ['/opt/a"b/python', "/opt/a'b/python", "/opt/a$b/python", "/opt/a\\b/python"])
def test_a_program_that_systemd_does_not_take_is_refused(program: str) -> None:
    with pytest.raises(UsageError, match="systemd runs no program"):
        command_line([program])


def test_a_port_that_looks_like_an_option_is_refused() -> None:
    """Standard input among them: a service has none."""
    for port in ("-", "--config"):
        with pytest.raises(UsageError, match="a service needs a port"):
            files(port, None, [], None)


@pytest.mark.skipif(shutil.which("systemd-analyze") is None, reason="systemd-analyze is not installed")
def test_systemd_takes_a_unit_with_hard_words(tmp_path: Path) -> None:
    """Spaces, quotes, a percent sign, a dollar and a backslash in port and config."""
    config = tmp_path / "a b'c\"d%h$e;\\.yaml"
    unit = tmp_path / "gyrodrift.service"
    unit.write_text(files("/dev/a b'\"%i$HOME\\", config, [], None)[UNIT])
    verified = subprocess.run(["systemd-analyze", "verify", unit], capture_output=True, text=True, check=False)
    assert (verified.returncode, verified.stderr) == (0, "")
