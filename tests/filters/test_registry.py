"""A filter that is registered runs everywhere: the one of `docs/extending-filter.md`, as it is printed there."""

import csv
import importlib.util
import json
import sys
from collections.abc import Iterator
from dataclasses import replace
from io import StringIO
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest
from config_support import ReadHere

from gyrodrift.cli import main
from gyrodrift.config.model import load_config
from gyrodrift.config.watch import ConfigWatch
from gyrodrift.filters.filter import Filter
from gyrodrift.filters.registry import FILTERS, register, unregister
from gyrodrift.io.log import open_log
from gyrodrift.link.protocols.decoder import DeviceDescription
from gyrodrift.service.config_follower import ConfigFollower
from gyrodrift.service.pipeline import Pipeline
from gyrodrift.values.errors import ConfigError
from gyrodrift.values.sample import Corrected, Sample

pytestmark = pytest.mark.xdist_group("restlevel_kernel")  # its compilation takes seconds

EXAMPLE = Path(__file__).parents[2] / "docs" / "examples" / "constant.py"
RATE_HZ = 50
CONFIG = "filter: constant\nconstant: {{bias_dps: {bias_dps}}}\n"


@pytest.fixture(scope="module")
def printed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Filter]:
    """The filter of the page."""
    path = tmp_path_factory.mktemp("page") / "constant_bias.py"
    path.write_text(EXAMPLE.read_text())
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[path.stem] = module
    spec.loader.exec_module(module)
    yield cast("Filter", module.CONSTANT)
    del sys.modules[path.stem]


@pytest.fixture
def constant(printed: Filter) -> Iterator[Filter]:
    """Registered for a test."""
    register(printed)
    yield printed
    unregister(printed.name)
    assert list(FILTERS) == ["hdr", "restlevel"]


def write_still(path: Path, bias_dps: float, seconds: int) -> Path:
    """A device that stands still, with this bias and no noise."""
    rows = [f"{n / RATE_HZ},{bias_dps},0.0" for n in range(seconds * RATE_HZ + 1)]
    path.write_text("\n".join(["t_device_s,rate_dps,encoder_deg", *rows, ""]))
    return path


def config_of(tmp_path: Path, text: str) -> Path:
    path = tmp_path / "c.yaml"
    path.write_text(text)
    return path


def test_a_config_takes_its_block_and_says_what_changes(constant: Filter, tmp_path: Path) -> None:
    config = load_config(config_of(tmp_path, CONFIG.format(bias_dps=0.5)))
    assert config.chosen is constant
    assert config.params == constant.params(0.5)
    before = load_config(config_of(tmp_path, CONFIG.format(bias_dps=-1)))
    assert config.changes_from(before) == ["constant.bias_dps: -1.0 → 0.5"]


@pytest.mark.usefixtures("constant")
@pytest.mark.parametrize(
    ("text", "statement"),
    [
        (
            "filter: constant\nconstant: {bias_dp: 1}\n",
            ["c.yaml:2:12 constant.bias_dp: is not a key of this file; did you mean bias_dps?"],
        ),
        (CONFIG.format(bias_dps=11), ["c.yaml:2:12 constant.bias_dps: is 11; expected a number from -10 to 10 deg/s"]),
        ("filter: constant\nconstant: 1\n", ["c.yaml:2:1 constant: is 1; expected a block with bias_dps"]),
        (
            "filter: contsant\nhdr: {i_c_dps: 1, tau_s: 1, theta_w_dps: 1, c1: 1, c2: 1}\n",
            ["c.yaml:1:1 filter: is 'contsant' (text); did you mean constant?"],
        ),
    ],
)
def test_every_mistake_in_its_block_is_told(text: str, statement: list[str], tmp_path: Path) -> None:
    with pytest.raises(ConfigError) as caught:
        load_config(config_of(tmp_path, text))
    assert [problem.removeprefix(f"{tmp_path}/") for problem in caught.value.problems] == statement


def test_a_name_that_is_not_registered_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="expected hdr or restlevel"):
        load_config(config_of(tmp_path, CONFIG.format(bias_dps=0)))


