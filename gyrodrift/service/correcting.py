"""Corrected samples from the filter: yaw with its zero and heading, attitude, and the raw yaw beside them."""

from dataclasses import dataclass, field
from math import nan

from gyrodrift.filters.run import FilterRun
from gyrodrift.service.reference import DeviceReference, EncoderReference, YawReference
from gyrodrift.values.sample import Attitude, Corrected, Sample


@dataclass(slots=True)
class Correcting:
    """Runs the filter over samples.

    run
        The running filter.
    raw_yaw_deg
        Integral of the measured rate, deg.
    last
        Last sample that the filter accepted.
    """

    run: FilterRun
    reference: YawReference = field(default_factory=YawReference)
    encoder: EncoderReference = field(default_factory=EncoderReference)
    device: DeviceReference = field(default_factory=DeviceReference)
    raw_yaw_deg: float = 0.0
    last: Sample | None = None

    def take(self, samples: list[Sample]) -> list[Corrected]:
        """Corrected samples, without those that the filter rejects."""
        step, corrected = self.run.step, []
        for sample in samples:
            if step(sample.t_device_s, sample.rate_dps, sample.inertial, sample.still, sample.temp_c):
                self._integrate(sample)
                corrected.append(self._corrected(sample))
        return corrected

    def zero(self) -> None:
        """Set yaw and its sigma to 0 at the last sample."""
        self.run.zero()
        self.reference.zero(self.run.state.yaw_deg, self.raw_yaw_deg)
        self.encoder.align()
        self.device.align()

    @property
    def yaw_deg(self) -> float:
        """Yaw of the output, deg."""
        return float(self.run.state.yaw_deg) - self.reference.zero_deg

    def _integrate(self, sample: Sample) -> None:
        last = self.last
        if last is not None:
            self.raw_yaw_deg += 0.5 * (sample.rate_dps + last.rate_dps) * (sample.t_device_s - last.t_device_s)
        self.last = sample

    def _corrected(self, sample: Sample) -> Corrected:
        state, reference = self.run.state, self.reference
        bias_dps, yaw_deg = state.bias_dps, state.yaw_deg
        zeroed_deg = yaw_deg - reference.zero_deg
        has_axes = self.run.three_axes is not None
        return Corrected(
            sample,
            (state.heading_rate_dps if has_axes else sample.rate_dps) - bias_dps,
            zeroed_deg,
            bias_dps,
            state.yaw_sigma_deg,
            state.confidence,
            state.bias_sigma_dps,
            state.rest_probability,
            self.raw_yaw_deg - reference.raw_zero_deg,
            reference.heading_deg(yaw_deg) if reference.has_north else nan,
            self.encoder.angle_deg(sample.encoder_deg, zeroed_deg),
            self.attitude() if has_axes else None,
            self.device.take(sample.device_yaw, zeroed_deg),
        )

    def attitude(self) -> Attitude:
        """Attitude on three axes, with the heading of the output: 0 where yaw is 0."""
        return self.run.attitude(-self.reference.zero_deg)
