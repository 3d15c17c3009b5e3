"""gyrodrift: stable yaw from a low-cost gyro, in real time.

Public names are imported on first use; their types are in `__init__.pyi`.
"""

__version__ = "0.1.0"

_PUBLIC = {
    "Hdr": "filters",
    "Restlevel": "filters",
    "AttitudeFilter": "attitude",
    "AttitudeEstimate": "attitude",
    "AttitudeEstimates": "attitude",
    "Estimate": "filters",
    "Estimates": "filters",
    "load_session": "analyses",
    "open_link": "device",
    "simulate": "results",
    "save": "results",
    "plot": "results",
    "tune": "analyses",
    "diagnose": "analyses",
    "compare": "analyses",
}
"""Public names with their modules in `gyrodrift.library`."""

__all__ = ["__version__", *_PUBLIC]  # noqa: PLE0604 - they are strings, and named once


def __getattr__(name: str) -> object:
    if name not in _PUBLIC:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from importlib import import_module  # noqa: PLC0415 - `import gyrodrift` alone must be quick

    return getattr(import_module(f"gyrodrift.library.{_PUBLIC[name]}"), name)


def __dir__() -> list[str]:
    return sorted({*globals(), *_PUBLIC})
