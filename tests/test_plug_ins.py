"""Plug-ins of other packages: the examples of the docs work; a broken package is one line and harms nothing else."""

import argparse
import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from outputs_support import corrected, hub
from plug_in_support import EXAMPLES, Site

from firmware_sim.effects import catalogue
from firmware_sim.wire import registry
from gyrodrift.cli import main, simulated_device
from gyrodrift.cli.plug_ins import REGISTRIES, listing
from gyrodrift.config.model import load_config
from gyrodrift.io.plug_ins import API, PlugInError, PlugIns
from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.sources.registry import source_named
from gyrodrift.outputs.registry import OUTPUTS
from gyrodrift.simulation.effects import load

ROOT = Path(__file__).parent.parent
REMEDY, OLDER = (
    "install another version of it, or uninstall it",
    "install an older version of newer, or a newer gyrodrift",
)
KINDS = sorted(path.name for path in EXAMPLES.iterdir())


@pytest.fixture
def site(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Site]:
    """A place for packages, which are gone after the test."""
    folder = tmp_path / "site"
    folder.mkdir()
    monkeypatch.syspath_prepend(folder)
    yield Site(folder)
    for path in folder.glob("*.py"):
        sys.modules.pop(path.stem, None)
    for module, _, name in (place.partition(":") for place in REGISTRIES.values()):
        loaded = getattr(sys.modules[module], name)._loaded
        for entry in [entry for entry in loaded if entry.folder == str(folder)]:
            del loaded[entry]


def a_registry(what: str = "thing") -> PlugIns[object]:
    return PlugIns(what, lambda entry, value: value)


@pytest.mark.parametrize("kind", KINDS)
def test_an_example_is_short(kind: str) -> None:
    lines = [line for path in (EXAMPLES / kind).iterdir() for line in path.read_text().splitlines()]
    assert len(lines) <= 60


def test_there_is_an_example_of_each_group() -> None:
    assert {f"gyrodrift.{kind}s" for kind in KINDS} == {*REGISTRIES, "gyrodrift.commands"}


def test_the_output_takes_samples(site: Site, tmp_path: Path) -> None:
    assert site.install_example("output") in OUTPUTS
    with hub() as outputs:
        outputs.want(f"yaw_file:path={tmp_path / 'yaw.txt'}")
        outputs.opened()
        outputs.samples([corrected(seq=100)])
        while not (tmp_path / "yaw.txt").exists():
            pass
    assert (tmp_path / "yaw.txt").read_text() == "1.250\n"


def test_outputs_are_listed_with_their_options(site: Site, capsys: pytest.CaptureFixture[str]) -> None:
    site.install_example("output")
    site.install("bad", "gyrodrift.outputs", "gone", "bad:NAME", "")
    with pytest.raises(SystemExit, match=r"^0$"):
        main(["serve", "--list-outputs"])
    out, err = capsys.readouterr()
    assert "yaw_file: the newest yaw in a file\n  path=yaw.txt: file that gets the newest yaw (text)\n" in out
    assert err.startswith("gyrodrift: gone: the output of bad cannot be imported: AttributeError:")


def test_source_and_protocol_read_a_device(site: Site, tmp_path: Path) -> None:
    """Detection finds the protocol of a plug-in after bytes that gyrodrift does not understand."""
    site.install_example("source")
    site.install_example("protocol")
    pipe = tmp_path / "pipe"
    os.mkfifo(pipe)
    events: list[str] = []
    link = Link(LinkOptions(f"pipe:{pipe}"), lambda event, **_: events.append(event))
    with pipe.open("wb", buffering=0) as device:
        device.write(b"W1500!" * 60)
        link.read()
    link.close()
    assert events == ["link_open", "protocol_found", "no_device_clock"]
    assert (link.decoder.name, link.decoder.counters.frames) == ("milli", 60)  # type: ignore[union-attr]


def test_a_config_knows_a_filter(site: Site, tmp_path: Path) -> None:
    site.install_example("filter")
    path = tmp_path / "c.yaml"
    path.write_text("filter: fixed\nfixed: {bias_dps: 0.5}\n")
    config = load_config(path)
    assert (config.chosen.title, config.params.bias_dps) == ("fixed bias", 0.5)  # type: ignore[attr-defined]


