"""`gyrodrift calibrate` as people use it: with keys on a terminal, without one, and what `serve` makes of it."""

import json
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest
from calibrate_support import GAIN_CCW, GAIN_CW, SCALED, Table, profile_of, rest, to_and_fro, turn, turn_s
from support import Command, Terminal, ended_here, near, ours, speaking_on

from gyrodrift.config.model import load_config
from gyrodrift.values.calibration import Calibration

MARKS_DEG = [0.3, -0.2, 0.4, -0.4, 0.1, 0.2, -0.3]
"""Angles between the mark and the stops of a person, deg."""

TURNS_DEG = [(-360.0 if number % 2 == 0 else 360.0) + MARKS_DEG[number + 1] - MARKS_DEG[number] for number in range(6)]
"""Device that is mounted upside down: its positive turns are clockwise."""

KEPT = """\
# My robot.
filter: hdr   # the old one
hdr:
  tau_s: 0.5
# Who gets it:
outputs:
  - {name: tcp, port: 5151}
"""


def spread(actual: Calibration) -> tuple[float, float]:
    assert actual.scale_ccw_se is not None
    assert actual.scale_cw_se is not None
    return actual.scale_ccw_se, actual.scale_cw_se


STEPS = {1: ("Go back to the mark. Press Enter when it stands there", 1), 2: ("Turn one whole turn clockwise", 2)}
"""Message, and its number on the screen, after the move that misses the mark and the way back to it."""


def is_at_rest(terminal: Terminal) -> bool:
    return "at rest" in terminal.text.splitlines()[terminal.screen.cursor.y]


def says(text: str, count: int) -> Callable[[Terminal], bool]:
    return lambda terminal: terminal.text.count(text) == count


@pytest.fixture(scope="module")
def guided(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, Path]:
    """Calibrated by hand on the simulated table, one turn wrong: the screen, and the config."""
    folder = tmp_path_factory.mktemp("guided")
    config, missed_deg = folder / "my.yaml", 300.0
    config.write_text(KEPT)
    moves = [TURNS_DEG[0], missed_deg, 360.0 - missed_deg, *TURNS_DEG[1:]]
    shown = ""
    command = ours("calibrate", "--port", folder / "gyro", "--config", config, "--spread", "0.2", "--temperature", "0")
    with (
        speaking_on(folder / "gyro") as device,
        Terminal(*command, streams=("stderr",), rows=60, columns=160) as terminal,
    ):
        table = Table(device, folder, to_and_fro(moves))
        terminal.until(lambda t: "Press Enter to start" in t.text, "invitation")
        terminal.keys("\n")
        terminal.until(lambda t: "Do not touch it" in t.text, "rest")
        table.play(14.0)
        terminal.until(lambda t: "Turn one whole turn counter-clockwise" in t.text, "first turn")
        for number, angle_deg in enumerate(moves):
            table.play(turn_s(angle_deg) + 4.0)
            terminal.until(is_at_rest, "stop")
            terminal.keys("\n")
            terminal.until(says(*(STEPS.get(number) or ("deg for 360", max(1, number - 1)))), "next step")
            shown = terminal.text
        assert terminal.end() == 0
        shown = terminal.text
    return shown, config


def test_the_scale_sign_and_bias_of_the_table_are_found(guided: tuple[str, Path]) -> None:
    result = load_config(guided[1]).calibration
    assert result is not None
    ccw_se, cw_se = spread(result)
    assert result.sign == -1
    assert result.scale_ccw == near(1.0 / GAIN_CW, 4.0 * ccw_se)
    assert result.scale_cw == near(1.0 / GAIN_CCW, 4.0 * cw_se)
    assert 1e-4 < ccw_se < 2e-3
    assert result.mark_deg == near(0.3, 0.2)
    assert result.bias_dps == near(0.35, 0.005)
    assert result.noise_dps_rthz == near(0.0035, 0.0004)
    assert (result.device_id, result.dps_per_lsb, result.repeats) == ("firmware_sim", near(0.00763, 1e-6), 3)


def test_a_turn_that_missed_the_mark_is_not_taken_and_done_again(guided: tuple[str, Path]) -> None:
    assert "Not accepted: one turn read +305.7 deg, not a whole turn" in guided[0]
    assert guided[0].count("deg for 360") == 6


def test_the_config_keeps_all_else_that_it_had(guided: tuple[str, Path]) -> None:
    """Comments and blanks too; the calibration stands behind it."""
    text = guided[1].read_text()
    assert text.startswith(KEPT)
    assert text[len(KEPT) :].startswith("calibration:\n")


