"""Rigs: what is shipped, what is refused."""

from pathlib import Path

import pytest

from firmware_sim.motion.profile import config_folder
from firmware_sim.rig import ENCODER_CPR_MAX, Base, Rig, load_rig, parse_effect, with_effects
from firmware_sim.yaml_file import FileError


def written(folder: Path, text: str) -> Path:
    path = folder / "rig.yaml"
    path.write_text(text)
    return path


def test_the_shipped_rig_is_the_default() -> None:
    rig = load_rig(None)
    assert rig == load_rig(config_folder() / "rig.yaml")
    assert not rig.effects


def test_the_shipped_rig_states_every_base_value() -> None:
    """A reader of the shipped file sees all there is to set."""
    assert load_rig(None).base.model_fields_set == set(Base.model_fields)


def test_an_empty_file_is_a_rig_of_defaults(tmp_path: Path) -> None:
    assert load_rig(written(tmp_path, "# nothing\n")) == Rig()


def test_a_file_sets_what_it_names(tmp_path: Path) -> None:
    """Values of the file are taken, whole numbers and exponents among them; the others keep their defaults."""
    rig = load_rig(written(tmp_path, "base: {sample_rate_hz: 200, noise_dps_rthz: 1e-2, bias_dps: -3, encoder_cpr: 0}"))
    assert rig.base == Base(sample_rate_hz=200.0, noise_dps_rthz=0.01, bias_dps=-3.0, encoder_cpr=0)


@pytest.mark.parametrize(
    ("key", "value"),
    [
        ("sample_rate_hz", "0"),
        ("sample_rate_hz", "65536"),
        ("dps_per_lsb", "0"),
        ("dps_per_lsb", "-0.1"),
        ("noise_dps_rthz", "-1e-9"),
        ("bias_dps", "50.1"),
        ("bias_dps", "on"),
        ("encoder_cpr", "-1"),
        ("encoder_cpr", "1.5"),
        ("encoder_cpr", str(ENCODER_CPR_MAX + 1)),
        ("host_delay_s", "-1"),
        ("host_delay_s", "true"),
        ("host_jitter_s", "-1e-6"),
        ("encoder_absolute", "1"),
        ("encoder_phase_deg", "360.5"),
        ("drift_dps", "1"),
    ],
)
def test_a_value_that_no_rig_can_have_is_told_with_its_place(tmp_path: Path, key: str, value: str) -> None:
    with pytest.raises(FileError, match=rf"rig\.yaml:3:3 base\.{key}: is "):
        load_rig(written(tmp_path, f"# of a test\nbase:\n  {key}: {value}\n"))


def test_all_mistakes_of_a_rig_are_told_at_once(tmp_path: Path) -> None:
    """Two wrong values and an unknown block are three lines."""
    path = written(tmp_path, "base: {sample_rate_hz: 0, bias_dps: 99}\neffect: []\n")
    with pytest.raises(FileError) as caught:
        load_rig(path)
    places = [line.split(" ")[0] for line in str(caught.value).splitlines()]
    assert places == [f"{path}:{index}" for index in ("1:8", "1:27", "2:1")]


def test_an_unknown_effect_is_refused(tmp_path: Path) -> None:
    """A rig with an effect that nobody has heard of does not run as if it had none."""
    with pytest.raises(FileError, match=r"rig\.yaml:1:\d+ effects"):
        load_rig(written(tmp_path, "effects: [{name: gremlins}]\n"))


def test_a_file_lists_effects_and_one_of_them_may_stand_there_twice(tmp_path: Path) -> None:
    """Two tones of vibration are two entries; what a file leaves out has its default."""
    tones = "{name: vibration, amplitude_dps: 1, frequency_hz: 50}"
    rig = load_rig(written(tmp_path, f"effects: [{tones}, {{name: spikes, height_dps: 9}}, {tones}]\n"))
    assert [effect.name for effect in rig.effects] == ["vibration", "spikes", "vibration"]
    assert rig.effects[1] == parse_effect("spikes:height_dps=9,share_percent=0.1")


def test_an_effect_of_the_command_line_has_its_typical_size_or_the_one_given() -> None:
    """A bare name is the usual effect, and parameters stand behind a colon."""
    assert parse_effect("scale_factor") == parse_effect("scale_factor:error_percent=1.5")
    assert parse_effect("encoder_quantization:cpr=720") == parse_effect("encoder_quantization")
    rig = with_effects(with_effects(Rig(), [parse_effect("deadband")]), [parse_effect("latency:delay_ms=1e1")])
    assert [effect.name for effect in rig.effects] == ["deadband", "latency"]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("scale_facto", "did you mean scale_factor"),
        ("gremlins", "there are scale_factor, "),
        ("scale_factor:error_percent=99", "less than or equal to 20"),
        ("scale_factor:error_percent=much", "expected a number"),
        ("scale_factor:error=1", "parameters: error_percent"),
        ("encoder_quantization:cpr=1.5", "cpr"),
    ],
)
def test_a_mistake_in_an_effect_of_the_command_line_is_told(text: str, words: str) -> None:
    """The message repeats what was given and says what there is."""
    with pytest.raises(FileError) as caught:
        parse_effect(text)
    assert str(caught.value).startswith(f"--effect {text}: ")
    assert words in str(caught.value)


@pytest.mark.parametrize("text", ["x" * 100_000, f"scale_factor:{'y' * 100_000}=1", "scale_factor:,a" * 10_000])
def test_what_is_said_of_an_effect_is_short(text: str) -> None:
    with pytest.raises(FileError) as caught:
        parse_effect(text)
    assert len(str(caught.value)) < 2000


def test_the_finest_encoder_has_room_for_180_turns_either_way() -> None:
    assert 180 * ENCODER_CPR_MAX < 2**31
