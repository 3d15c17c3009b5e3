"""Signals of a DBC file as a CAN gyro, read by cantools."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from gyrodrift.columns.spec import ACCELERATION_MPS2, RATE_DPS
from gyrodrift.io.files import UnreadableError, in_time, read_ordinary
from gyrodrift.link.sources.can_frames import EXTENDED, FORCES, RATES, CanGyro
from gyrodrift.values.errors import UsageError

SIGNALS = {"signal": "gz", "x": "gx", "y": "gy", "ax": "ax", "ay": "ay", "az": "az", "temp": "temp"}
"""Options of an address that name a signal, and the values that they give."""

SIGNALS_ALONE = "signals"
"""Name of frames whose signals are values of a second source, and no gyro."""

RATE_UNITS = {
    **dict.fromkeys(("deg/s", "°/s", "deg/sec", "degree/s", "degrees/s", "dps", "grad/s"), "dps"),
    **dict.fromkeys(("rad/s", "rad/sec"), "rads"),
    **dict.fromkeys(("mrad/s",), "mrads"),
    **dict.fromkeys(("mdeg/s", "mdps"), "mdps"),
}
FORCE_UNITS = {
    **dict.fromkeys(("m/s2", "m/s^2", "m/s²", "m/s**2", "mps2", "m/ss"), "mps2"),
    "g": "g",
    "mg": "mg",
}
"""Spellings of units in DBC files, in lower case."""

LONGEST_BYTES, PARSE_S = 16 << 20, 20.0
"""Largest file, and longest time to parse it, s. Chosen: a DBC file of a whole car has 1 MB, and takes some seconds."""

KINDS = ("arxml", "cdd", "dbc", "kcd", "sym")
ENCODINGS = {"dbc": "cp1252", "sym": "cp1252"}
"""Formats of cantools, and encodings of those that are not UTF-8, as `cantools.database.load_file` has them."""


def dbc_gyro(text: str, options: Mapping[str, str], *, is_upside_down: bool) -> CanGyro:
    """Gyro whose signals the options of an address name.

    Raises
    ------
    UsageError
        The file cannot be read, a signal is missing or ambiguous, or its unit is unknown.
    """
    database = _loaded(text, Path(options["dbc"]))
    scales: dict[int, list[tuple[str, str, float]]] = {}
    messages: dict[int, Any] = {}
    for option, field in SIGNALS.items():
        if option in options:
            message, signal = _signal_named(text, database, option, options[option])
            number = message.frame_id | (EXTENDED if message.is_extended_frame else 0)
            scale = _scale(text, field, signal, options)
            scales.setdefault(number, []).append((field, signal.name, scale))
            messages[number] = message

    def fields(number: int, content: bytes) -> Mapping[str, float]:
        """Values of a frame; empty if it does not fit the file."""
        try:
            decoded = messages[number].decode(content, decode_choices=False, allow_truncated=True)
        except Exception:  # noqa: BLE001 - cantools and bitstruct have errors of several kinds for a frame that does not fit
            return {}
        return {
            field: float(decoded[name]) * scale
            for field, name, scale in scales[number]
            if isinstance(decoded.get(name), (int, float))
        }

    return CanGyro(options["signal"], frozenset(messages), fields, is_upside_down)


def dbc_signals(text: str, options: Mapping[str, str]) -> CanGyro:
    """Frames with the signals of the option `signals`, whose values are in the units of the file.

    Raises
    ------
    UsageError
        As for `dbc_gyro`.
    """
    database, names = _loaded(text, Path(options["dbc"])), options["signals"].split(",")
    pairs = [_signal_named(text, database, "signals", name) for name in names]
    messages = {message.frame_id | (EXTENDED if message.is_extended_frame else 0): message for message, _ in pairs}

    def fields(number: int, content: bytes) -> Mapping[str, float]:
        """Values of a frame by the names of its signals; empty if it does not fit the file."""
        try:
            decoded = messages[number].decode(content, decode_choices=False, allow_truncated=True)
        except Exception:  # noqa: BLE001 - as above
            return {}
        return {name: float(value) for name, value in decoded.items() if isinstance(value, (int, float))}

    return CanGyro(SIGNALS_ALONE, frozenset(messages), fields)


def _loaded(text: str, path: Path) -> Any:
    import cantools.database

    ending = path.suffix.lower().removeprefix(".")
    try:
        content = read_ordinary(path, LONGEST_BYTES).content
        written = content.decode(ENCODINGS.get(ending, "utf-8"))
        kind = ending if ending in KINDS else None
        database = in_time(lambda: cantools.database.load_string(written, kind, strict=False), PARSE_S)
    except (FileNotFoundError, UnreadableError) as error:
        why = getattr(error, "strerror", None) or str(error)
        raise UsageError(f"--port {text}: cannot read {path}: {why}") from error
    except Exception as error:  # the parsers of cantools have errors of several kinds
        raise UsageError(f"--port {text}: {path} is no database of CAN messages: {error}") from error
    if not hasattr(database, "messages"):
        raise UsageError(f"--port {text}: {path} describes no CAN messages")
    return database


def _signal_named(text: str, database: Any, option: str, name: str) -> tuple[Any, Any]:
    """Message and signal of a name `SIGNAL` or `MESSAGE.SIGNAL`."""
    message_name, _, signal_name = name.rpartition(".")
    pairs = [
        (message, signal)
        for message in database.messages
        for signal in message.signals
        if signal.name == signal_name and message_name in ("", message.name)
    ]
    if len(pairs) > 1:
        places = ", ".join(f"{message.name}.{signal.name}" for message, signal in pairs)
        raise UsageError(f"--port {text}: {option}={name} is ambiguous; write one of {places}")
    if not pairs:
        names = [signal.name for message in database.messages for signal in message.signals]
        likely = [entry for entry in names if any(word in entry.lower() for word in ("yaw", "gier", "gyr", "rate"))]
        shown = ", ".join((likely or names)[:12])
        raise UsageError(f"--port {text}: the DBC file has no signal {name}; some of its signals: {shown}")
    return pairs[0]


def _scale(text: str, field: str, signal: Any, options: Mapping[str, str]) -> float:
    """Factor to the unit of a field."""
    unit = (signal.unit or "").strip().lower()
    if field in RATES:
        return RATE_DPS[_unit(text, "unit", RATE_UNITS.get(unit), RATE_DPS, signal, options)]
    if field in FORCES:
        name = _unit(text, "accel_unit", FORCE_UNITS.get(unit), ACCELERATION_MPS2, signal, options)
        return ACCELERATION_MPS2[name]
    return 1.0


def _unit(
    text: str, option: str, stated: str | None, units: Mapping[str, float], signal: Any, options: Mapping[str, str]
) -> str:
    """Unit of the option, else of the file."""
    name = options.get(option, stated)
    if name in units:
        return str(name)
    expected = " or ".join(f"{option}={unit}" for unit in units)
    problem = f"{option}={name} is unknown" if name else f"{signal.name} has the unit {signal.unit!r} in the DBC file"
    raise UsageError(f"--port {text}: {problem}; append {expected}")
