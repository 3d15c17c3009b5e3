"""Several gyros in one config: links, blocks of their own, and mistakes with their lines."""

from pathlib import Path

import pytest

from gyrodrift.config.model import load_config
from gyrodrift.config.sources import SourceSettings, load_sources
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.values.errors import ConfigError

TWO = """\
sources:
  left:
    port: /dev/ttyUSB0
    baud: 115200
    hdr: {tau_s: 0.5}
    outputs: [{name: udp, port: 9871}]
  right:
    port: udp://:5000
    protocol: csv
    timeout: 20
    filter: restlevel
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "two.yaml"
    path.write_text(text)
    return path


def test_each_source_has_a_link_and_a_config_of_its_own(tmp_path: Path) -> None:
    path = written(tmp_path, TWO)
    assert load_sources(path) == (
        SourceSettings("left", "/dev/ttyUSB0", 115200),
        SourceSettings("right", "udp://:5000", None, "csv", 20.0),
    )
    first, second = load_config(path, "left"), load_config(path, "right")
    assert (first.filter, first.blocks["hdr"], len(first.outputs)) == ("hdr", HdrParams(tau_s=0.5), 1)
    assert (second.filter, second.outputs) == ("restlevel", ())


def test_two_sources_read_the_senders_of_one_server(tmp_path: Path) -> None:
    text = "sources:\n" + "".join(
        f"  {node}:\n    port: tcp://hub:3333\n    columns: node={node}, gz=rate:dps\n" for node in ("left", "right")
    )
    path = written(tmp_path, text)
    assert [entry.port for entry in load_sources(path)] == ["tcp://hub:3333"] * 2
    assert [load_config(path, node).columns for node in ("left", "right")] == [
        "node=left, gz=rate:dps",
        "node=right, gz=rate:dps",
    ]


def test_a_config_of_one_gyro_has_no_sources(tmp_path: Path) -> None:
    assert load_sources(written(tmp_path, "filter: hdr\n")) == ()


def test_a_command_for_one_gyro_refuses_several(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"two.yaml:1:1 sources: is for serve without --port"):
        load_config(written(tmp_path, TWO))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("filter: hdr\n" + TWO, "1:1 filter: belongs to a source; move it below sources: NAME:"),
        ("sources: []\n", "1:1 sources: is a list; expected 1 to 32 blocks"),
        ("sources: {}\n", "1:1 sources: is a block of keys; expected 1 to 32 blocks"),
        ("sources:\n  left:\n    filter: hdr\n", "2:3 sources.left: has no port; expected port:"),
        ("sources:\n  ../x: {port: a}\n", "is no name; expected up to 32 letters"),
        ("sources:\n  a: {port: x, baud: fast}\n", "2:16 sources.a.baud: is 'fast' (text); expected a whole number"),
        ("sources:\n  a: {port: x, timeout: -1}\n", "sources.a.timeout: is -1; expected s, 0 waits for ever"),
        ("sources:\n  a: {port: x, protocol: cvs}\n", "sources.a.protocol: is not a protocol; did you mean csv"),
        ("sources:\n  a: {port: x}\n  b: {port: x}\n", "2:7 sources.a.port: is used by two sources"),
    ],
)
def test_a_mistake_is_said_with_its_place(tmp_path: Path, text: str, expected: str) -> None:
    with pytest.raises(ConfigError) as caught:
        load_sources(written(tmp_path, text))
    assert expected in str(caught.value)


def test_a_mistake_inside_a_source_has_its_whole_key(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"two.yaml:3:11 sources.a.hdr.tau_s: is 'x'"):
        load_config(written(tmp_path, "sources:\n  a:\n    hdr: {tau_s: x}\n"), "a")


def test_a_source_that_was_removed_is_said(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"sources.middle: is missing; restart the service without it"):
        load_config(written(tmp_path, TWO), "middle")
