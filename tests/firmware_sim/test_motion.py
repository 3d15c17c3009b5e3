"""The turntable: exact angles, profiles that go round for ever, and mistakes in their files."""

from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.effects.effect import Floats
from firmware_sim.motion.profile import Profile, config_folder, load_profile
from firmware_sim.yaml_file import FileError

SHIPPED = sorted(path.stem for path in (config_folder() / "profiles").glob("*.yaml"))
STEP_S = 0.005
"""Every segment here is a whole number of steps, so that no step straddles a jump of the rate."""

lengths_s = st.integers(1, 600).map(lambda steps: steps * STEP_S)
rates_dps = st.floats(-200.0, 200.0)
segments = st.one_of(
    st.fixed_dictionaries({"kind": st.sampled_from(["rest", "hold"]), "seconds": lengths_s}),
    st.fixed_dictionaries({"kind": st.just("ramp"), "seconds": lengths_s, "to_dps": rates_dps}),
    st.fixed_dictionaries(
        {
            "kind": st.just("sine"),
            "seconds": lengths_s,
            "amplitude_dps": rates_dps,
            "frequency_hz": st.floats(0.01, 0.5),
        }
    ),
    st.fixed_dictionaries(
        {
            "kind": st.just("steps"),
            "rates_dps": st.lists(rates_dps, min_size=1, max_size=4),
            "ramp_seconds": lengths_s,
            "hold_seconds": lengths_s,
        }
    ),
)
KINDS: dict[str, list[dict[str, Any]]] = {
    "rest": [{"kind": "rest", "seconds": 2.0}],
    "ramp": [{"kind": "ramp", "seconds": 2.0, "to_dps": -90.0}],
    "hold": [{"kind": "ramp", "seconds": 1.0, "to_dps": 30.0}, {"kind": "hold", "seconds": 2.0}],
    "sine": [{"kind": "sine", "seconds": 2.5, "amplitude_dps": 60.0, "frequency_hz": 0.3}],
    "steps": [{"kind": "steps", "rates_dps": [30.0, -90.0, 10.0], "ramp_seconds": 0.5, "hold_seconds": 2.0}],
    "chirp": [{"kind": "chirp", "seconds": 8.0, "amplitude_dps": 30.0, "from_hz": 0.1, "to_hz": 1.0}],
    "multisine": [{"kind": "multisine", "seconds": 8.0, "rms_dps": 10.0, "from_hz": 0.2, "to_hz": 2.0, "tones": 8}],
    "drive": [{"kind": "drive", "minutes": 2.0, "rms_dps": 6.0, "curve_seconds": 6.0, "rest_share": 0.3, "seed": 1}],
}


def profile_of(*parts: dict[str, Any]) -> Profile:
    return Profile.model_validate({"about": "Of a test.", "segments": parts})


profiles = st.lists(segments, min_size=1, max_size=6).map(lambda parts: profile_of(*parts))


def integral_error_deg(profile: Profile, seconds: float) -> Floats:
    edges_s: Floats = np.arange(round(seconds / STEP_S) + 1, dtype=np.float64) * STEP_S
    angle_deg, _ = profile.motion_at(edges_s)
    _, rate_dps = profile.motion_at(edges_s[:-1] + STEP_S / 2.0)
    return angle_deg - np.concatenate(([0.0], np.cumsum(rate_dps * STEP_S)))


def written(folder: Path, text: str) -> str:
    path = folder / "profile.yaml"
    path.write_text(text)
    return str(path)


def mistakes(folder: Path, text: str) -> list[str]:
    """The lines of complaint about a profile, without the folder."""
    path = written(folder, text)
    with pytest.raises(FileError) as caught:
        load_profile(path)
    return [line.removeprefix(f"{folder}/") for line in str(caught.value).splitlines()]


@pytest.mark.parametrize("kind", KINDS)
def test_the_angle_of_every_kind_of_segment_is_the_integral_of_its_rate(kind: str) -> None:
    """Three passes of a lone segment, summed up step by step, come to the exact angle."""
    profile = profile_of(*KINDS[kind])
    assert np.abs(integral_error_deg(profile, 3.0 * profile.seconds)).max() < 0.005


@pytest.mark.parametrize("name", SHIPPED)
def test_the_angle_of_every_shipped_profile_is_the_integral_of_its_rate(name: str) -> None:
    """A pass of what is shipped, summed up step by step, comes to the exact angle."""
    profile = load_profile(name)
    assert np.abs(integral_error_deg(profile, profile.seconds)).max() < 0.005


