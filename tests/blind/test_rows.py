"""The rows of the set `bench`: what is drawn, what is written, and that devices are spread as people own them."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from blind.cost import yaw_cost_deg
from blind.folder import SetFolder
from blind.prepare import prepare
from blind.rows.case import RowCase
from blind.rows.simulated import Simulated
from blind.rows.table import ROWS, draw_case, draw_rows, find_case
from gyrogap import estimators as by
from gyrogap.catalogue import EFFECTS
from gyrogap.physics.bench import Columns
from gyrogap.physics.dice import plan_dice
from gyrogap.physics.driven import Mover, driven_motion
from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.motion import TOP_DPS
from gyrogap.physics.rig_text import rig_text
from gyrogap.physics.sizes import STRENGTHS
from gyrogap.physics.spread import COUNTS, RATES_HZ, STEPS_DPS, draw_facts, draw_fault_for
from gyrogap.physics.stand import Stand
from gyrogap.physics.write import SessionBatch

GENERATED = (
    *("none_driven", "single", "outside", "loop"),
    *(
        pytest.param(row, marks=pytest.mark.evaluation)
        for row in ("none_generator", "small", "pair", "triple", "left_out")
    ),
)


def drawn(row: str, count: int) -> list[RowCase]:
    return [draw_case(9, row, number) for number in range(count)]


def files_of(case: RowCase, folder: Path) -> dict[str, bytes]:
    case.write(folder)
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


def test_devices_are_spread() -> None:
    """Every encoder, step and rate occurs, and noise over a decade; half of the encoders are absolute."""
    facts = [draw_facts(plan_dice(("spread", number))) for number in range(200)]
    assert {fact.encoder_cpr for fact in facts} == set(COUNTS)
    assert {fact.dps_per_lsb for fact in facts} == set(STEPS_DPS)
    assert {fact.sample_hz for fact in facts} == set(RATES_HZ)
    noises = [fact.noise_dps_rthz for fact in facts]
    assert 0.0015 <= min(noises) < 0.002
    assert 0.015 < max(noises) <= 0.02
    assert 70 <= sum(fact.encoder_absolute for fact in facts) <= 130


@pytest.mark.parametrize("name", ["quantization", "encoder_quantization"])
def test_coarser_is_coarser_than_the_device(name: str) -> None:
    """Steps of two and a half of its own at least, counts of four tenths at most."""
    for number in range(100):
        rng = plan_dice(("coarse", number))
        facts = draw_facts(rng)
        parameters = draw_fault_for(rng, facts, name, "small").parameters
        assert parameters.get("step_dps", np.inf) >= 2.5 * facts.dps_per_lsb
        assert parameters.get("cpr", 0) <= 0.4 * facts.encoder_cpr + 0.5


def test_rows_have_the_effects_that_they_should() -> None:
    assert Counter((case.draft.faults[0].name, case.draft.size) for case in drawn("single", ROWS["single"].count)) == {
        (effect, size): 1 for effect in EFFECTS for size in ("typical", "large")
    }
    assert [case.draft.faults[0].name for case in drawn("small", ROWS["small"].count)] == list(EFFECTS)
    assert [case.draft.withhold for case in drawn("left_out", ROWS["left_out"].count)] == list(EFFECTS)
    assert not any(
        case.draft.faults
        for row in ("none_own", "none_short", "none_generator", "none_driven")
        for case in drawn(row, 40)
    )


def test_own_rigs_have_up_to_two_effects_and_enough_data() -> None:
    cases = drawn("none_own", 80)
    assert {case.draft.rig.count("name:") for case in cases} == {0, 1, 2}
    for case in cases:
        part = case.draft.parts["sessions"]
        assert isinstance(part, Simulated)
        assert 3 <= part.sessions <= 6
        assert part.sessions * part.minutes > 1.0
        assert 25.0 / 60.0 - 1e-3 <= part.minutes <= 6.0
    assert sum(part.minutes < 1.0 for case in cases if isinstance(part := case.draft.parts["sessions"], Simulated)) > 5


@pytest.mark.parametrize("row", GENERATED)
def test_a_case_is_found_by_its_name(row: str, tmp_path: Path) -> None:
    case = draw_case(9, row, 3)
    result = find_case(9, case.name)
    by_number = find_case(9, f"{row}/3")
    assert result is not None
    assert by_number is not None
    assert result.label() == by_number.label() == case.label()
    files = files_of(case, tmp_path / "once")
    assert files == files_of(result, tmp_path / "again")
    folders = {"sessions"} | ({case.draft.then} if case.draft.then else set())
    numbers = range(1, 4)
    assert set(files) == {"rig.yaml", *(f"{folder}/session-{number}.csv" for folder in folders for number in numbers)}


def test_no_row_moves_another() -> None:
    """A case is the same whatever is drawn beside it."""
    alone = [case.title for case in draw_rows(9, ["small"], 3)]
    next_to = [case.title for case in draw_rows(9, ["loop", "small"], 5) if case.row == "small"]
    assert next_to[:3] == alone
    assert len(next_to) == 5


def test_a_folder_can_be_extended(tmp_path: Path) -> None:
    folder = SetFolder(tmp_path / "set")
    prepare(folder, 9, ["small"], 2)
    before = folder.hashes()
    prepare(folder, 9, ["small", "loop"], 3)
    after = folder.hashes()
    assert len(before) == 2
    assert len(after) == len(folder.plan().cases) == 6
    assert {name: after[name] for name in before} == before


def test_the_rig_of_a_loop_is_for_new_sessions_of_the_same_device(tmp_path: Path) -> None:
    """Device and faults are the same, plans and random numbers are not."""
    parts = draw_case(9, "loop", 0).draft.parts
    first, again = parts["sessions"], parts["again"]
    assert isinstance(first, SessionBatch)
    assert isinstance(again, SessionBatch)
    assert (first.device, first.faults) == (again.device, again.faults)
    assert first.plans != again.plans
    assert first.path != again.path


def test_sizes_in_the_rig_are_wrong_and_of_the_same_sign() -> None:
    for case in drawn("wrong_size", 46):
        (fault,) = case.draft.faults
        strength = fault.parameters[STRENGTHS[fault.name].parameter]
        stated = float(case.draft.about.split("the rig says ")[1].split(";")[0])
        assert stated * strength > 0.0
        assert max(stated / strength, strength / stated) >= 1.49
        assert f"name: {fault.name}" in case.draft.rig


def test_both_rigs_of_an_own_wrong_size_differ_by_it_alone() -> None:
    """Base and effects are alike but for one number."""
    case = draw_case(9, "wrong_size", 1)
    part = case.draft.parts["sessions"]
    assert isinstance(part, Simulated)
    lines = zip(part.rig.splitlines(), case.draft.rig.splitlines(), strict=True)
    assert len([there for there, stated in lines if there != stated]) == 1


def test_a_rig_file_is_plain() -> None:
    """Small numbers are written out, and parameters that only the generator knows stay out."""
    settling = InjectedEffect("warmup", {"amplitude_dps": 0.1, "fast_s": 30.0, "slow_s": 150.0, "fast_share": 0.4})
    text = rig_text({"host_jitter_s": 3e-05, "encoder_absolute": True}, [settling])
    assert text.splitlines() == [
        "base:",
        "  host_jitter_s: 0.000030000000",
        "  encoder_absolute: true",
        "effects:",
        "  - {name: warmup, amplitude_dps: 0.1, time_constant_s: 150.0}",
    ]


def session_of(*faults: InjectedEffect, absolute: bool, low_pass_hz: float = 0.0) -> tuple[Columns, float]:
    """A session of a device of 4096 counts that begins at some angle, and that angle."""
    stand = Stand(plan_dice(("stand",)))
    device = replace(stand.device, sample_hz=200.0, encoder_cpr=4096, noise_dps_rthz=0.004, dps_per_lsb=0.0076)
    device = replace(device, encoder_absolute=absolute, low_pass_hz=low_pass_hz)
    return SessionBatch(device, stand.plans, faults, ("session",)).columns(0), stand.plans[0].start_deg


def test_an_incremental_encoder_begins_at_zero_and_an_absolute_one_where_it_stands() -> None:
    zeroed, start_deg = session_of(absolute=False)
    true, _ = session_of(absolute=True)
    assert zeroed.encoder_deg[0] == 0.0
    assert abs(true.encoder_deg[0] - start_deg) <= 180.0 / 4096
    assert true.encoder_deg - zeroed.encoder_deg == pytest.approx(true.encoder_deg[0], abs=1e-9)


def test_an_incremental_encoder_has_a_phase_of_its_own() -> None:
    turn = InjectedEffect("g_sensitivity", {"amplitude_dps": 0.5, "phase_deg": 20.0})
    columns, start_deg = session_of(turn, absolute=False)
    result = by.fit(columns)
    phase_deg = np.degrees(np.arctan2(result["cosine"], result["sine"]))
    off_deg = (phase_deg - start_deg - 20.0 + 180.0) % 360.0 - 180.0
    assert abs(off_deg) < 5.0


def test_the_low_pass_of_a_device_has_one_pole() -> None:
    passed, _ = session_of(absolute=True, low_pass_hz=20.0)
    rate_dps = by.at_rest(passed)
    assert np.var(rate_dps) == pytest.approx(np.pi * 20.0 * 0.004**2, rel=0.12)
    centred = rate_dps - rate_dps.mean()
    pole = np.mean(centred[1:] * centred[:-1]) / np.var(rate_dps)
    assert pole == pytest.approx(np.exp(-2.0 * np.pi * 20.0 / 200.0), abs=0.05)


def test_what_a_fault_costs_is_what_the_integrated_rate_is_off_for_it() -> None:
    """A swing of 0.2 deg/s and 20 s moves yaw by 0.64 deg to and fro, 0.41 in the mean; a doubled row does nothing."""
    stand = Stand(plan_dice(("cost",)), sessions=2)
    swing = InjectedEffect("slow_cycle", {"amplitude_dps": 0.2, "period_s": 20.0})
    costs = [
        yaw_cost_deg(stand.batch(faults, ("cost",)))
        for faults in ((swing,), (InjectedEffect("doubled_rows", {"share_percent": 1.0}),), ())
    ]
    assert costs[0] == pytest.approx(0.2 * 20.0 / np.pi**2, rel=0.2)
    assert costs[1:] == [pytest.approx(0.0, abs=0.01), 0.0]


@pytest.mark.parametrize(
    ("mover", "least_dps", "most_dps"), [("robot", 1.0, 90.0), ("hand", 10.0, 60.0), ("drone", 3.0, 90.0)]
)
def test_what_no_table_turns_never_stands_once_it_moves(mover: Mover, least_dps: float, most_dps: float) -> None:
    begin_at_rest = 0
    for number in range(12):
        motion = driven_motion(plan_dice(("driven", mover, number)), 1.0 / 800.0, 60.0, mover)
        moving_dps = motion.rate_dps[16_000:]
        assert least_dps < moving_dps.std() < most_dps
        assert np.abs(moving_dps).max() <= TOP_DPS
        assert np.count_nonzero(moving_dps == 0.0) < 2
        begin_at_rest += not motion.motor_on[0]
    assert 2 < begin_at_rest < 12


def test_what_is_outside_the_catalogue_says_what_it_costs() -> None:
    assert draw_case(9, "outside", 0).label()["yaw_cost_deg"] > 0.0
    assert "yaw_cost_deg" not in draw_case(9, "single", 0).label()
