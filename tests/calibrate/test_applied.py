"""A calibration where it is applied: the config, `serve`, sessions, and what filters and judges them."""

from csv import DictReader
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np
import pytest
from calibrate_support import GAIN_CCW, GAIN_CW, Table, rest, to_and_fro, turn, turn_s
from hand_motion import BIAS_DPS, hand_motion
from support import Command, near, speaking_on

from gyrodrift.cli import main
from gyrodrift.config.calibration import block_text, with_block
from gyrodrift.config.model import load_config
from gyrodrift.diagnose.recording.checked import checked_session
from gyrodrift.evaluation.dataset import Source, load_with_reference
from gyrodrift.filters.hdr_filter import HDR
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.filters.run import FilterRun
from gyrodrift.service.calibrating import bias_of
from gyrodrift.session.calibrated import KEPT, applied_scale_sigmas, calibrated, true_rates_dps, with_calibration
from gyrodrift.session.files import load_session, write_session
from gyrodrift.session.session import AXIS_COLUMNS, Session, session_of
from gyrodrift.values.arrays import Floats
from gyrodrift.values.calibration import AXES_SHAPES, Calibration, calibration_of_table
from gyrodrift.values.errors import ConfigError, DataError, UsageError
from gyrodrift.values.sample import Inertial, Sample

RIGHT = Calibration(
    date="2026-05-01T10:00:00+00:00",
    device_id="firmware_sim",
    scale_ccw=1.0 / GAIN_CCW,
    scale_ccw_se=0.0004,
    scale_cw=1.0 / GAIN_CW,
    scale_cw_se=0.0004,
    bias_dps=0.35,
    temp_c=25.0,
    turns=1,
    repeats=3,
)
MOTION = [*rest(10.0), *turn(360.0), *rest(3.0)]
MOTION_S = 10.0 + turn_s(360.0) + 3.0


def config_of(folder: Path, result: Calibration | None, *, name: str = "my.yaml") -> Path:
    path = folder / name
    path.write_text("filter: restlevel\n" + ("" if result is None else block_text(result)))
    return path


def test_a_block_is_read_as_it_was_written(tmp_path: Path) -> None:
    config = load_config(config_of(tmp_path, RIGHT))
    assert config.calibration is not None
    assert config.calibration == replace(
        RIGHT, scale_ccw=near(RIGHT.scale_ccw, 1e-7), scale_cw=near(RIGHT.scale_cw, 1e-7)
    )


def test_a_new_block_takes_the_place_of_the_old_one() -> None:
    head, tail = "# head\nfilter: hdr  # mine\n", "# of the outputs\noutputs: []\n\n# end"
    old = "calibration:\n  date: 2020-01-01\n  # a note\n\n  sign: -1\n\n"
    assert with_block(head + old + tail, "NEW\n") == f"{head}NEW\n\n{tail}"
    assert with_block(head.rstrip(), "NEW\n") == f"{head}NEW\n"
    with pytest.raises(UsageError, match="its keys do not stand on lines of their own"):
        with_block("{filter: hdr}", "NEW\n")


