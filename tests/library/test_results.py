"""Results in a program and a notebook: short, as tables, saved and plotted; sessions that are simulated."""

import inspect
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from turntable_sessions import write_turntables

import gyrodrift
from gyrodrift.io.result_table import ResultTable
from gyrodrift.library.filters import DriftFilter
from gyrodrift.tune.result import Tuning
from gyrodrift.values import errors
from gyrodrift.values.errors import UsageError


@pytest.fixture(scope="module")
def sessions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("results") / "sessions"
    write_turntables(folder, 3, minutes=0.5)
    return folder


@pytest.fixture(scope="module")
def tuning(sessions: Path) -> Tuning:
    pytest.importorskip("numba", reason="tuning needs the workstation extra")
    return gyrodrift.tune(sessions, filter="hdr", tests=min(sessions.iterdir()), iterations=16)


@pytest.mark.promise("Installation and systems")
@pytest.mark.parametrize("kind", [gyrodrift.Hdr, gyrodrift.Restlevel])
def test_help_shows_every_parameter_with_type_and_default(kind: type[DriftFilter]) -> None:
    """`help` of a filter shows every parameter with type and default."""
    signature, text = inspect.signature(kind), inspect.getdoc(kind) or ""
    for name, default in asdict(kind.filter.params()).items():
        assert signature.parameters[name].annotation == float | None
        assert f"{name} : float, default {default:g}" in text or f"{name} : float, default {default}" in text


def test_representations_are_short(sessions: Path, tuning: Tuning) -> None:
    """A line each, whatever the value holds."""
    estimates = gyrodrift.Hdr(tau_s=0.5).update_batch([0.2, 0.3], [0.0, 0.01])
    session = gyrodrift.load_session(min(sessions.iterdir()))
    assert repr(gyrodrift.Hdr(tau_s=0.5)) == "Hdr(tau_s=0.5)"
    assert repr(gyrodrift.Restlevel()) == "Restlevel()"
    assert repr(estimates) == "Estimates(2 samples, yaw ends at 0.003 deg)"
    assert repr(session) == f"Session('table-0', {len(session.rate_dps)} samples, 30.0 s)"
    assert repr(tuning) == "Tuning(HDR, tuned, 3 sessions, 16 evaluations)"


def test_a_result_is_a_table_in_a_notebook(tuning: Tuning) -> None:
    html = tuning._repr_html_()
    assert html.startswith("<table><caption>Tuning(HDR, tuned")
    assert html.count("<tr>") == 1 + len(tuning.alternatives)
    assert "<td>restlevel, defaults</td>" in html
    assert "20 of 30 rows" in gyrodrift.Hdr().update_batch(np.ones(30), np.arange(30.0))._repr_html_()


def test_a_result_is_an_arrow_table(sessions: Path, tuning: Tuning) -> None:
    pytest.importorskip("pyarrow", reason="pyarrow is not installed")
    assert tuning.to_arrow().column("name").to_pylist() == [way.title for way in tuning.alternatives]
    session = gyrodrift.load_session(min(sessions.iterdir()))
    assert session.to_arrow().column("rate_dps").to_numpy().tolist() == session.rate_dps.tolist()


@pytest.mark.parametrize(("method", "package"), [("to_pandas", "pandas"), ("to_arrow", "pyarrow")])
def test_a_missing_package_is_told_with_its_command(method: str, package: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(__import__("sys").modules, package, None)
    table: ResultTable = gyrodrift.Hdr().update_batch([0.2], [0.0])
    with pytest.raises(UsageError, match=f"{method} needs the package {package}: .*install"):
        getattr(table, method)()


def test_a_session_of_three_axes_is_simulated() -> None:
    session = gyrodrift.simulate(minutes=0.2, profile="hand", axes=3, effects=["gyro_misalignment"])
    assert session.gyro_dps is not None
    assert session.accel_mps2 is not None
    assert session.gyro_dps.shape == session.accel_mps2.shape == (1200, 3)
    assert gyrodrift.simulate(minutes=0.2, profile="hand").gyro_dps is None


def test_a_session_is_simulated_filtered_saved_and_plotted(tmp_path: Path) -> None:
    """A seed determines the session; a saved session loads as it was."""
    session, again = (gyrodrift.simulate(minutes=0.1, effects=["scale_factor:error_percent=5"], seed=3) for _ in "ab")
    assert session.rate_dps.tolist() == again.rate_dps.tolist()
    gyrodrift.save(session, tmp_path / "s.mcap")
    assert gyrodrift.load_session(tmp_path / "s.mcap").rate_dps.tolist() == session.rate_dps.tolist()
    pytest.importorskip("matplotlib", reason="pictures need the workstation extra")
    estimates = gyrodrift.Restlevel().update_batch(session.rate_dps, session.t_device_s)
    rate, yaw = gyrodrift.plot(session, estimates).axes
    assert (rate.get_ylabel(), yaw.get_ylabel()) == ("rate, deg/s", "yaw, deg")
    assert [line.get_label() for line in yaw.lines] == ["encoder", "filter"]


def test_a_tuning_is_saved_as_the_config_of_serve(tuning: Tuning, tmp_path: Path) -> None:
    gyrodrift.save(tuning, tmp_path / "my.yaml")
    assert asdict(gyrodrift.Hdr.from_config(tmp_path / "my.yaml").params) == pytest.approx(asdict(tuning.params))


@pytest.mark.parametrize(
    ("call", "statement"),
    [
        (lambda index, _: gyrodrift.simulate(effects=["gremlins"]), "gremlins"),
        (lambda index, _: gyrodrift.simulate(minutes=0.0), "expected a number above 0"),
        (lambda index, _: gyrodrift.simulate(axes=2), "axes 2: expected 1 or 3"),
        (lambda index, _: gyrodrift.simulate(effects=["accel_bias"]), "needs a rig with three axes"),
        (lambda index, _: gyrodrift.simulate(rig=index / "none.yaml"), "none.yaml"),
        (lambda index, _: gyrodrift.save("text", index), "expected a session or a result"),  # type: ignore[arg-type]
        (lambda index, tuning: gyrodrift.save(tuning, index / "my.txt"), "a config ends in .yaml"),
    ],
)
def test_a_wrong_call_is_told(call: Any, statement: str, tuning: Tuning, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=statement) as caught:
        call(tmp_path, tuning)
    assert isinstance(caught.value, UsageError)


@pytest.mark.promise("Installation and systems")
@pytest.mark.parametrize(
    ("kind", "built_in"),
    [
        (errors.UsageError, ValueError),
        (errors.ConfigError, ValueError),
        (errors.DataError, ValueError),
        (errors.PortMissingError, FileNotFoundError),
        (errors.PortDeniedError, PermissionError),
        (errors.DeviceSilentError, TimeoutError),
    ],
)
def test_errors_are_the_built_in_ones_too(kind: type[errors.GyrodriftError], built_in: type[Exception]) -> None:
    """Errors are also the built-in errors that programs catch."""
    message: Any = ["a: what happened"] if kind is errors.ConfigError else "a: what happened"
    error = kind(message)
    assert isinstance(error, built_in)
    assert str(error) == "a: what happened"