@given(profiles)
def test_the_angle_of_any_profile_is_the_integral_of_its_rate(profile: Profile) -> None:
    """Segments in any order, each starting at the rate the one before has left."""
    assert np.abs(integral_error_deg(profile, profile.seconds)).max() < 0.02


@given(profiles)
def test_the_angle_never_jumps(profile: Profile) -> None:
    ends_s = np.cumsum([segment.seconds for segment in profile.segments])
    seams_s = np.concatenate((ends_s, ends_s + profile.seconds))
    before_deg, _ = profile.motion_at(seams_s - 1e-9)
    after_deg, _ = profile.motion_at(seams_s + 1e-9)
    np.testing.assert_allclose(after_deg, before_deg, atol=2e-6)


@given(profiles, st.integers(1, 1000), st.floats(0.0, 0.999))
def test_every_pass_goes_on_where_the_one_before_ended(profile: Profile, passes: int, part: float) -> None:
    """A later pass has the angle of the first plus that of the passes between."""
    t_s = part * profile.seconds
    (angle_deg, pass_deg, later_deg), _ = profile.motion_at(
        np.array([t_s, profile.seconds, t_s + passes * profile.seconds])
    )
    assert later_deg - angle_deg == pytest.approx(passes * pass_deg, abs=1e-5)


@given(profiles, st.lists(st.floats(0.0, 100.0), max_size=20))
def test_a_time_has_its_angle_whatever_it_is_asked_with(profile: Profile, times_s: list[float]) -> None:
    """Times in one array, in any order, get the very numbers they get alone."""
    angle_deg, rate_dps = profile.motion_at(np.array(times_s, dtype=np.float64))
    alone = [profile.motion_at(np.array([t_s])) for t_s in times_s]
    assert angle_deg.tolist() == [float(angle[0]) for angle, _ in alone]
    assert rate_dps.tolist() == [float(rate[0]) for _, rate in alone]


def test_a_pass_starts_from_standing_still() -> None:
    """A ramp at the start of the second pass begins at 0, wherever the first one left the rate."""
    profile = profile_of({"kind": "ramp", "seconds": 2.0, "to_dps": 100.0})
    _, rate_dps = profile.motion_at(np.array([0.0, 1.0, 2.0, 3.0]))
    assert rate_dps.tolist() == [0.0, 50.0, 0.0, 50.0]


def test_a_rest_stops_at_once_and_a_hold_goes_on() -> None:
    parts = (KINDS["ramp"][0] | {"to_dps": 30.0}, KINDS["hold"][1], KINDS["rest"][0])
    _, rate_dps = profile_of(*parts).motion_at(np.array([2.5, 3.5, 4.5]))
    assert rate_dps.tolist() == [30.0, 30.0, 0.0]


def test_steps_hold_each_rate_and_come_back() -> None:
    profile = profile_of(*KINDS["steps"])
    angle_deg, rate_dps = profile.motion_at(np.array([0.25, 0.5, 2.5, 3.0, 5.0, 5.5, 7.5, 7.75, 8.0 - 1e-9]))
    np.testing.assert_allclose(rate_dps, [15.0, 30.0, 30.0, -90.0, -90.0, 10.0, 10.0, 5.0, 0.0], atol=1e-6)
    assert (profile.seconds, angle_deg[2]) == (8.0, 0.25 * 30.0 + 2.0 * 30.0)


def test_a_chirp_passes_every_frequency_in_its_time() -> None:
    chirp = {"kind": "chirp", "seconds": 100.0, "amplitude_dps": 30.0, "from_hz": 1.0, "to_hz": 3.0}
    for middle_s, frequency_hz in ((10.0, 1.2), (50.0, 2.0), (90.0, 2.8)):
        t_s = np.arange(middle_s - 2.0, middle_s + 2.0, 1e-4)
        _, rate_dps = profile_of(chirp).motion_at(t_s)
        crossings = np.flatnonzero(np.diff(np.signbit(rate_dps)))
        assert len(crossings) / 8.0 == pytest.approx(frequency_hz, abs=0.13)
        assert rate_dps.max() == pytest.approx(30.0, rel=1e-3)