def test_serve_reads_a_whole_turn_as_one(guided: tuple[str, Path], tmp_path: Path) -> None:
    result = load_config(guided[1]).calibration
    assert result is not None
    config = tmp_path / "serve.yaml"
    config.write_text(guided[1].read_text().replace("filter: hdr", "filter: restlevel").replace("5151", "0"))
    motion = [*rest(10.0), *turn(-720.0), *rest(4.0), *turn(360.0), *rest(4.0)]
    with (
        speaking_on(tmp_path / "gyro") as device,
        Command("serve", "--port", tmp_path / "gyro", "--config", config) as serve,
    ):
        table = Table(device, tmp_path, motion).play(sum((10.0, turn_s(720.0), 4.0, turn_s(360.0), 4.0)))
        serve.until(lambda c: len(c.out.split("\n")) > table.t_s * 100 - 5, "all samples")
        assert serve.stop() == 0
        yaw_deg = {round(line["t_s"], 2): line["yaw_deg"] for line in serve.all_lines()}
        assert serve.log.count("event=calibration_applied") == 1
    ccw_se, cw_se = spread(result)
    there_deg, back_deg = yaw_deg[round(10.0 + turn_s(720.0) + 3.0, 2)], list(yaw_deg.values())[-1]
    assert there_deg == near(720.0, 4.0 * 720.0 * ccw_se + 0.1)
    assert there_deg - back_deg == near(360.0, 4.0 * 360.0 * cw_se + 0.1)
    assert abs(there_deg - 720.0 * GAIN_CW) > 4.0  # what the device itself says


@contextmanager
def played(segments: list[str], folder: Path) -> Iterator[None]:
    """The simulated device as a process of its own, which plays a motion as fast as it is read."""
    words = ("--link", folder / "gyro", "--profile", profile_of(segments, folder), "--speed", "max", "--wait")
    faulty = [word for effect in SCALED for word in ("--effect", effect)]
    with Command(*words, *faulty, module="firmware_sim") as device:
        device.until(lambda _: (folder / "gyro").is_symlink(), "pty")
        yield


def test_without_a_terminal_stops_are_told_by_rest(tmp_path: Path) -> None:
    with played(to_and_fro([360.4, -360.2, 359.8, -360.1, 360.0, -359.6]), tmp_path):
        config = tmp_path / "new.yaml"
        with Command("calibrate", "--port", tmp_path / "gyro", "--config", config, "--json", "--quiet") as calibrate:
            assert calibrate.end() == 0, calibrate.log
            content = json.loads(calibrate.out)
    assert len(content["turns"]) == 6
    assert content["calibration"]["scale_cw"] == near(1.0 / GAIN_CW, 4.0 * content["calibration"]["scale_cw_se"])
    assert load_config(config).calibration is not None
    assert load_config(config).filter == "restlevel"


@pytest.mark.parametrize(
    ("segments", "reason"),
    [
        ([*turn(7200.0), *rest(9.0)], "the device moved after"),
        ([*rest(12.0), *turn(300.0), *rest(20.0)], "one turn read +305.7 deg, not a whole turn"),
        ([*rest(200.0)], "no turn within 120 s"),
    ],
    ids=["moved at rest", "no whole turn", "not turned"],
)
def test_what_calibrates_nothing_is_an_error_without_hands(segments: list[str], reason: str, tmp_path: Path) -> None:
    """Status 4, one line that says what was wrong, and the config stays as it is."""
    config = tmp_path / "my.yaml"
    config.write_text(KEPT)
    with played(segments, tmp_path):
        calibrate = ended_here("calibrate", "--port", tmp_path / "gyro", "--config", config)
    assert calibrate.status == 4
    assert reason in calibrate.log.splitlines()[-1]
    assert config.read_text() == KEPT


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (("--config", "my.yaml"), "my.yaml: has a calibration already; --force replaces it"),
        (("--config", "my.txt"), "--config my.txt: the name of a config ends in .yaml"),
        (("--config", "none/my.yaml"), "--config none/my.yaml: there is no folder none"),
        (("--repeats", "2"), "--repeats 2: at least 3 are needed for a standard error"),
        (("--turns", "0"), "--turns 0: expected a number above 0"),
    ],
)
def test_wrong_usage_is_told_before_anything_is_turned(
    words: tuple[str, ...], reason: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Status 2, and no port is opened for it."""
    (tmp_path / "my.yaml").write_text("filter: restlevel\ncalibration: {date: 2026-01-01}\n")
    monkeypatch.chdir(tmp_path)
    calibrate = ended_here("calibrate", "--port", tmp_path / "gyro", *words)
    assert calibrate.status == 2
    assert reason in calibrate.log