def test_a_command_runs_a_filter(site: Site, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    site.install_example("filter")
    session = tmp_path / "s.csv"
    session.write_text("t_device_s,rate_dps\n" + "".join(f"{n / 50},1.0\n" for n in range(51)))
    assert main(["filter", str(session), "--filter", "fixed"]) == 0
    assert capsys.readouterr().out.splitlines()[-1].split(",")[3] == "1.0"


def test_the_simulated_device_sends_by_an_encoder(site: Site) -> None:
    name = site.install_example("encoder")
    parser = argparse.ArgumentParser()
    simulated_device.add_arguments(parser)
    try:
        assert parser.parse_args(["--link", "gyro", "--protocol", name]).protocol == name
    finally:
        registry.unregister(name)


def test_rigs_and_candidates_know_an_effect(site: Site) -> None:
    name = site.install_example("effect")
    try:
        assert name in [catalogue.name_of(effect) for effect in load()]
        assert catalogue.CATALOGUE[name].candidate.parameter == "bias_dps"
    finally:
        catalogue.unregister(name)


def test_help_lists_plug_ins_and_what_is_wrong_with_them(site: Site, capsys: pytest.CaptureFixture[str]) -> None:
    site.install_example("protocol")
    site.install("bad", "gyrodrift.sources", "gone", "bad", "raise SystemExit('no licence')")
    assert list(listing()) == [
        f"source gone: the source of bad cannot be imported: SystemExit: no licence; {REMEDY}",
        "protocol milli: rates in thousandths of a deg/s",
    ]
    assert main(["help"]) == 0
    assert "plug-ins of other packages:\n  source gone: " in capsys.readouterr().out
    assert main(["help", "record"]) == 0
    assert "from plug-ins: milli" in " ".join(capsys.readouterr().out.split())


@pytest.mark.parametrize(
    ("source", "reason"),
    [
        ("import not_there", "cannot be imported: ModuleNotFoundError: No module named 'not_there'"),
        ("raise SystemExit", "cannot be imported: SystemExit: "),
        ("raise ValueError('a\\nb')", "cannot be imported: ValueError: a"),
        ("NAME: int = 1\ndel NAME", "cannot be imported: AttributeError: module 'bad' has no attribute 'NAME'"),
        ("NAME = 1", "is no output: bad:NAME is no class derived from Output"),
        (
            "from gyrodrift.outputs.output import Output\nclass NAME(Output): ...",
            "is no output: bad:NAME has no options_type, the dataclass of its options",
        ),
    ],
)
def test_a_package_that_fails_is_one_line(source: str, reason: str, site: Site) -> None:
    site.install("bad", "gyrodrift.outputs", "toy", "bad:NAME", source)
    with pytest.raises(PlugInError) as caught:
        OUTPUTS["toy"]
    assert str(caught.value) == f"toy: the output of bad {reason}; {REMEDY}"
    assert "toy" not in list(OUTPUTS)


def test_a_plug_in_of_another_api_version_is_refused(site: Site) -> None:
    site.install("newer", "gyrodrift.things", "a", "newer", f"GYRODRIFT_API = {API + 1}")
    site.install("older", "gyrodrift.things", "b", "older", f"GYRODRIFT_API = {API - 1}")
    site.install("same", "gyrodrift.things", "c", "same", f"GYRODRIFT_API = {API}")
    registry = a_registry()
    assert list(registry) == ["c"]
    assert registry.problems() == [
        f"a: the thing of newer is for version {API + 1} of plug-ins, gyrodrift has {API}; {OLDER}",
        f"b: the thing of older is for version {API - 1} of plug-ins, gyrodrift has {API}; {REMEDY}",
    ]


def test_a_name_that_two_packages_offer_is_refused(site: Site) -> None:
    site.install("first", "gyrodrift.outputs", "toy", "first", "")
    site.install("second", "gyrodrift.outputs", "toy", "second", "")
    site.install("third", "gyrodrift.outputs", "tcp", "third", "")
    assert OUTPUTS.problems() == [
        "tcp: is an output of gyrodrift, and third adds another; uninstall that",
        "toy: is an output of first and of second; uninstall all but one",
    ]
    assert OUTPUTS["tcp"] is OUTPUTS.own["tcp"]


def test_a_record_with_another_name_is_refused(site: Site) -> None:
    source = (EXAMPLES / "source" / "yaw_pipe.py").read_text()
    site.install("liar", "gyrodrift.sources", "tube", "liar:PIPE", source)
    with pytest.raises(PlugInError, match="tube: the source of liar is no source: its scheme is 'pipe'"):
        source_named("tube")


@pytest.mark.parametrize(
    ("group", "words", "line"),
    [
        ("outputs", ["serve", "--port", "/dev/null", "--output", "toy"], "toy: the output of bad"),
        ("sources", ["serve", "--port", "toy:x"], "toy: the source of bad"),
        ("protocols", ["serve", "--port", "/dev/null", "--protocol", "toy"], "toy: the protocol of bad"),
        ("filters", ["serve", "--port", "/dev/null", "--filter", "toy"], "toy: the filter of bad"),
        ("effects", ["simulate", "--out", "s", "--effect", "toy"], "toy: the effect of bad"),
        ("commands", ["toy"], "toy: the command of bad"),
    ],
)
def test_a_broken_plug_in_that_is_named_is_told(
    group: str, words: list[str], line: str, site: Site, capsys: pytest.CaptureFixture[str]
) -> None:
    site.install("bad", f"gyrodrift.{group}", "toy", "bad", "1 / 0")
    assert main(words) in (2, 3)
    assert f"gyrodrift: {line} cannot be imported: ZeroDivisionError: division by zero;" in capsys.readouterr().err


def test_a_broken_filter_in_a_config_is_told_with_its_line(site: Site, tmp_path: Path) -> None:
    site.install("bad", "gyrodrift.filters", "toy", "bad", "1 / 0")
    path = tmp_path / "c.yaml"
    path.write_text("axes: 1\ntoy: {}\n")
    with pytest.raises(ValueError, match=r"c.yaml:2:1 toy: toy: the filter of bad cannot be imported: Zero"):
        load_config(path)


def test_a_filter_that_fails_while_it_works_is_one_line(
    site: Site, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    source = (EXAMPLES / "filter" / "fixed_bias.py").read_text()
    source = source.replace(
        "    if not (isf", '    if s.samples > 5:\n        raise RuntimeError("boom")\n    if not (isf'
    )
    site.install("bad", "gyrodrift.filters", "fixed", "bad:FIXED", source)
    session = tmp_path / "s.csv"
    session.write_text("t_device_s,rate_dps\n" + "".join(f"{n / 50},{1 + n % 2}\n" for n in range(51)))
    assert main(["filter", str(session), "--filter", "fixed"]) == 2
    line = r"gyrodrift: fixed: the filter of bad failed: RuntimeError: boom \(bad.py:\d+\); tell its authors, or go on"
    assert re.match(line, capsys.readouterr().err)


def test_a_protocol_without_all_of_a_decoder_is_refused(site: Site) -> None:
    source = (EXAMPLES / "protocol" / "milli_frames.py").read_text().replace('        self.unread = ""\n', "")
    site.install("bad", "gyrodrift.protocols", "milli", "bad:MILLI", source)
    assert PROTOCOLS.problems() == [f"milli: the protocol of bad is no protocol: its decoder has no unread; {REMEDY}"]


def test_what_a_package_prints_goes_to_stderr(site: Site, capsys: pytest.CaptureFixture[str]) -> None:
    site.install("chatty", "gyrodrift.things", "a", "chatty", "print('hello')")
    assert a_registry()["a"] is sys.modules["chatty"]
    assert capsys.readouterr() == ("", "hello\n")


START = """
import sys
from pathlib import Path
read = []
real = Path.open
sys.addaudithook(lambda name, words: read.append(str(words[0])) if name == "open" else None)
from gyrodrift.cli import main
assert main(["serve", "--port", "/dev/null"]) == 3
print("toy" in sys.modules, any("entry_points" in name for name in read))
"""


def test_the_start_of_serve_reads_no_plug_in(site: Site) -> None:
    """Neither the packages nor their metadata are read."""
    for group in REGISTRIES:
        site.install(f"toy_{group[10:]}", group, "toy", "toy")
    (site.folder / "toy.py").write_text("")
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join((str(site.folder), str(ROOT)))}
    done = subprocess.run([sys.executable, "-c", START], env=environment, capture_output=True, text=True, check=True)
    assert done.stdout == "False False\n"
