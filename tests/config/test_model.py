"""Configs: what is taken, and what is said of every mistake."""

import json
import os
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.config.model import Config, load_config
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.filters.registry import FILTERS
from gyrodrift.filters.restlevel.model import RestlevelParams
from gyrodrift.io.files import shipped_config
from gyrodrift.values.errors import ConfigError

KEYS = (
    "filter",
    "hdr",
    "restlevel",
    "sample_rate_hz",
    "slew_dps",
    "provenance",
    "outputs",
    "columns",
    "send",
    "axes",
    "mount",
    "calibration",
)
GOOD = "hdr:\n  i_c_dps: 1e-3\n  tau_s: .5\n  theta_w_dps: 1\n  c1: 0\n  c2: 1.25E0\n"

HDR_DEFAULTS = ("i_c_dps: 0.0006", "tau_s: 0.9447", "theta_w_dps: 0.5608", "c1: 0.7839", "c2: 1.2161")
RESTLEVEL_DEFAULTS = tuple(f"restlevel.{name}: {value:g}" for name, value in asdict(RestlevelParams()).items())


def problems(tmp_path: Path, text: str | bytes) -> list[str]:
    path = tmp_path / "c.yaml"
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    return [problem.removeprefix(f"{tmp_path}/") for problem in caught.value.problems]


def test_a_good_file_is_taken_with_exponents_and_integers(tmp_path: Path) -> None:
    """Numbers are what a person means by them."""
    path = tmp_path / "c.yaml"
    path.write_text("filter: hdr\nsample_rate_hz: 100\nprovenance: {by: hand, seeds: [1, 2]}\n" + GOOD)
    assert load_config(path) == Config("hdr", {"hdr": HdrParams(1e-3, 0.5, 1.0, 0.0, 1.25)}, 100.0)


