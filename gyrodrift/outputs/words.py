"""The figures of a running service as a person reads them: the same words on the page and in the terminal."""

from dataclasses import dataclass

from gyrodrift.outputs.status import FilterStatus, LinkStatus, ServiceStatus


@dataclass(frozen=True, slots=True)
class Figure:
    """One of them; `says` is a value with its unit, or a dash where it is not known."""

    label: str
    says: str


UNKNOWN = "–"


def figures(status: ServiceStatus) -> list[Figure]:
    """In the order in which a person looks."""
    return [*_of_filter(status.filter), *_of_link(status.link)]


def _of_filter(now: FilterStatus) -> list[Figure]:
    rest = UNKNOWN if now.rest_probability is None else f"{now.rest_probability:.0%}"
    heading = [Figure("Heading", f"{now.heading_deg:.1f}°")] if now.heading_deg is not None else []
    return [
        Figure("Yaw", f"{now.yaw_deg:+.2f}{_margin(now.yaw_sigma_deg, 2)} deg"),
        *heading,
        Figure("Drift estimate", f"{now.bias_dps:+.4f}{_margin(now.bias_sigma_dps, 4)} deg/s"),
        Figure("At rest", rest),
        Figure("Temperature", UNKNOWN if now.temp_c is None else f"{now.temp_c:.1f} °C"),
    ]


def _of_link(now: LinkStatus) -> list[Figure]:
    return [
        Figure("Sample rate", f"{now.rate_hz:.1f} Hz"),
        Figure("Jitter", f"{now.jitter_ms:.1f} ms"),
        Figure("Samples", f"{now.samples}"),
        Figure("Gaps", f"{now.gaps} ({now.missing} samples)" if now.gaps else "0"),
        Figure("Damaged frames", f"{now.damaged}"),
    ]


def _margin(sigma: float | None, digits: int) -> str:
    """Standard deviation behind a value, where it is known."""
    return "" if sigma is None else f" ± {sigma:.{digits}f}"
