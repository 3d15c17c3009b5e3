"""Values of a running service with labels and units, for the terminal."""

from dataclasses import dataclass

from gyrodrift.outputs.fields import Field, Use, fields_of
from gyrodrift.outputs.status import FilterStatus, LinkStatus, ServiceStatus


@dataclass(frozen=True, slots=True)
class Figure:
    """A labeled value; `says` is the value with its unit, or a dash if it is unknown."""

    label: str
    says: str


UNKNOWN = "–"


def figures(status: ServiceStatus) -> list[Figure]:
    """Values in order of importance."""
    return [*_filter_figures(status.filter), *_link_figures(status.link)]


def _filter_figures(now: FilterStatus) -> list[Figure]:
    rest = UNKNOWN if now.rest_probability is None else f"{now.rest_probability:.0%}"
    heading = [Figure("Heading", f"{now.heading_deg:.1f}°")] if now.heading_deg is not None else []
    scale = [Figure("Sigma of scale", f"{now.scale_sigma_deg:.2f} deg")] if now.scale_sigma_deg is not None else []
    return [
        Figure("Yaw", f"{now.yaw_deg:+z.2f}{_margin(now.yaw_sigma_deg, 2)} deg"),
        *scale,
        *heading,
        *_device_figures(now),
        *_tilt_figures(now),
        Figure("Bias", f"{now.bias_dps:+z.4f}{_margin(now.bias_sigma_dps, 4)} deg/s"),
        Figure("At rest", rest),
        *(_figure(field, getattr(now, field.name)) for field in fields_of(Use.FIGURE)),
    ]


def _figure(field: Field, value: float | None) -> Figure:
    """Line of a field by its record."""
    return Figure(field.title, UNKNOWN if value is None else f"{value:.{field.shown}f} {field.unit}".rstrip())


def _device_figures(now: FilterStatus) -> list[Figure]:
    """Yaw of the device's own filter; no figures for a device without one."""
    if now.device_yaw_deg is None or now.device_difference_deg is None:
        return []
    return [
        Figure("Device yaw", f"{now.device_yaw_deg:+z.2f}{_margin(now.device_yaw_sigma_deg, 2)} deg"),
        Figure("Difference", f"{now.device_difference_deg:+z.2f} deg"),
    ]


def _tilt_figures(now: FilterStatus) -> list[Figure]:
    """Attitude of a device with three axes; no figures for one axis."""
    if now.roll_deg is None or now.pitch_deg is None or now.tilt_deg is None:
        return []
    return [
        Figure("Roll", f"{now.roll_deg:+z.1f} deg{_side(now.roll_deg, 'right side down', 'left side down')}"),
        Figure("Pitch", f"{now.pitch_deg:+z.1f} deg{_side(now.pitch_deg, 'nose down', 'nose up')}"),
        Figure("Tilt", f"{now.tilt_deg:z.1f}{_margin(now.tilt_sigma_deg, 2)} deg"),
    ]


def _side(angle_deg: float, positive: str, negative: str) -> str:
    """Direction of an angle that is not shown as 0."""
    return "" if round(angle_deg, 1) == 0.0 else f", {positive if angle_deg > 0.0 else negative}"


def _link_figures(now: LinkStatus) -> list[Figure]:
    return [
        Figure("Sample rate", f"{now.rate_hz:.1f} Hz"),
        Figure("Jitter", f"{now.jitter_ms:.1f} ms"),
        Figure("Samples", f"{now.samples}"),
        Figure("Gaps", f"{now.gaps} ({now.missing} samples)" if now.gaps else "0"),
        Figure("Damaged frames", f"{now.damaged}"),
    ]


def _margin(sigma: float | None, digits: int) -> str:
    """Standard deviation behind a value; empty if unknown."""
    return "" if sigma is None else f" ± {sigma:.{digits}f}"
