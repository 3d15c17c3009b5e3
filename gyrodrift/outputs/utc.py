"""Times as text."""

from datetime import UTC, datetime


def iso_time(unix_s: float) -> str:
    """UTC, with milliseconds, as gpsd and Signal K write it."""
    return datetime.fromtimestamp(unix_s, UTC).isoformat(timespec="milliseconds").replace("+00:00", "Z")