@pytest.mark.usefixtures("constant")
def test_the_command_filter_writes_its_columns(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    session = write_still(tmp_path / "s.csv", 0.5, 4)
    config = config_of(tmp_path, CONFIG.format(bias_dps=0.25))
    assert main(["filter", str(session), "--config", str(config)]) == 0
    rows = list(csv.DictReader(StringIO(capsys.readouterr().out)))
    assert list(rows[0]) == ["t_device_s", "rate_dps", "bias_dps", "yaw_deg", "correction_deg"]
    assert len(rows) == 4 * RATE_HZ + 1
    assert float(rows[-1]["yaw_deg"]) == pytest.approx(1.0)


class Kept:
    """A sink that keeps what it is given."""

    def __init__(self) -> None:
        self.given: list[Corrected] = []

    def take(self, samples: list[Corrected]) -> None:
        self.given += samples

    def tick(self, now_s: float) -> None:
        """Nothing is due."""

    def stats(self) -> dict[str, Any]:
        return {}

    @property
    def is_wanted(self) -> bool:
        return True

    def finish(self) -> None:
        pass

    def wakes(self) -> dict[int, int]:
        return {}

    def close(self) -> None:
        """Nothing is open."""


@pytest.mark.usefixtures("constant")
def test_the_service_changes_over_to_it_and_keeps_yaw(tmp_path: Path) -> None:
    """A second at 1 deg/s by the one filter, a second with 0.5 deg/s taken off by the other: 1.5 deg."""
    plain = "hdr: {i_c_dps: 0, tau_s: 0, theta_w_dps: 1, c1: 0, c2: 1}\n"
    watch, output = ConfigWatch(config_of(tmp_path, plain), ReadHere), Kept()
    link = SimpleNamespace(device=DeviceDescription(), name="")
    pipeline = Pipeline(cast("Any", link), [output], open_log("error", "json"), watch.config)

    def second_from(start_s: int) -> None:
        times_s = [start_s + n / RATE_HZ for n in range(RATE_HZ + 1)]
        pipeline.take([Sample(seq=n, t_device_s=t_s, t_host_s=t_s, rate_dps=1.0) for n, t_s in enumerate(times_s)])

    second_from(0)
    config_of(tmp_path, CONFIG.format(bias_dps=0.5))
    ConfigFollower(pipeline, watch).follow(watch)
    second_from(1)
    assert output.given[RATE_HZ].yaw_deg == pytest.approx(1.0)
    assert output.given[-1].yaw_deg == pytest.approx(1.5)
    assert (output.given[-1].bias_dps, output.given[-1].corrected_dps) == (0.5, 0.5)


@pytest.mark.usefixtures("constant")
def test_tune_finds_its_parameter_without_a_kernel(tmp_path: Path) -> None:
    """Two stills with the same bias: its default costs what plain integration does, and the search finds better."""
    pytest.importorskip("cma", reason="tuning needs the workstation extra")
    for number, seconds in enumerate((4, 6)):
        write_still(tmp_path / f"s{number}.csv", 0.5, seconds)
    paths = [str(tmp_path / f"s{number}.csv") for number in range(2)]
    arguments = ["--filter", "constant", "--iterations", "40", "--jobs", "1", "--report", str(tmp_path / "report")]
    assert main(["tune", *paths, "--out", str(tmp_path / "found.yaml"), *arguments]) == 0
    report = json.loads((tmp_path / "report" / "tune.json").read_text())
    squares = [[(0.5 * n / RATE_HZ) ** 2 for n in range(seconds * RATE_HZ + 1)] for seconds in (4, 6)]
    assert report["euler_pi_train"] == pytest.approx(sum(sum(square) / len(square) for square in squares) / 2)
    result = load_config(tmp_path / "found.yaml").params
    assert report["parameters"] == {"bias_dps": result.bias_dps}  # type: ignore[attr-defined]  # the page's own record
    remaining = abs(result.bias_dps - 0.5)  # type: ignore[attr-defined]
    assert remaining < 0.2
    assert report["pi_train"] == pytest.approx((remaining / 0.5) ** 2 * report["euler_pi_train"])
    assert report["reduced_parameters"] == report["parameters"]  # one parameter is the whole model
    assert "The bias of the sensor, if it never changed." in (tmp_path / "report" / "report.html").read_text()


@pytest.mark.usefixtures("constant")
def test_compare_has_a_row_of_it(tmp_path: Path) -> None:
    """E of a constant 0.25 deg/s that is left of 0.5: half of what plain integration has."""
    pytest.importorskip("cma", reason="comparing needs the workstation extra")
    session = write_still(tmp_path / "s.csv", 0.5, 4)
    config = config_of(tmp_path, CONFIG.format(bias_dps=0.25))
    arguments = ["--still", str(session), "--config", str(config), "--jobs", "1", "--out", str(tmp_path / "out")]
    assert main(["compare", str(session), *arguments]) == 0
    methods = json.loads((tmp_path / "out" / "compare.json").read_text())["methods"]
    rows = {row["method"]: row for row in reversed(methods)}
    assert {"hdr", "restlevel", "constant"} <= rows.keys()
    assert rows["euler"]["e_deg"] == pytest.approx(1.0)
    assert rows["constant"]["e_deg"] == pytest.approx(0.5)
    assert rows["constant"]["title"] == "constant bias, by config"
    assert "constant bias" in (tmp_path / "out" / "report.html").read_text()


def test_what_cannot_be_a_filter_is_refused(printed: Filter) -> None:
    """A name that is taken or no key of its own, parameters that are not those of the record, nothing to search."""
    for name in ("hdr", "filter", "sample_rate_hz", "two words"):
        with pytest.raises(ValueError, match="a filter needs a unique name"):
            register(replace(printed, name=name))
    with pytest.raises(ValueError, match="its record has bias_dps"):
        register(replace(printed, parameters=(replace(printed.parameters[0], name="bias"),)))
    with pytest.raises(ValueError, match="none of its parameters has a range"):
        register(replace(printed, parameters=(replace(printed.parameters[0], search=None),)))
    assert list(FILTERS) == ["hdr", "restlevel"]