def test_a_multisine_has_its_tones_and_its_size() -> None:
    segment = {"kind": "multisine", "seconds": 102.0, "rms_dps": 30.0, "from_hz": 0.5, "to_hz": 8.0, "tones": 5}
    _, rate_dps = profile_of(segment).motion_at(np.arange(1.0, 101.0, 0.01))
    heights = 2.0 * np.abs(np.fft.rfft(rate_dps)) / rate_dps.size
    assert sorted(np.argsort(heights)[-5:].tolist()) == [50, 100, 200, 400, 800]
    np.testing.assert_allclose(heights[[50, 100, 200, 400, 800]], 30.0 * np.sqrt(2.0 / 5.0), rtol=1e-9)
    assert np.abs(rate_dps).max() < 30.0 * np.sqrt(2.0 * 5.0)


@pytest.mark.parametrize("kind", ["chirp", "multisine"])
def test_a_wave_fades_in_and_out(kind: str) -> None:
    profile = profile_of({"kind": "ramp", "seconds": 1.0, "to_dps": 50.0}, KINDS[kind][0])
    _, rate_dps = profile.motion_at(np.array([1.0, 1.001, 8.999, 9.0 - 1e-9]))
    np.testing.assert_allclose(rate_dps, 50.0, atol=1e-3)


def test_a_drive_is_the_same_for_the_same_seed_and_has_stops_and_curves() -> None:
    """An hour of curves has the asked-for scatter, and its share of rests stands still."""
    drive = {"kind": "drive", "minutes": 600.0, "rms_dps": 6.0, "curve_seconds": 12.0, "rest_share": 0.2}
    t_s = np.arange(0.0, 36000.0, 0.5)
    (item, again, second) = (profile_of(drive | {"seed": seed}).motion_at(t_s)[1] for seed in (4, 4, 5))
    assert item.tolist() == again.tolist() != second.tolist()
    assert np.mean(item == 0.0) == pytest.approx(0.2 * 0.75, abs=0.03)
    assert item[24::24][item[24::24] != 0.0].std() == pytest.approx(6.0, rel=0.1)


def test_the_air_changes_on_straight_lines_and_starts_again_with_the_profile() -> None:
    fields = {"ambient": [{"at_s": 10.0, "temp_c": 20.0}, {"at_s": 30.0, "temp_c": 40.0}]}
    profile = Profile.model_validate({"about": "a", "segments": [{"kind": "rest", "seconds": 50.0}], **fields})
    temps_c = profile.ambient_at(np.array([-1.0, 0.0, 10.0, 20.0, 30.0, 49.0, 50.0, 70.0]))
    assert temps_c.tolist() == [20.0, 20.0, 20.0, 30.0, 40.0, 40.0, 20.0, 30.0]


def test_air_and_power_have_defaults() -> None:
    """A profile that says nothing is a cold start in a room of 25 °C."""
    profile = profile_of(*KINDS["rest"])
    assert profile.powered_s == 0.0
    assert profile.ambient_at(np.array([0.0, 1e5])).tolist() == [25.0, 25.0]


def test_before_its_start_the_table_stands_still() -> None:
    angle_deg, rate_dps = profile_of(*KINDS["sine"]).motion_at(np.array([-5.0, -1e-9]))
    assert (angle_deg.tolist(), rate_dps.tolist()) == ([0.0, 0.0], [0.0, 0.0])


@pytest.mark.parametrize("name", SHIPPED)
def test_every_shipped_profile_says_what_it_is(name: str) -> None:
    """A shipped profile loads by its bare name and has a sentence about itself."""
    assert load_profile(name).about.rstrip().endswith(".")


def test_the_shipped_turntable_turns_both_ways_and_ends_standing_still() -> None:
    """The usual profile reaches both signs of its fastest rate and has no jump of the rate where it starts again."""
    profile = load_profile("turntable")
    _, rate_dps = profile.motion_at(np.arange(0.0, profile.seconds, 0.01))
    assert (rate_dps.min(), rate_dps.max()) == (-180.0, 180.0)
    assert profile.motion_at(np.array([profile.seconds - 1e-9]))[1][0] == 0.0


def test_the_shipped_rest_never_moves() -> None:
    angle_deg, rate_dps = load_profile("rest").motion_at(np.linspace(0.0, 1000.0, 777))
    assert not angle_deg.any()
    assert not rate_dps.any()


def test_a_file_of_ones_own_is_loaded_by_its_path(tmp_path: Path) -> None:
    """A path to a file is a profile, too, and one starting with 1e-3 means a thousandth."""
    path = written(tmp_path, "about: Short.\nsegments:\n  - {kind: rest, seconds: 1e-3}\n")
    assert load_profile(path).seconds == 0.001


