"""The hard cases: both versions of each, with what makes them hard, and different parts."""

from pathlib import Path

import numpy as np
import pytest

from firmware_sim.rig import load_rig
from gyrodrift.cli import main
from gyrodrift.session.files import load_session
from gyrodrift.simulation.hard_cases import CASES, Case, simulation
from gyrodrift.simulation.hard_motions import STILL_S

BY_NAME = {case.name: case for case in CASES}


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("hard")
    options = ["--seed", "4", "--sessions", "2", "--minutes", "0.5"]
    assert main(["simulate", "--hard-cases", "--out", str(folder), *options]) == 0
    return folder


def true_rate_dps(path: Path, seconds: float) -> float:
    session = load_session(path)
    assert session.encoder_deg is not None
    index = int(np.searchsorted(session.t_device_s, seconds))
    return float(session.encoder_deg[index] - session.encoder_deg[0]) / float(session.t_device_s[index])


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_a_case_comes_at_rest_and_moving(case: Case, written: Path) -> None:
    """Ten seconds, or not one sample."""
    name = case.name
    for number in (1, 2):
        still = written / f"{name}-still" / f"session-{number:02d}.mcap"
        assert true_rate_dps(still, STILL_S - 0.1) == 0.0
        assert true_rate_dps(still, 25.0) != 0.0
        assert abs(true_rate_dps(written / f"{name}-moving" / still.name, 1.0)) > 0.4


@pytest.mark.parametrize("rate_dps", [0.5, 1.5, 20.0])
def test_a_constant_spin_is_constant(rate_dps: float, written: Path) -> None:
    for number in (1, 2):
        session = load_session(written / f"spin-{rate_dps:g}-moving" / f"session-{number:02d}.mcap")
        assert session.encoder_deg is not None
        turned_deg = np.abs(session.encoder_deg - session.encoder_deg[0])
        assert np.allclose(turned_deg, rate_dps * session.t_device_s, rtol=0.0, atol=0.02)


def test_parts_differ_and_both_versions_have_the_same(written: Path) -> None:
    rigs = [load_rig(path) for path in sorted(written.glob("*-still/*.rig.yaml"))]
    twins = [load_rig(path) for path in sorted(written.glob("*-moving/*.rig.yaml"))]
    assert rigs == twins
    assert len({rig.base.noise_dps_rthz for rig in rigs}) == len(rigs) == 2 * len(CASES)
    assert len({abs(rig.base.bias_dps) for rig in rigs}) == len(rigs) - 1
    for number in (1, 2):
        assert abs(load_rig(written / "bias-3-still" / f"session-{number:02d}.rig.yaml").base.bias_dps) == 3.0


def test_biases_are_spread_like_those_of_real_parts() -> None:
    biases = [
        simulation(case, seed, 0, 1.0, is_still=True).rig.base.bias_dps
        for case in CASES
        if case.name != "bias-3"
        for seed in range(20)
    ]
    assert 0.43 < float(np.std(biases)) < 0.57
    assert abs(float(np.mean(biases))) < 0.1


def test_a_temperature_cycle_warms_and_cools() -> None:
    temp_c = simulation(BY_NAME["temperature"], 1, 0, is_still=True).whole().temp_c
    assert temp_c is not None
    assert temp_c.max() - temp_c[0] > 20.0
    assert temp_c[-1] < temp_c.max() - 10.0


def test_lost_samples_are_lost() -> None:
    session = simulation(BY_NAME["drops"], 1, 0, 5.0, is_still=False).whole()
    assert len(session.rate_dps) == pytest.approx(0.99 * 30000, rel=0.003)


def test_the_same_seed_gives_the_same_bytes(written: Path, tmp_path: Path) -> None:
    options = ["--sessions", "1", "--minutes", "0.5"]
    for seed in ("4", "5"):
        assert main(["simulate", "--hard-cases", "--out", str(tmp_path / seed), "--seed", seed, *options]) == 0
    path = Path("drive-moving", "session-01.mcap")
    first = load_session(written / path)
    assert np.array_equal(load_session(tmp_path / "4" / path).rate_dps, first.rate_dps)
    assert not np.array_equal(load_session(tmp_path / "5" / path).rate_dps, first.rate_dps)


@pytest.mark.parametrize(
    ("option", "value"), [("--profile", "drive"), ("--rig", "a.yaml"), ("--effect", "warmup"), ("--twin", "a.csv")]
)
def test_they_have_rigs_and_motions_of_their_own(
    option: str, value: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["simulate", "--hard-cases", "--out", str(tmp_path), option, value]) == 2
    assert "--hard-cases has its own rigs and motions" in capsys.readouterr().err
