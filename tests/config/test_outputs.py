"""Outputs in the config and on the command line: what is taken, and what is said of every mistake."""

from pathlib import Path

import pytest

from gyrodrift.config.model import load_config
from gyrodrift.config.outputs import options_help, output_of
from gyrodrift.outputs.line_output import TcpOptions
from gyrodrift.outputs.options import OutputSpec
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.outputs.udp import UdpOptions
from gyrodrift.values.errors import ConfigError, UsageError

HDR = "hdr: {i_c_dps: 1e-3, tau_s: .5, theta_w_dps: 1, c1: 0, c2: 1}\n"


def problems(path: Path, outputs: str) -> list[str]:
    path.write_text(HDR + outputs)
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    return [problem.partition(" ")[2] for problem in caught.value.problems]


def test_outputs_are_a_list_of_blocks_with_a_name(tmp_path: Path) -> None:
    """Options that are not given have their defaults; the same one twice is one."""
    path = tmp_path / "c.yaml"
    path.write_text(HDR + "outputs:\n  - {name: tcp, port: 7000, rate_hz: 10}\n  - {name: udp}\n  - {name: udp}\n")
    config = load_config(path)
    assert config.outputs == (OutputSpec("tcp", TcpOptions(port=7000, rate_hz=10.0)), OutputSpec("udp", UdpOptions()))
    path.write_text(HDR + "outputs:\n")
    assert load_config(path).outputs == ()
    assert load_config(path).changes_from(config) == [
        "outputs: tcp:port=7000,rate_hz=10.0 is closed",
        "outputs: udp is closed",
    ]


@pytest.mark.parametrize(
    ("outputs", "expected"),
    [
        ("outputs: tcp\n", "outputs: is 'tcp' (text); expected a list of blocks such as - {name: tcp}"),
        ("outputs: [tcp]\n", "outputs.0: is 'tcp' (text); expected a block with a name: "),
        ("outputs: [{port: 1}]\n", "outputs.0: is a block of keys; expected a block with a name: tcp, unix, udp"),
        ("outputs: [{name: tpc}]\n", "outputs.0.name: 'tpc' (text) is not an output; did you mean tcp?"),
        ("outputs: [{name: 7}]\n", "outputs.0.name: 7 is not an output; expected tcp, unix, udp"),
        ("outputs: [{name: tcp, prot: 1}]\n", "outputs.0.prot: is not an option of tcp; did you mean port?"),
        ("outputs: [{name: tcp, port: 70000}]\n", "outputs.0.port: is 70000; expected a whole number from 0 to 65535"),
        ("outputs: [{name: tcp, port: 1.5}]\n", "outputs.0.port: is 1.5; expected a whole number from 0 to 65535"),
        ("outputs: [{name: tcp, host: 5}]\n", "outputs.0.host: is 5; expected a name or an address"),
        (
            "outputs: [{name: tcp, rate_hz: fast}]\n",
            "outputs.0.rate_hz: is 'fast' (text); expected a number above 0 up to 1e+06 Hz",
        ),
        ("outputs: [{name: udp, timestamp: mine}]\n", "outputs.0.timestamp: is 'mine' (text); expected host or device"),
    ],
)
def test_a_mistake_is_named_with_its_place_and_what_is_expected(tmp_path: Path, outputs: str, expected: str) -> None:
    (statement,) = problems(tmp_path / "c.yaml", outputs)
    assert statement.startswith(expected)


def test_the_command_line_takes_the_same() -> None:
    """Text where the option is text, numbers elsewhere."""
    assert output_of("tcp") == OutputSpec("tcp", TcpOptions())
    assert output_of("tcp:port=7000,rate_hz=1e2,host=::1") == OutputSpec("tcp", TcpOptions("::1", 7000, 100.0))
    assert output_of("unix:path=7").options.path == "7"


@pytest.mark.parametrize(
    ("argument", "expected"),
    [
        ("mqt", "--output mqt: 'mqt' (text) is not an output; "),
        ("tcp:rate=10", "--output tcp:rate=10: rate: is not an option of tcp; did you mean rate_hz?"),
        ("tcp:port", "--output tcp:port: 'port': expected key=value"),
        ("tcp:port=x", "--output tcp:port=x: port: is 'x' (text); expected a whole number from 0 to 65535"),
    ],
)
def test_a_mistake_on_the_command_line_is_one_line(argument: str, expected: str) -> None:
    with pytest.raises(UsageError) as caught:
        output_of(argument)
    assert str(caught.value).startswith(expected)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("words", ['"x":1,' * 5000, "tcp:" + ",".join(f"k{i}=1" for i in range(5000))])
def test_an_argument_of_thousands_of_options_is_refused_at_once(words: str) -> None:
    with pytest.raises(UsageError, match=r"--output .*: has 5000 options, more than any output has"):
        output_of(words)


@pytest.mark.parametrize("name", OUTPUTS)
def test_every_option_is_explained(name: str) -> None:
    assert all(meaning.partition(" (")[0] for _, _, meaning in options_help(name))