def test_a_file_at_the_name_given_comes_before_a_shipped_profile(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rest").write_text("{about: Mine., segments: [{kind: rest, seconds: 7}]}")
    assert load_profile("rest").about == "Mine."


@pytest.mark.parametrize(
    ("segment", "position", "words"),
    [
        ("{kind: rest, seconds: -1}", "3:18 segments.0.seconds", "greater than 0"),
        ("{kind: rest, seconds: 0}", "3:18 segments.0.seconds", "greater than 0"),
        ("{kind: rest, seconds: on}", "3:18 segments.0.seconds", "valid number"),
        ("{kind: rest, seconds: true}", "3:18 segments.0.seconds", "valid number"),
        ("{kind: rest, seconds: '1'}", "3:18 segments.0.seconds", "valid number"),
        ("{kind: rest, seconds: .inf}", "3:18 segments.0.seconds", "finite number"),
        ("{kind: rest, seconds: 1e400}", "3:18 segments.0.seconds", "finite"),
        ("{kind: rest, seconds: 1, seconds: 2}", "3:30 segments.0.seconds", "given twice"),
        ("{kind: rest, seconds: 1, speed: 2}", "3:30 segments.0.speed", "not known"),
        ("{kind: ramp, seconds: 1}", "3:5 segments.0.to_dps", "missing"),
        ("{kind: ramp, seconds: 1, to_dps: 1e5}", "3:30 segments.0.to_dps", "4000"),
        ("{kind: wobble, seconds: 1}", "3:5 segments.0", "'wobble'"),
        ("{seconds: 1}", "3:5 segments.0", "'kind'"),
        ("rest", "3:5 segments.0", "'rest'"),
    ],
)
def test_a_mistake_in_a_segment_is_told_with_its_place(tmp_path: Path, segment: str, position: str, words: str) -> None:
    """File, line, column and key come first, then what is wrong there."""
    good = "{kind: rest, seconds: 1}"
    (line,) = mistakes(tmp_path, f"about: Wrong.\nsegments:\n  - {segment}\n  - {good}\n")
    assert line.startswith(f"profile.yaml:{position}: ")
    assert words in line


@pytest.mark.parametrize("times_s", [(5, 5), (5, 4)])
def test_the_times_of_the_air_have_to_rise(tmp_path: Path, times_s: tuple[int, int]) -> None:
    """Two temperatures at one time, or going back, are a mistake of the profile."""
    points = ", ".join(f"{{at_s: {at_s}, temp_c: 20}}" for at_s in times_s)
    (line,) = mistakes(tmp_path, f"about: a\nsegments: [{{kind: rest, seconds: 9}}]\nambient: [{points}]\n")
    assert "must increase" in line


def test_an_unknown_kind_is_answered_with_the_known_ones(tmp_path: Path) -> None:
    (line,) = mistakes(tmp_path, "about: a\nsegments: [{kind: wobble}, {kind: rest, seconds: 1}]\n")
    assert all(kind in line for kind in KINDS)


def test_all_mistakes_are_told_at_once_in_the_order_of_the_file(tmp_path: Path) -> None:
    """A file with five mistakes gives five lines, so that one round of corrections is enough."""
    text = "about: 3\nsegments:\n  - {kind: rest, seconds: -1}\n  - {kind: spin}\n  - {kind: hold, sec: 1}\n"
    lines = mistakes(tmp_path, f"{text}  - {{kind: rest, seconds: 1}}\nspeed: 2\n")
    places = [tuple(map(int, line.split(" ")[0].split(":")[1:])) for line in lines]
    assert {position[0] for position in places} == {1, 3, 4, 5, 7}
    assert all(earlier <= later for earlier, later in pairwise(places))


def test_one_wrong_segment_alone_is_one_mistake(tmp_path: Path) -> None:
    """A profile with one segment that is wrong is not also blamed for having none."""
    assert len(mistakes(tmp_path, "about: a\nsegments: [{kind: rest, seconds: -1}]\n")) == 1


def test_a_profile_needs_a_segment(tmp_path: Path) -> None:
    """An empty list of segments is a mistake at the list."""
    (line,) = mistakes(tmp_path, "about: Nothing.\nsegments: []\n")
    assert line.startswith("profile.yaml:2:1 segments: ")


def test_a_missing_file_is_named() -> None:
    """A name that is neither shipped nor a file is repeated in the message."""
    with pytest.raises(FileError, match=r"^no-such-profile\b"):
        load_profile("no-such-profile")
