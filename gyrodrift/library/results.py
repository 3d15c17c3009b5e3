"""Files and pictures of sessions and results, and simulated sessions, for other programs."""

from collections.abc import Iterable
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

from gyrodrift.io.files import check_writable, write_whole
from gyrodrift.io.installation import need_packages
from gyrodrift.values.errors import UsageError

if TYPE_CHECKING:
    from gyrodrift.compare.comparison import Comparison
    from gyrodrift.diagnose.result import Diagnosis
    from gyrodrift.library.filters import Estimates
    from gyrodrift.session.session import Session
    from gyrodrift.tune.result import Tuning

WIDTH_IN, HEIGHT_IN = 8.0, 3.0
"""Size of a panel, inches."""


def simulate(
    rig: str | PathLike[str] | None = None,
    *,
    effects: Iterable[str] = (),
    profile: str = "turntable",
    minutes: float = 10.0,
    seed: int = 0,
    axes: int | None = None,
) -> "Session":
    """Simulate a session of the rig, as `gyrodrift simulate` does.

    Parameters
    ----------
    rig
        Rig file; None for the shipped rig.
    effects
        Effects to add, as in `--effect`: `scale_factor:error_percent=1.2`.
    profile
        Name of a shipped motion, or a file.
    minutes, seed
        Duration, minutes, and the seed of all random numbers.
    axes
        1, or 3 for three gyro axes and an accelerometer; None for what the rig file says.

    Raises
    ------
    UsageError
        If a file is wrong, or an effect, a profile or a parameter does not exist.
    """
    from firmware_sim.motion.profile import load_motion
    from firmware_sim.rig import load_rig, parse_effect, with_axes, with_effects
    from firmware_sim.yaml_file import FileError
    from gyrodrift.simulation.effects import load
    from gyrodrift.simulation.sessions import Simulation

    if not minutes > 0.0:
        raise UsageError(f"minutes {minutes}: expected a number above 0")
    if axes not in {None, 1, 3}:
        raise UsageError(f"axes {axes}: expected 1 or 3")
    load()
    try:
        plain = with_axes(load_rig(None if rig is None else Path(rig)), axes)
        whole = with_effects(plain, [parse_effect(text) for text in effects])
        motion = load_motion(profile)
    except (FileError, ValueError) as error:
        raise UsageError(str(error)) from error
    return Simulation(whole, motion, seed, 0, minutes).whole()


def save(value: "Session | Tuning | Comparison | Diagnosis", path: str | PathLike[str]) -> None:
    """Write a session or a result to files.

    Parameters
    ----------
    value
        A session; or the result of `tune`, `compare` or `diagnose`.
    path
        For a session a `.mcap` or `.csv` file. For a tuning a `.yaml` file, the config for `serve`. For a comparison a
        folder: compare.json, report.html. For a diagnosis a folder: gap.json, rig.yaml, report.html.

    Raises
    ------
    UsageError
        If the value cannot be saved, or the path cannot be written.
    """
    from gyrodrift.session.session import Session

    target = Path(path)
    if isinstance(value, Session):
        from gyrodrift.session.files import write_session

        write_session(target, [value], _tables(value))
        return
    from gyrodrift.compare.comparison import Comparison
    from gyrodrift.diagnose.result import Diagnosis
    from gyrodrift.tune.result import Tuning

    match value:
        case Tuning():
            _save_tuning(value, target)
        case Comparison():
            _save_comparison(value, target)
        case Diagnosis():
            _save_diagnosis(value, target)
        case _:
            kind = type(value).__name__
            raise UsageError(f"save: expected a session or a result of tune, compare or diagnose, not {kind}")


def _tables(session: "Session") -> dict[str, dict[str, str]]:
    return {name: dict(table) for name, table in session.metadata.items()}


def _save_tuning(tuning: "Tuning", path: Path) -> None:
    from gyrodrift.tune.report.files import write_config

    if path.suffix not in (".yaml", ".yml"):
        raise UsageError(f"{path}: a config ends in .yaml")
    write_config(path, tuning, "")


def _save_comparison(comparison: "Comparison", folder: Path) -> None:
    from gyrodrift.compare.report.files import content
    from gyrodrift.compare.report.page import report_html
    from gyrodrift.report.numbers import write_json
    from gyrodrift.report.provenance import Provenance, date_now

    check_writable(folder)
    write_json(folder / "compare.json", content(comparison))
    write_whole(folder / "report.html", [report_html(comparison, Provenance(folder.name, date=date_now()))])


def _save_diagnosis(diagnosis: "Diagnosis", folder: Path) -> None:
    from gyrodrift.diagnose.report.files import write_files
    from gyrodrift.diagnose.report.page import report_html
    from gyrodrift.report.provenance import Provenance, date_now

    check_writable(folder)
    write_files(folder, diagnosis)
    write_whole(folder / "report.html", [report_html(diagnosis, folder, Provenance(folder.name, date=date_now()))])


def plot(session: "Session", estimates: "Estimates | None" = None) -> Any:
    """Plot the rate and yaw of a session over time.

    Parameters
    ----------
    session
        The session.
    estimates
        Result of `update_batch` over the session, to be drawn with ± 2 standard deviations of yaw.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    UsageError
        If matplotlib is missing, or the estimates belong to another session.
    """
    need_packages("plot", "matplotlib")
    import numpy as np
    from matplotlib.figure import Figure

    from gyrodrift.session.session import unwrapped

    if estimates is not None and len(estimates.yaw_deg) != len(session.t_device_s):
        raise UsageError(f"plot: {len(estimates.yaw_deg)} estimates for {len(session.t_device_s)} samples")
    t_s = session.t_device_s - session.t_device_s[0]
    figure = Figure(figsize=(WIDTH_IN, 2.0 * HEIGHT_IN), layout="constrained")
    rate, yaw = figure.subplots(2, 1, sharex=True)
    rate.plot(t_s, session.rate_dps, linewidth=0.8)
    rate.set_ylabel("rate, deg/s")
    if session.encoder_deg is not None:
        angle_deg = unwrapped(session.encoder_deg)
        yaw.plot(t_s, angle_deg - angle_deg[0], "k:", linewidth=1.2, label="encoder")
    if estimates is not None:
        yaw.plot(t_s, estimates.yaw_deg, linewidth=1.2, label="filter")
        width_deg = 2.0 * np.nan_to_num(estimates.yaw_sigma_deg)
        yaw.fill_between(t_s, estimates.yaw_deg - width_deg, estimates.yaw_deg + width_deg, alpha=0.2, linewidth=0.0)
    yaw.set(xlabel="time, s", ylabel="yaw, deg")
    if yaw.get_legend_handles_labels()[0]:
        yaw.legend()
    return figure
