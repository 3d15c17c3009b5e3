"""An effect of somebody else with its candidate, added through the public registration alone: that of the docs."""

from collections.abc import Iterator
from pathlib import Path

import pytest
from simulate_support import BASE, HINTS, MOTION, base_run, feature, plain

from firmware_sim.effects import catalogue
from firmware_sim.measure import measure
from firmware_sim.rig import Rig, load_rig, parse_effect
from firmware_sim.yaml_file import FileError
from gyrodrift.diagnose.simulate import candidates as tried
from gyrodrift.diagnose.simulate.responses import response_table
from gyrodrift.simulation.sessions import rig_yaml

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "motor_bias.py"


@pytest.fixture
def motor_bias() -> Iterator[None]:
    """The effect and its record as the page has them, for one test."""
    exec(compile(EXAMPLE.read_text(), EXAMPLE, "exec"), {"__name__": "motor_bias"})
    yield
    tried.unregister("motor_bias")
    catalogue.unregister("motor_bias")


@pytest.mark.usefixtures("motor_bias")
def test_a_rig_file_with_it_loads_and_is_written_again(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text("effects: [{name: motor_bias, bias_dps: 0.3}]\n")
    rig = load_rig(path)
    assert rig.effects == (parse_effect("motor_bias:bias_dps=0.3"),)
    path.write_text(rig_yaml(rig))
    assert load_rig(path) == rig
    path.write_text("effects: [{name: motor_bias, bias_dps: 9}]\n")
    with pytest.raises(FileError, match=r"effects\.0\.bias_dps: is 9; input should be less than or equal to 5"):
        load_rig(path)


@pytest.mark.usefixtures("motor_bias")
def test_a_rig_with_it_simulates() -> None:
    """Named on a command line, it adds its 0.1 deg/s where the table turns, and nothing below 1 deg/s."""
    ideal = BASE.model_copy(update={"noise_dps_rthz": 0.0, "dps_per_lsb": 1e-2})
    block, plain_block = (
        next(measure(Rig(base=ideal, effects=effects), MOTION, seed=1))
        for effects in ((parse_effect("motor_bias"),), ())
    )
    turns = MOTION.motion_at(block.seq / ideal.sample_rate_hz)[1] > 1.0
    added = block.rate_raw - plain_block.rate_raw
    assert added[turns].min() >= 9  # a rounding apart
    assert added[turns].max() <= 11
    assert not added[~turns].any()


@pytest.mark.usefixtures("motor_bias")
def test_it_is_tried_and_its_response_is_simulated() -> None:
    result = tried.candidates(HINTS)
    names = [item.name for item in result]
    candidate = result[names.index("motor_bias")]
    assert names[names.index("motor_bias") + 1].startswith("?")
    assert (candidate.stage, candidate.group, candidate.needs) == ("platform", "motor_bias", ("motion",))
    table = response_table(plain(), [candidate], null_runs=1)
    down, up = table.responses["motor_bias "][:, 0]
    assert feature(up, "moving") == pytest.approx(-feature(down, "moving"), rel=1e-6)
    assert abs(feature(up, "moving")) > feature(table.thresholds, "moving")
    full = plain().simulated((candidate.make(0.1),), 0).values - base_run(0).values
    assert feature(up, "moving") == pytest.approx(feature(full, "moving"), rel=0.02)


def test_without_registration_nobody_knows_it(tmp_path: Path) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text("effects: [{name: motor_bias, bias_dps: 0.3}]\n")
    with pytest.raises(FileError, match="'motor_bias' is not known"):
        load_rig(path)
    assert "motor_bias" not in {item.name for item in tried.candidates(HINTS)}


@pytest.mark.usefixtures("motor_bias")
def test_a_name_is_taken_once() -> None:
    """A second effect of the same name is refused."""
    with pytest.raises(ValueError, match="'motor_bias' already, MotorBias"):
        catalogue.register(type(parse_effect("motor_bias")))
