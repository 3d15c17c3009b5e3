"""Yaw for the live line of a recording; the file has the samples as measured."""

from gyrodrift.calibration import NO_CALIBRATION, Calibration, of_this_device
from gyrodrift.filters.filter import Filter, FilterParams, FilterState
from gyrodrift.link.link import Link
from gyrodrift.sample import Sample


class LiveYaw:
    """Runs a filter over the samples, after the calibration if it belongs to their device."""

    def __init__(self, chosen: Filter, params: FilterParams, calibration: Calibration | None = None) -> None:
        self._calibration = calibration
        self._step, self._coefficients = chosen.step_auxiliary, chosen.coefficients(params)
        self._state: FilterState = chosen.state()

    def take(self, samples: list[Sample], link: Link) -> None:
        """Filter samples of a link."""
        step, coefficients, state = self._step, self._coefficients, self._state
        calibration = self._applied_to(link)
        for sample in samples:
            rate_dps = calibration.rate_dps(sample.rate_dps, sample.temp_c)
            step(coefficients, state, sample.t_device_s, rate_dps, sample.still, sample.temp_c)

    def _applied_to(self, link: Link) -> Calibration:
        return of_this_device(self._calibration, link.device.device_id, link.name) or NO_CALIBRATION

    @property
    def text(self) -> str:
        """Yaw as the live line shows it."""
        return f"yaw {round(self._state.yaw_deg, 1) + 0.0:+.1f} deg"  # no −0.0
