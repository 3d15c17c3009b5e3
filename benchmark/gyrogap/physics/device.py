"""The real device of a case, and the rig file: what somebody who bought it would write down about it.

Bias, noise, sample rate and host delay differ between the two; one count and the counts per turn do not.
"""

from dataclasses import asdict, dataclass
from typing import Any

from gyrogap.physics.kinds import InjectedEffect
from gyrogap.physics.rig_text import rig_text
from gyrogap.physics.scene import PHYSICS_HZ
from gyrogap.physics.three_axes import ThreeAxisPart

FILTERED_HZ = 3600.0
"""Rate of the fine grid of a device that has a filter: some ten points to its time constant."""


@dataclass(frozen=True, slots=True)
class DrawnDevice:
    """A real device.

    noise_dps_rthz
        Angle random walk: a sample scatters by noise·√sample_rate.
    bias_dps
        One for each session: no device is switched on twice with the same bias.
    host_delay_s, host_scatter_s
        From measurement to host: least, and mean of what comes on top, which scatters as much.
    stamp_scatter_s, clock_ppm
        Of a healthy device clock.
    encoder_absolute
        Whether the encoder tells the true angle; else it is zeroed where it stands at power-on.
    low_pass_hz
        The filter that it is sold with, which the rig states; 0 for none.
    three_axes
        The other two axes and the accelerometer; None for a device of one axis.
    """

    sample_hz: float
    dps_per_lsb: float
    noise_dps_rthz: float
    bias_dps: tuple[float, ...]
    encoder_cpr: int
    host_delay_s: float
    host_scatter_s: float
    stamp_scatter_s: float
    clock_ppm: float
    encoder_absolute: bool = True
    low_pass_hz: float = 0.0
    three_axes: ThreeAxisPart | None = None

    @property
    def healthy_filters(self) -> tuple[InjectedEffect, ...]:
        """Filters of a healthy device, as effects."""
        return (InjectedEffect("one_pole", {"cutoff_hz": self.low_pass_hz}),) if self.low_pass_hz else ()

    @property
    def physics_hz(self) -> float:
        """Least rate of the fine grid."""
        return FILTERED_HZ if self.low_pass_hz else PHYSICS_HZ

    def facts(self) -> dict[str, Any]:
        """For the label."""
        facts = asdict(self)
        return facts if self.three_axes else {name: fact for name, fact in facts.items() if name != "three_axes"}


@dataclass(frozen=True, slots=True)
class RigFile:
    """Values of the rig file.

    encoder_absolute
        None where it does not say.
    effects
        Which the rig has already.
    """

    noise_dps_rthz: float
    bias_dps: float
    host_delay_s: float
    sample_rate_hz: int = 100
    encoder_absolute: bool | None = None
    effects: tuple[InjectedEffect, ...] = ()

    def text(self, device: DrawnDevice) -> str:
        """The file."""
        base = {
            "sample_rate_hz": self.sample_rate_hz,
            "dps_per_lsb": device.dps_per_lsb,
            "noise_dps_rthz": self.noise_dps_rthz,
            "bias_dps": self.bias_dps,
            "encoder_cpr": device.encoder_cpr,
            "host_delay_s": self.host_delay_s,
        }
        if self.encoder_absolute is not None:
            base["encoder_absolute"] = self.encoder_absolute
        return rig_text(base, self.effects, None if device.three_axes is None else device.three_axes.stated())