@pytest.mark.parametrize(
    ("block", "problem"),
    [
        ("calibration: 3", "1:1 calibration: is 3; expected a block of keys"),
        ("calibration: {}", "1:1 calibration.date: is missing"),
        ("calibration: {date: yesterday}", "1:15 calibration.date: is 'yesterday' (text); expected a date such as"),
        ("calibration: {date: 2026-01-01, sign: 2}", "1:33 calibration.sign: is 2; expected 1 or -1"),
        ("calibration: {date: 2026-01-01, scale_ccw: 9}", "1:33 calibration.scale_ccw: is 9; expected a number"),
        ("calibration: {date: 2026-01-01, scale: 1}", "1:33 calibration.scale: is not a key of calibration"),
    ],
)
def test_a_mistake_in_the_block_is_named_with_its_place(block: str, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text(f"{block}\n")
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    assert str(caught.value).startswith(f"{path}:{problem}")


def test_serve_records_the_rate_of_the_device_and_the_calibration_beside_it(tmp_path: Path) -> None:
    """`filter` without a config then gives the yaw that serve gave; what it writes is not put right again."""
    config, sessions = config_of(tmp_path, RIGHT), tmp_path / "sessions"
    words = ("--config", config, "--record", sessions, "--log-level", "info")
    with speaking_on(tmp_path / "gyro") as device, Command("serve", "--port", tmp_path / "gyro", *words) as serve:
        table = Table(device, tmp_path, MOTION).play(MOTION_S)
        serve.until(lambda c: len(c.out.split("\n")) > table.t_s * 100 - 3, "all samples")
        assert serve.stop() == 0
        lines = serve.all_lines()
    (path,) = sessions.glob("*.mcap")
    session = load_session(path)
    assert np.max(session.rate_dps) == near(90.0 * GAIN_CCW + 0.35, 0.3)
    assert session.metadata[KEPT]["date"] == RIGHT.date
    right = calibrated(session)
    sent_dps = [line["rate_dps"] for line in lines]
    np.testing.assert_allclose(right.rate_dps[: len(lines)], sent_dps, rtol=0.0, atol=1e-5)
    assert calibrated(right) is right
    out = tmp_path / "yaw.csv"
    assert main(["filter", str(path), "--out", str(out), "--quiet"]) == 0
    yaw_deg = float(
        out.read_text().splitlines()[len(lines)].split(",")[out.read_text().split("\n")[0].split(",").index("yaw_deg")]
    )
    assert yaw_deg == near(lines[-1]["yaw_deg"], 1e-3)
    assert yaw_deg == near(360.0, 0.3)
    sigma_deg = [float(row["yaw_sigma_deg"]) for row in DictReader(out.read_text().splitlines())][len(lines) - 1]
    assert sigma_deg == near(lines[-1]["yaw_sigma_deg"], 1e-3)
    assert sigma_deg < 0.5  # 0.04 % of a turn and its way; 1 % would be 4.5
    np.testing.assert_array_equal(calibrated(load_session(out)).rate_dps, right.rate_dps)


def test_a_calibration_of_another_device_is_warned_of_and_not_applied(tmp_path: Path) -> None:
    config, sessions = config_of(tmp_path, replace(RIGHT, device_id="gyro-17")), tmp_path / "sessions"
    words = ("--config", config, "--record", sessions)
    with speaking_on(tmp_path / "gyro") as device, Command("serve", "--port", tmp_path / "gyro", *words) as serve:
        Table(device, tmp_path, MOTION).play(3.0)
        (line, *_) = serve.take_lines(200)
        assert serve.stop() == 0
        assert "event=calibration_of_another_device calibrated=gyro-17 device_id=firmware_sim" in serve.log
    (path,) = sessions.glob("*.mcap")
    session = load_session(path)
    assert line["rate_dps"] == near(float(session.rate_dps[0]), 1e-5)
    assert calibrated(session) is session
    with Command("filter", path, "--config", config) as run:
        assert run.end() == 0
        assert "the calibration is for gyro-17 and is not applied" in run.log


def test_a_changed_calibration_is_followed_and_yaw_goes_on(tmp_path: Path) -> None:
    config, sessions = config_of(tmp_path, None), tmp_path / "sessions"
    words = ("--config", config, "--record", sessions)
    with speaking_on(tmp_path / "gyro") as device, Command("serve", "--port", tmp_path / "gyro", *words) as serve:
        table = Table(device, tmp_path, to_and_fro([360.0, 360.0], 10.0)).play(10.0 + turn_s(360.0) + 3.0)
        first = serve.take_lines(round(table.t_s * 100) - 3)
        config_of(tmp_path, RIGHT, name="new.yaml").replace(config)
        serve.until_log("event=config_applied")
        table.play(1.0 + turn_s(360.0) + 4.0)
        second = serve.take_lines(round((1.0 + turn_s(360.0) + 4.0) * 100) - 3)
        assert serve.stop() == 0
    assert first[-1]["yaw_deg"] == near(360.0 * GAIN_CCW, 0.3)
    assert second[0]["yaw_deg"] == near(first[-1]["yaw_deg"], 0.05)
    assert second[0]["bias_dps"] == near(first[-1]["bias_dps"], 0.01)
    assert second[-1]["yaw_deg"] - first[-1]["yaw_deg"] == near(360.0, 0.3)
    (path,) = sessions.glob("*.mcap")
    assert load_session(path).metadata[KEPT]["date"] == RIGHT.date


def test_an_old_calibration_is_applied_and_warned_of(tmp_path: Path) -> None:
    """An old scale and the right sign are better than none."""
    config = config_of(tmp_path, replace(RIGHT, date="2020-01-01T00:00:00+00:00"))
    with (
        speaking_on(tmp_path / "gyro") as device,
        Command("serve", "--port", tmp_path / "gyro", "--config", config) as serve,
    ):
        Table(device, tmp_path, MOTION).play(2.0)
        assert serve.take_lines(100)[0]["rate_dps"] == near(0.0, 0.2)
        assert serve.stop() == 0
        assert "event=calibration_old" in serve.log
        assert "event=calibration_applied" in serve.log


def test_a_temperature_that_leaves_the_run_does_not_move_the_bias_any_further() -> None:
    """Sample by sample and as arrays alike; without a temperature it is that of the reference."""
    warm = replace(RIGHT, bias_dps_per_c=0.1, temp_c=25.0, temp_low_c=20.0, temp_high_c=30.0, sign=-1)
    temps_c, measured_dps = np.array([np.nan, 10.0, 20.0, 25.0, 32.0]), np.array([5.0, -5.0, 5.0, -5.0, 5.0])
    biases_dps = [0.35, -0.15, -0.15, 0.35, 0.85]
    np.testing.assert_allclose([warm.bias_at_dps(temp_c) for temp_c in temps_c.tolist()], biases_dps)
    single = [warm.rate_dps(*item) for item in zip(measured_dps.tolist(), temps_c.tolist(), strict=True)]
    assert true_rates_dps(measured_dps, temps_c, warm).tolist() == single


@pytest.fixture(scope="module")
def scaled(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A simulated session of a device that reads too much, with the calibration that says so."""
    folder = tmp_path_factory.mktemp("scaled")
    effects = ["--effect", "scale_factor:error_percent=1.5", "--effect", "scale_asymmetry:error_percent=0.4"]
    words = ["--sessions", "1", "--minutes", "1.5", "--seed", "3", "--profile", "identify", "--quiet"]
    assert main(["simulate", "--out", str(folder / "raw"), *words, *effects]) == 0
    (path,) = (folder / "raw").glob("*.mcap")
    session = load_session(path)
    metadata = {name: dict(table) for name, table in session.metadata.items()}
    write_session(folder / "kept.mcap", [session], {**metadata, KEPT: replace(RIGHT, device_id="").table()})
    return folder / "kept.mcap"


def gain_of(rate_dps: Floats, session: Session) -> float:
    assert session.encoder_deg is not None
    true_dps = np.gradient(session.encoder_deg, session.t_device_s)
    is_turning = true_dps > 25.0
    return float(np.sum(rate_dps[is_turning]) / np.sum(true_dps[is_turning]))


def test_a_diagnosis_sees_the_calibrated_rate_and_says_so(scaled: Path) -> None:
    """A scale error that the calibration takes out is no gap; it is taken out once."""
    session, checked = load_session(scaled), checked_session(scaled)
    assert gain_of(session.rate_dps - 0.35, session) == near(GAIN_CCW, 0.002)
    assert gain_of(checked.recordings[0].rate_dps, session) == near(1.0, 0.002)
    assert "is compared with its calibration of 2026-05-01T10:00:00+00:00 applied" in checked.remarks[0]


def test_tuning_and_comparing_run_on_the_calibrated_rate(scaled: Path) -> None:
    session = load_session(scaled)
    reference = load_with_reference(Source(scaled)).reference
    np.testing.assert_array_equal(reference.rate_dps, with_calibration(session, RIGHT).rate_dps)


def test_an_upside_down_device_turns_its_other_axes_too() -> None:
    """A sensor turned by 180° about x: the frame stays right-handed, and gravity points up again."""
    calibration = replace(RIGHT, sign=-1, scale_ccw=1.0, scale_cw=1.0, bias_dps=0.0)
    axes = Inertial(1.0, 2.0, 3.0, 0.1, 0.2, -9.81)
    expected = Inertial(1.0, -2.0, -3.0, 0.1, -0.2, 9.81)
    assert calibration.sample(Sample(0, 0.0, 0.0, 3.0, inertial=axes)).inertial == expected
    session = session_of("s", [Sample(0, 0.0, 0.0, 3.0, inertial=axes)])
    true = with_calibration(session, calibration)
    assert true.rate_dps.tolist() == [-3.0]
    assert [true.filled(name)[0] for name in AXIS_COLUMNS] == list(expected)


THREE_AXES = replace(
    RIGHT,
    accel_offset_mps2=(0.3, -0.2, 0.1),
    accel_offset_se_mps2=(0.002, 0.002, 0.003),
    accel_scale=(1.02, 0.98, 1.01),
    accel_scale_se=(0.0004, 0.0004, 0.0005),
    gyro_bias_xy_dps=(0.8, -0.5),
    gyro_bias_xy_se_dps=(0.01, 0.02),
    gyro_matrix=((1.02, 0.01, -0.017), (1e-5, 0.99, 0.02), (-0.01, 0.017, 1.01)),
    gyro_matrix_se=((0.001, 0.002, 0.002), (0.002, 0.001, 0.002), (0.002, 0.002, 0.001)),
    temp_low_c=20.0,
    temp_high_c=30.0,
    bias_dps_per_c=0.01,
)


def measured_by(calibration: Calibration, rates_dps: Floats, accel_mps2: Floats) -> Inertial:
    """Reading of a device at the temperature of its calibration, without the scales of a direction."""
    bias_dps = np.array([*(calibration.gyro_bias_xy_dps or (0.0, 0.0)), calibration.bias_dps])
    gyro_dps = np.linalg.solve(np.array(calibration.gyro_matrix), rates_dps) + bias_dps
    accel = accel_mps2 / np.array(calibration.accel_scale) + np.array(calibration.accel_offset_mps2)
    return Inertial(*gyro_dps.tolist(), *accel.tolist())


def test_a_calibration_of_three_axes_gives_true_rates_and_accelerations() -> None:
    """Offset, scale and misalignment are removed; the acceleration may be missing."""
    calibration = replace(THREE_AXES, scale_ccw=1.0, scale_cw=1.0)
    rates_dps, accel_mps2 = np.array([10.0, -20.0, 30.0]), np.array([1.0, -2.0, 9.5])
    measured = measured_by(calibration, rates_dps, accel_mps2)
    sample = calibration.sample(Sample(0, 0.0, 0.0, measured.gyro_z_dps, temp_c=25.0, inertial=measured))
    assert sample.inertial is not None
    np.testing.assert_allclose(sample.inertial, [*rates_dps, *accel_mps2], atol=1e-12)
    assert sample.rate_dps == sample.inertial.gyro_z_dps
    without = calibration.inertial(Inertial(*measured[:3]))
    np.testing.assert_allclose(without[:3], rates_dps, atol=1e-12)
    assert np.isnan(without[3:]).all()


@pytest.mark.parametrize("sign", [1, -1])
def test_three_axes_of_a_session_are_calibrated_as_sample_by_sample(sign: Literal[1, -1]) -> None:
    calibration = replace(THREE_AXES, sign=sign)
    rng = np.random.default_rng(3)
    samples = [
        Sample(i, float(i), float(i), axes[2], temp_c=temp_c, inertial=Inertial(*axes))
        for i, (axes, temp_c) in enumerate(zip(rng.normal(0.0, 50.0, (50, 6)).tolist(), range(50), strict=True))
    ]
    samples[7] = samples[7]._replace(inertial=None)
    true, single = with_calibration(session_of("s", samples), calibration), list(map(calibration.sample, samples))
    assert true.rate_dps.tolist() == [sample.rate_dps for sample in single]
    for index, sample in enumerate(single):
        if sample.inertial is not None:
            assert [true.filled(name)[index] for name in AXIS_COLUMNS] == list(sample.inertial)
    assert single[7].inertial is None


def test_a_block_of_three_axes_is_read_as_it_was_written_and_stored_in_sessions(tmp_path: Path) -> None:
    """Lists in brackets, one key a line; a session keeps every digit."""
    path = config_of(tmp_path, THREE_AXES)
    assert "  accel_offset_mps2: [0.3, -0.2, 0.1] # measured" in path.read_text()
    written = load_config(path).calibration
    assert written is not None
    assert replace(written, scale_ccw=RIGHT.scale_ccw, scale_cw=RIGHT.scale_cw) == THREE_AXES
    assert calibration_of_table(THREE_AXES.table()) == THREE_AXES
    assert not AXES_SHAPES.keys() & RIGHT.table().keys()
    session = Session("s", np.arange(3.0), np.ones(3), metadata={KEPT: {**RIGHT.table(), "gyro_matrix": "[1, 2]"}})
    with pytest.raises(DataError, match=r"its calibration is invalid: gyro_matrix: expected 3 rows of 3 numbers"):
        calibrated(session)


@pytest.mark.parametrize(
    ("key", "problem"),
    [
        ("accel_scale: [1, 1]", "accel_scale: is a list; expected 3 numbers in brackets"),
        ("accel_scale: [1, 1, 3]", "accel_scale: has a number out of range; expected 3 numbers in brackets"),
        ("gyro_matrix: 1", "gyro_matrix: is 1; expected 3 rows of 3 numbers"),
        ("gyro_matrix: [[1, 0, 0], [1, 0, 0], [0, 0, 1]]", "gyro_matrix: has rows that are nearly parallel"),
        ("gyro_bias_xy_dps: [1, true]", "gyro_bias_xy_dps: is a list; expected 2 numbers in brackets"),
    ],
)
def test_a_mistake_in_a_value_of_three_axes_is_named(key: str, problem: str, tmp_path: Path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text(f"calibration:\n  date: 2026-01-01\n  {key}\n")
    with pytest.raises(ConfigError) as caught:
        load_config(path)
    assert f"{path}:3:3 calibration.{problem}" in str(caught.value)


@pytest.mark.parametrize("sign", [1, -1])
def test_a_filter_that_runs_keeps_its_biases_under_a_calibration_of_three_axes(sign: Literal[1, -1]) -> None:
    """The rates at rest that it has learnt stay those of its estimate, at the temperature of the change."""
    new, learnt_dps = replace(THREE_AXES, sign=sign), (0.4, -0.2, 0.3)
    measured_dps = RIGHT.measured_xyz_dps(learnt_dps, 23.0)
    assert RIGHT.inertial(Inertial(*measured_dps), 23.0)[:3] == pytest.approx(learnt_dps)
    following = new.following(RIGHT, learnt_dps, 23.0)
    assert following.inertial(Inertial(*measured_dps), 23.0)[:3] == pytest.approx(learnt_dps)
    assert replace(following, bias_dps=new.bias_dps, gyro_bias_xy_dps=new.gyro_bias_xy_dps) == new


def test_a_new_calibration_of_one_axis_keeps_the_accelerometer_of_its_device() -> None:
    """The matrix contains the old scale of z, so it goes."""
    kept = RIGHT.keeping_axes(THREE_AXES)
    assert kept.accel_offset_mps2 == THREE_AXES.accel_offset_mps2
    assert kept.gyro_bias_xy_dps == THREE_AXES.gyro_bias_xy_dps
    assert kept.gyro_matrix is None
    assert RIGHT.keeping_axes(replace(THREE_AXES, device_id="other")) == RIGHT
    assert RIGHT.keeping_axes(None) == RIGHT


def test_the_scale_error_of_three_axes_is_that_of_the_matrix() -> None:
    """The scales of a turn about the vertical say nothing of x and y."""
    assert RIGHT.scale_sigma == 0.0004
    assert RIGHT.axes_scale_sigma is None
    assert THREE_AXES.axes_scale_sigma == 0.001
    session = Session("s", np.arange(3.0), np.ones(3))
    assert applied_scale_sigmas(session) == (None, None)
    assert applied_scale_sigmas(with_calibration(session, THREE_AXES)) == (0.0004, 0.001)


def test_the_estimate_that_a_new_calibration_keeps_is_that_of_all_axes() -> None:
    """A filter of one axis states a number; HDR and restlevel on three axes state three."""
    motion = hand_motion(10.0, bias_dps=BIAS_DPS)
    for chosen in (RESTLEVEL, HDR):
        run = FilterRun(chosen, chosen.params())
        assert bias_of(run.state) == 0.0
        columns = (motion.t_s.tolist(), motion.gyro_dps.tolist(), motion.accel_mps2.tolist())
        for t_s, gyro, accel in zip(*columns, strict=True):
            run.step(t_s, gyro[2], Inertial(*gyro, *accel))
        assert isinstance(bias_of(run.state), tuple)
        assert bias_of(run.state) == pytest.approx(BIAS_DPS, abs=0.1)
