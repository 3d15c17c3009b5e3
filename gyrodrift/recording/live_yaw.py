"""Yaw for the live line of a recording; the file has the samples as measured."""

from gyrodrift.filters.run import FilterRun
from gyrodrift.link.link import Link
from gyrodrift.values.calibration import NO_CALIBRATION, Calibration, of_this_device
from gyrodrift.values.sample import Sample


class LiveYaw:
    """Runs a filter over the samples, after the calibration if it belongs to their device."""

    def __init__(self, run: FilterRun, calibration: Calibration | None = None) -> None:
        self._calibration = calibration
        self._run = run

    def take(self, samples: list[Sample], link: Link) -> None:
        """Filter samples of a link."""
        calibration, step = self._applied_to(link), self._run.step
        for sample in map(calibration.sample, samples):
            step(sample.t_device_s, sample.rate_dps, sample.inertial, sample.still, sample.temp_c)

    def _applied_to(self, link: Link) -> Calibration:
        return of_this_device(self._calibration, link.device.device_id, link.name) or NO_CALIBRATION

    @property
    def text(self) -> str:
        """Yaw as the live line shows it."""
        return f"yaw {round(self._run.state.yaw_deg, 1) + 0.0:+.1f} deg"  # no −0.0
