"""Yaw of what is being recorded, for the person who looks on; the file has the samples as they came."""

from gyrodrift.filters.filter import Filter, FilterParams, FilterState
from gyrodrift.sample import Sample


class LiveYaw:
    """Runs a filter over the samples."""

    def __init__(self, chosen: Filter, params: FilterParams) -> None:
        self._step, self._coefficients = chosen.step_beside, chosen.coefficients(params)
        self._state: FilterState = chosen.state()

    def take(self, samples: list[Sample]) -> None:
        """Filter samples."""
        step, coefficients, state = self._step, self._coefficients, self._state
        for sample in samples:
            step(coefficients, state, sample.t_device_s, sample.rate_dps, sample.still, sample.temp_c)

    @property
    def text(self) -> str:
        """What the live line says of it."""
        return f"yaw {round(self._state.yaw_deg, 1) + 0.0:+.1f} deg"  # no −0.0
