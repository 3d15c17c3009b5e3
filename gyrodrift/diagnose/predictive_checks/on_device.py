"""Heading error of the filter that the device runs itself, and of restlevel on the same samples."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from gyrodrift.evaluation.attitude import attitude_history
from gyrodrift.evaluation.dataset import LoadedSession, Source, load_with_reference
from gyrodrift.evaluation.kernels.kernel import kernel_of
from gyrodrift.evaluation.score import Uncertainty, mean_score, mean_uncertainty, score_of, uncertainty_of
from gyrodrift.evaluation.space import row_of
from gyrodrift.filters.restlevel_filter import RESTLEVEL
from gyrodrift.session.checks.stated import AS_WRITTEN, ReadingOptions, session_as_stated
from gyrodrift.values.arrays import Floats
from gyrodrift.values.errors import DataError


@dataclass(frozen=True, slots=True)
class OnDeviceYaw:
    """Mean absolute yaw errors against the encoder over all sessions, deg.

    e_device_deg, e_restlevel_deg
        Error of the device's own filter as recorded, and of restlevel at its defaults.
    within_2_sigma
        Share of samples whose error is within two of the standard deviations that the device states; None if it states
        none.
    """

    e_device_deg: float
    e_restlevel_deg: float
    within_2_sigma: float | None


def on_device_yaw(paths: Sequence[Path], reading: ReadingOptions = AS_WRITTEN) -> OnDeviceYaw | None:
    """Errors over these sessions; None unless all of them have the device's own yaw."""
    if not paths or not all(_has_own_yaw(path, reading) for path in paths):
        return None
    try:
        sessions = [load_with_reference(Source(path, reading=reading)) for path in paths]
    except DataError:  # in rare cases a session passes the checks of a diagnosis, but not those of an evaluation
        return None
    uncertainty = mean_uncertainty([_stated(loaded) for loaded in sessions])
    return OnDeviceYaw(
        mean_score([score_of(loaded.reference, _own_deg(loaded)) for loaded in sessions]).e_deg,
        mean_score([score_of(loaded.reference, _restlevel_deg(loaded)) for loaded in sessions]).e_deg,
        None if uncertainty is None else uncertainty.coverage,
    )


def _has_own_yaw(path: Path, reading: ReadingOptions) -> bool:
    return session_as_stated(path, reading).device_yaw_deg is not None


def _own_deg(loaded: LoadedSession) -> Floats:
    """(n,) yaw of the device, counted from its first value, deg."""
    device_yaw = loaded.reference.device_yaw
    assert device_yaw is not None  # noqa: S101 - checked before
    from_start_deg: Floats = device_yaw.yaw_deg - device_yaw.yaw_deg[0]
    return from_start_deg


def _stated(loaded: LoadedSession) -> Uncertainty | None:
    """Agreement of the errors of the device with the sigmas that it states; None if it states none."""
    device_yaw = loaded.reference.device_yaw
    assert device_yaw is not None  # noqa: S101 - checked before
    return uncertainty_of(loaded.reference, _own_deg(loaded), device_yaw.yaw_sigma_deg)


def _restlevel_deg(loaded: LoadedSession) -> Floats:
    """(n,) yaw by restlevel at its defaults, on all axes that the session has, deg."""
    reference = loaded.reference
    if reference.axes is not None:
        return attitude_history(loaded.t_s, reference.axes, reference.auxiliary).yaw_deg
    row = row_of(RESTLEVEL.params())[0]
    yaw_deg: Floats = kernel_of(RESTLEVEL).yaw(reference.dt_s, reference.rate_dps, row, reference.auxiliary)
    return yaw_deg
