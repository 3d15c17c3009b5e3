"""Exports of diagnosed effects for other simulators: their units, what they contain, and what they say they lack."""

import json
import re
from dataclasses import replace
from math import exp, expm1, pi, sqrt
from pathlib import Path
from xml.etree import ElementTree as ET

import numpy as np
import pytest
import yaml
from diagnosis_support import SCALED, diagnosis
from page_support import words

from firmware_sim.effects.catalogue import CATALOGUE
from gyrodrift.diagnose.export.exported import Exported, ExportedEffect, MeasuredValue, exported_of
from gyrodrift.diagnose.export.files import FORMATS, NAMES, export_line, exports_of, write_exports
from gyrodrift.diagnose.export.gazebo import dynamic_bias, gazebo
from gyrodrift.diagnose.export.kalibr import kalibr
from gyrodrift.diagnose.export.mujoco import mujoco
from gyrodrift.diagnose.report.tables import exported as section
from gyrodrift.diagnose.result import DiagnosedSession
from gyrodrift.effects import EFFECTS, apply
from gyrodrift.report.page import page

RAD = pi / 180.0
NONE = Exported(
    "none: the simulator explains these sessions",
    (),
    100.0,
    MeasuredValue(0.02, 0.018, 0.023),
    MeasuredValue(-0.5, -0.6, -0.3),
    {"rate_random_walk": 0.004},
)


def effect(name: str) -> ExportedEffect:
    """An effect of its typical size, known to a tenth."""
    parameters = {**CATALOGUE[name].typical}
    first = next(iter(parameters))
    around = {first: (0.9 * parameters[first], 1.1 * parameters[first])}
    return ExportedEffect(name, parameters, around, 0.97, (), None)


def with_effects(*names: str) -> Exported:
    return replace(NONE, says="effect: some", effects=tuple(map(effect, names)))


def noise_of(exported: Exported) -> dict[str, float]:
    (text,) = gazebo(exported).files.values()
    (noise,) = ET.fromstring(text).iter("noise")
    return {element.tag: float(element.text or "") for element in noise}


def test_gazebo_has_noise_and_bias_of_a_sample_in_radians() -> None:
    """The bias is the mean of the noise, since Gazebo gives `bias_mean` a random sign."""
    values = noise_of(NONE)
    assert values["stddev"] == pytest.approx(0.02 * 10.0 * RAD, rel=1e-5)
    assert values["mean"] == pytest.approx(-0.5 * RAD, rel=1e-5)
    assert values["bias_mean"] == 0.0
    assert values["bias_stddev"] == pytest.approx(0.15 * RAD, rel=1e-5)
    assert "dynamic_bias_stddev" not in values


def test_a_walk_drives_the_dynamic_bias_of_gazebo() -> None:
    values = noise_of(with_effects("rate_random_walk"))
    stddev, time_s = values["dynamic_bias_stddev"], values["dynamic_bias_correlation_time"]
    steps, step_s = 6000, 0.01
    kept, drive = exp(-step_s / time_s), sqrt(-(stddev**2) * time_s / 2.0 * expm1(-2.0 * step_s / time_s))
    variance = drive**2 * (1.0 - kept ** (2 * steps)) / (1.0 - kept**2)
    assert sqrt(variance) / RAD == pytest.approx(0.005 * sqrt(60.0), rel=0.01)


def test_two_levels_have_the_variance_of_the_dynamic_bias() -> None:
    drive, time_s = dynamic_bias(effect("popcorn"))
    assert drive * sqrt(time_s / 2.0) == pytest.approx(0.1 * RAD)
    assert time_s == 10.0


def test_steps_are_the_precision_of_quantized_noise() -> None:
    """The type says that the value is rounded."""
    exported = with_effects("quantization")
    (text,) = gazebo(exported).files.values()
    assert 'type="gaussian_quantized"' in text
    assert noise_of(exported)["precision"] == pytest.approx(0.25 * RAD, rel=1e-5)


def test_the_file_for_gazebo_has_the_elements_of_its_format_in_their_places() -> None:
    """Model, link and sensor, as `imu.sdf` and `noise.sdf` of SDFormat 1.9 name them."""
    (text,) = gazebo(with_effects("rate_random_walk", "quantization")).files.values()
    root = ET.fromstring(text)
    assert (root.tag, root.get("version")) == ("sdf", "1.9")
    (noise,) = root.findall("model/link/sensor[@type='imu']/imu/angular_velocity/z/noise")
    elements = "mean stddev bias_mean bias_stddev dynamic_bias_stddev dynamic_bias_correlation_time precision"
    assert [element.tag for element in noise] == elements.split()
    assert root.findtext("model/link/sensor/update_rate") == "100"


def test_kalibr_has_densities_in_radians() -> None:
    (text,) = kalibr(with_effects("rate_random_walk")).files.values()
    values = yaml.safe_load(text)
    assert values == {
        "gyroscope_noise_density": pytest.approx(0.02 * RAD, rel=1e-5),
        "gyroscope_random_walk": pytest.approx(0.005 * RAD, rel=1e-5),
        "rostopic": "/imu",
        "update_rate": 100.0,
    }


def test_without_a_walk_kalibr_gets_the_bound_in_a_comment() -> None:
    """A number would be read as measured."""
    (text,) = kalibr(NONE).files.values()
    assert "gyroscope_random_walk" not in yaml.safe_load(text)
    assert f"no walk is diagnosed, below {0.004 * RAD:.6g}" in text.replace(".0e", "e")