def test_another_filter_is_taken_by_its_name(tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text(f"filter: restlevel\nrestlevel: {json.dumps(asdict(RestlevelParams(window_s=0.5)))}\n{GOOD}")
    config = load_config(path)
    assert config.chosen is FILTERS["restlevel"]
    assert config.params == RestlevelParams(window_s=0.5)
    assert config.params_of(FILTERS["hdr"]) == HdrParams(1e-3, 0.5, 1.0, 0.0, 1.25)
    assert config.changes_from(Config("hdr", {"hdr": HdrParams(1e-3, 0.5, 1.0, 0.0, 1.25)})) == [
        "filter: hdr → restlevel",
        "restlevel.window_s: 0.3 → 0.5",
    ]


@pytest.mark.parametrize(
    ("text", "config"),
    [
        ("filter: hdr\n", Config("hdr", {}, None, tuple(f"hdr.{line}" for line in HDR_DEFAULTS))),
        ("{}\n", Config("restlevel", {}, None, ("filter: restlevel", *RESTLEVEL_DEFAULTS))),
        ("sample_rate_hz: 50\n", Config("restlevel", {}, 50.0, ("filter: restlevel", *RESTLEVEL_DEFAULTS))),
        (
            "filter: restlevel\nrestlevel: {window_s: 0.5}\n",
            Config("restlevel", {"restlevel": RestlevelParams(window_s=0.5)}, None, RESTLEVEL_DEFAULTS[1:]),
        ),
        (
            "hdr:\n  # tau_s: 1\n",
            Config("hdr", {"hdr": HdrParams()}, None, tuple(f"hdr.{line}" for line in HDR_DEFAULTS)),
        ),
        ("restlevel:\n", Config("restlevel", {"restlevel": RestlevelParams()}, None, RESTLEVEL_DEFAULTS)),
        (
            f"filter: restlevel\n{GOOD}",
            Config("restlevel", {"hdr": HdrParams(1e-3, 0.5, 1.0, 0.0, 1.25)}, None, RESTLEVEL_DEFAULTS),
        ),
        (GOOD, Config("hdr", {"hdr": HdrParams(1e-3, 0.5, 1.0, 0.0, 1.25)})),
    ],
)
def test_what_is_left_out_has_a_default_and_is_told(tmp_path: Path, text: str, config: Config) -> None:
    """The filter, a block, keys of a block; a filter that is not named is that of the block."""
    path = tmp_path / "c.yaml"
    path.write_text(text)
    assert load_config(path) == config
    assert load_config(path).params == config.params


def test_units_are_those_of_the_parameters(tmp_path: Path) -> None:
    """A drift is no time; and each line is one mistake."""
    text = "restlevel:\n" + "".join(f"  {name}: -1\n" for name in asdict(RestlevelParams()))
    assert [problem.partition("expected ")[2] for problem in problems(tmp_path, text)] == [
        "a number above 0 up to 60 s",
        "a number above 0 up to 100",
        "a number from 0 to 1000 deg/s",
        "a number from 0 to 10 deg/s/√s",
        "a number from 0 to 10 deg/s²",
        "a number from 0 to below 1",
        "a number from 0 to below 1",
        "a number from 0 to 100 %",
    ]
    text = "hdr: {i_c_dps: -1, theta_w_dps: 0}\n"
    assert [problem.partition("expected ")[2] for problem in problems(tmp_path, text)] == [
        "a number from 0 to 10 deg/s per sample",
        "a number above 0 up to 2000 deg/s",
    ]


@pytest.mark.parametrize(
    ("named", "meant"), [("HDR", "hdr"), ("hrd", "hdr"), ("restlvl", "restlevel"), ("Rest_Level", "restlevel")]
)
def test_a_filter_written_wrongly_is_one_mistake(tmp_path: Path, named: str, meant: str) -> None:
    for rest in ("", GOOD, "restlevel: {quiet: 4}\n"):
        assert problems(tmp_path, f"filter: {named}\n{rest}") == [
            f"c.yaml:1:1 filter: is {named!r} (text); did you mean {meant}?"
        ]


def test_the_shipped_config_is_valid() -> None:
    assert load_config(shipped_config("gyrodrift.yaml")).sample_rate_hz == 100.0


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("", "c.yaml:1:1 is empty; expected at least filter: hdr or filter: restlevel"),
        ("# nothing\n", "c.yaml:1:1 is empty; expected at least filter: hdr or filter: restlevel"),
        ("just words", "c.yaml:1:1 holds text; expected keys such as filter: hdr or filter: restlevel"),
        ("- 1\n", "c.yaml:1:1 holds a list; expected keys such as filter: hdr or filter: restlevel"),
        ("hdr: [1, 2\n", "c.yaml:2:1 is not YAML: did not find expected ',' or ']'"),
        ("a: b: c\n", "c.yaml:1:5 is not YAML: mapping values are not allowed in this context"),
        (b"hdr:\n  \xff\xfe\n", "c.yaml:2:1 is not text: byte 0xff is not UTF-8"),
        ("filter:\n", "c.yaml:1:1 filter: is empty; expected hdr or restlevel"),
        ("hdr: 1\n", "c.yaml:1:1 hdr: is 1; expected a block with i_c_dps, tau_s, theta_w_dps, c1, c2"),
        (GOOD + "filter: kalman\n", "c.yaml:7:1 filter: is 'kalman' (text); expected hdr or restlevel"),
        (GOOD + "hdrr: 1\n", "c.yaml:7:1 hdrr: is not a key of this file; did you mean hdr?"),
        (GOOD + "shade: 1\n", f"c.yaml:7:1 shade: is not a key of this file; expected {', '.join(KEYS)}"),
        (GOOD + "sample_rate_hz: 0\n", "c.yaml:7:1 sample_rate_hz: is 0; expected a number above 0 up to 1e+06 Hz"),
        (GOOD + "  c1: 1\n", "c.yaml:7:3 hdr.c1: is given twice, first in line 5; keep one"),
        (GOOD.replace(".5", "on"), "c.yaml:3:3 hdr.tau_s: is 'on' (text); expected a number from 0 to 1000 s"),
        (
            GOOD.replace(".5", "true"),
            "c.yaml:3:3 hdr.tau_s: is true (a truth value); expected a number from 0 to 1000 s",
        ),
        (GOOD.replace(".5", "1:30"), "c.yaml:3:3 hdr.tau_s: is '1:30' (text); expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", "017"), "c.yaml:3:3 hdr.tau_s: is '017' (text); expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", "'0.5'"), "c.yaml:3:3 hdr.tau_s: is '0.5' (text); expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", ".nan"), "c.yaml:3:3 hdr.tau_s: is nan; expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", "1e999"), "c.yaml:3:3 hdr.tau_s: is inf; expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", "-1"), "c.yaml:3:3 hdr.tau_s: is -1; expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", "[1]"), "c.yaml:3:3 hdr.tau_s: is a list; expected a number from 0 to 1000 s"),
        (GOOD.replace(".5", "{a: 1}"), "c.yaml:3:3 hdr.tau_s: is a block of keys; expected a number from 0 to 1000 s"),
    ],
)
def test_a_mistake_is_named_with_its_place_and_what_is_expected(
    tmp_path: Path, text: str | bytes, expected: str
) -> None:
    assert problems(tmp_path, text) == [expected]


def test_all_mistakes_are_told_at_once_in_the_order_of_the_file(tmp_path: Path) -> None:
    """A person mends a file once."""
    text = "filtr: hdr\nhdr:\n  i_c_dps: 99\n  tau: 1\n  theta_w_dps: no\n  c1: 1\n  c1: 2\n  c2: 0\n"
    places = [problem.split(" ")[:2] for problem in problems(tmp_path, text)]
    assert places == [
        ["c.yaml:1:1", "filtr:"],
        ["c.yaml:3:3", "hdr.i_c_dps:"],
        ["c.yaml:4:3", "hdr.tau:"],
        ["c.yaml:5:3", "hdr.theta_w_dps:"],
        ["c.yaml:7:3", "hdr.c1:"],
    ]


def test_an_alias_is_refused_since_it_may_never_end(tmp_path: Path) -> None:
    """A block that contains itself, which PyYAML takes."""
    assert "c.yaml:1:6 hdr.0: is an alias (*), which may never end; write it out" in problems(
        tmp_path, "hdr: &a [*a]\n"
    )