def test_small_numbers_are_numbers_in_yaml() -> None:
    """YAML 1.1 reads 7e-05 as a text."""
    (text,) = kalibr(replace(NONE, noise_dps_rthz=MeasuredValue(7e-5 / RAD, 0.0, 1.0))).files.values()
    assert yaml.safe_load(text)["gyroscope_noise_density"] == pytest.approx(7e-5)


def test_json_is_what_the_wrapper_takes(tmp_path: Path) -> None:
    export = FORMATS["json"](with_effects(*CATALOGUE))
    content = json.loads(export.files["effects.json"])
    assert {entry["effect"] for entry in content["effects"]} == EFFECTS.keys() - {"white_noise", "constant_bias"}
    assert {entry["effect"] for entry in content["not_expressed"]} == export.not_expressed.keys()
    assert all(entry["why"] for entry in content["not_expressed"])
    assert content["effects"][0]["intervals"]["error_percent"] == pytest.approx([1.35, 1.65])
    t_s = np.arange(1000) / 100.0
    assert np.isfinite(apply(np.sin(t_s), t_s, content["effects"] + content["noise"])).all()


@pytest.mark.parametrize("name", FORMATS)
def test_what_a_format_cannot_express_is_said_in_it_and_in_the_report(name: str) -> None:
    export = FORMATS[name](with_effects(*CATALOGUE))
    assert {*export.expressed, *export.not_expressed} == CATALOGUE.keys()
    assert not {*export.expressed} & {*export.not_expressed}
    for missing, why in export.not_expressed.items():
        sentence = f"NOT in this file: {missing}: {why}."
        assert all(sentence in text for file, text in export.files.items() if not file.endswith(".json"))
        assert f"{missing}: {why}" in words(page("", [section([export])]))
        assert f"not {missing}: {why}" in export_line(export)


@pytest.mark.parametrize("name", FORMATS)
def test_without_effects_an_export_says_so(name: str) -> None:
    """Noise and bias are still there: they are measured, not diagnosed."""
    export = FORMATS[name](NONE)
    for text in export.files.values():
        assert "none: the simulator explains these sessions" in text
        assert "No effect is diagnosed" in text or '"effects": []' in text
    assert export.expressed == ()


@pytest.mark.parametrize("name", FORMATS)
def test_an_export_states_probability_and_interval(name: str) -> None:
    for text in FORMATS[name](with_effects("scale_factor")).files.values():
        assert re.search(r"error_percent 1.5 % \(1.35 to 1.65\), probability 0.97|\"probability\": 0.97", text)


def test_mujoco_has_noise_and_cutoff_on_the_measured_gyro() -> None:
    """MuJoCo cuts off the values of a sensor of the type user, too."""
    files = mujoco(with_effects("saturation", "latency")).files
    root = ET.fromstring(files["mujoco.xml"])
    (sensor,) = root.findall("sensor/user")
    assert float(sensor.get("noise", "")) == pytest.approx(0.02 * 10.0 * RAD, rel=1e-5)
    assert float(sensor.get("cutoff", "")) == pytest.approx(125.0 * RAD, rel=1e-5)
    compile(files["mujoco_callback.py"], "mujoco_callback.py", "exec")
    assert '{"effect": "latency", "parameters": {"delay_ms": 20.0}}' in files["mujoco_callback.py"]


def test_two_hyphens_do_not_end_a_comment() -> None:
    """XML forbids them in a comment."""
    for export in (gazebo(replace(NONE, says="a -- b")), mujoco(replace(NONE, says="a -- b"))):
        first = next(text for name, text in export.files.items() if not name.endswith(".py"))
        assert ET.fromstring(first).tag in {"sdf", "mujoco"}


def test_a_diagnosis_exports_its_causes() -> None:
    """The causes of `rig.yaml`, with the noise of the recordings."""
    made = diagnosis(SCALED)
    exported = exported_of(made)
    assert [item.name for item in exported.effects] == [c.effect.name for c in made.verdict.causes if c.is_adopted]
    assert exported.effects[0].probability == made.verdict.causes[0].probability
    assert exported.noise_dps_rthz.value == pytest.approx(np.median([s.noise_dps_rthz for s in made.sessions]))


def test_an_export_has_the_difference_to_the_baseline() -> None:
    """Variances of noise subtract, biases too."""
    made = diagnosis(SCALED)
    noise = float(np.median([session.noise_dps_rthz for session in made.sessions]))
    bias = float(np.median([session.bias_dps for session in made.sessions]))
    has = DiagnosedSession("simulator", 2.0, 100.0, 0.1, 0.6 * noise, False, False, False)
    exported = exported_of(replace(made, baseline=(has, has)))
    assert exported.noise_dps_rthz.value == pytest.approx(0.8 * noise)
    assert exported.bias_dps.value == pytest.approx(bias - 0.1)


def test_files_of_formats_that_are_no_longer_asked_for_go(tmp_path: Path) -> None:
    made = diagnosis({})
    write_exports(tmp_path, exports_of(made, ["kalibr", "json", "kalibr"]))
    (tmp_path / "export" / "mine.txt").write_text("mine")
    assert {path.name for path in (tmp_path / "export").iterdir()} == {"imu.yaml", "effects.json", "mine.txt"}
    write_exports(tmp_path, exports_of(made, ["mujoco"]))
    names = {path.name for path in (tmp_path / "export").iterdir()}
    assert names == {"mujoco.xml", "mujoco_callback.py", "mine.txt"}
    assert names - {"mine.txt"} <= {*NAMES}