@pytest.mark.parametrize(
    ("text", "statement"),
    [
        ("[" * 100_000, "is nested more than 32 times"),
        ("{a: " * 30_000, "is nested more than 32 times"),
        ("- " * 60_000, "is nested more than 32 times"),
        ("? " * 60_000, "is nested more than 32 times"),
        ("\n".join(" " * i + "a:" for i in range(400)), "is nested more than 32 times"),
        (GOOD.replace(".5", "1" * 5000), "hdr.tau_s: is inf"),
        (f"sample_rate_hz: {'9' * 400}", "sample_rate_hz: is inf"),
        (GOOD.replace(".5", f"'{'x' * 5000}'"), "hdr.tau_s: is 'xxx"),
        ("\n".join(f"k{i}: 1" for i in range(9000)), "8980 more mistakes"),
        ("a" * 200_000, "is larger than 128 KiB"),
    ],
)
def test_a_file_that_was_made_to_hurt_is_refused_in_few_words(tmp_path: Path, text: str, statement: str) -> None:
    """A service that runs looks at whatever is saved under the name of its config."""
    report = problems(tmp_path, text)
    assert any(statement in problem for problem in report)
    assert len(report) <= 21
    assert max(map(len, report)) < 450


def test_what_is_no_ordinary_file_is_not_opened(tmp_path: Path) -> None:
    """A pipe would wait for a writer, and a device may never end."""
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "endless").symlink_to("/dev/zero")
    for name in ("pipe", "endless"):
        with pytest.raises(ConfigError, match="is no ordinary file"):
            load_config(tmp_path / name)


def test_a_file_that_is_not_there_is_named(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match=r"nowhere\.yaml:1:1 cannot be read: No such file or directory"):
        load_config(tmp_path / "nowhere.yaml")


@given(st.binary(max_size=200))
def test_any_bytes_are_a_config_or_a_config_error(tmp_path_factory: pytest.TempPathFactory, content: bytes) -> None:
    path = tmp_path_factory.mktemp("any") / "c.yaml"
    path.write_bytes(content)
    with suppress(ConfigError):
        assert isinstance(load_config(path), Config)


def test_changes_are_told_key_by_key() -> None:
    old = Config("hdr", {"hdr": HdrParams(tau_s=1.0)}, 100.0)
    new = Config("hdr", {"hdr": HdrParams(tau_s=2.0)}, None)
    assert new.changes_from(old) == ["sample_rate_hz: 100.0 → None", "hdr.tau_s: 1.0 → 2.0"]
    assert new.changes_from(new) == []


@pytest.mark.parametrize(
    ("text", "columns"),
    [
        ("columns: t_ms, _, _, gz:lsb/131\n", "t_ms, _, _, gz:lsb/131"),
        ("columns: [t=t_ms, Gyro Z=rate:rads:-]\n", "t=t_ms, Gyro Z=rate:rads:-"),
        ("columns:\n- rate\n", "rate"),
    ],
)
def test_columns_of_text_stand_in_a_line_or_a_list(tmp_path: Path, text: str, columns: str) -> None:
    path = tmp_path / "c.yaml"
    path.write_text(text)
    config = load_config(path)
    assert config.columns == columns
    assert config.changes_from(Config()) == [f"columns: None → {columns}"]


@pytest.mark.parametrize(
    ("value", "what"),
    [
        ("t_ms, raet", "'raet' is not a column; did you mean rate"),
        ("[t_ms, rate:furlongs]", "'rate:furlongs': 'furlongs' is not a unit of rate"),
        ("[t_ms, 5]", "is 5; expected text such as"),
    ],
)
def test_columns_that_are_wrong_are_told_with_their_place(tmp_path: Path, value: str, what: str) -> None:
    (problem,) = problems(tmp_path, f"filter: hdr\ncolumns: {value}\n")
    assert problem.startswith(f"c.yaml:2:1 columns: {what}")


def test_more_outputs_than_anybody_has_are_one_mistake(tmp_path: Path) -> None:
    (report,) = problems(tmp_path, "outputs:\n" + "- {name: tcp, prt: 1}\n" * 5000)
    assert report == "c.yaml:1:1 outputs: are 5000; expected no more than 100"


@pytest.mark.parametrize(
    ("value", "what"),
    [
        ("5", "is 5; expected text in quotes"),
        (r"'\q'", r"has the unknown escape \q; examples"),
        ("''", "is 0 bytes; expected"),
    ],
)
def test_what_cannot_be_sent_to_a_device_is_told_with_its_place(tmp_path: Path, value: str, what: str) -> None:
    (problem,) = problems(tmp_path, f"filter: hdr\nsend: {value}\n")
    assert problem.startswith(f"c.yaml:2:1 send: {what}")


def test_what_a_device_is_sent_stands_in_the_config(tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    for value in (r"'\r\n'", r'"\r\n"'):
        path.write_text(f"send: {value}\n")
        assert load_config(path).send == b"\r\n"
    assert load_config(path).changes_from(Config()) == [r"send: None → b'\r\n'"]
