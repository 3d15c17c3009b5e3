"""Changes within formats of text: JSON, displays as Python prints them, scalars of YAML, cells and words."""

import json
import struct
from random import Random
from typing import Any

WORDS = """
class WATCH rate_hz fields t_s yaw_deg op subscribe topic type /gyro id throttle_rate level call_service
service args advertise ?WATCH= ?POLL; ?DEVICES; enable json device filter hdr restlevel outputs name tcp udp
mqtt port host unix password sample_rate_hz provenance i_c_dps tau_s window_s segments kind rest ramp seconds
to_dps effects base about seed rate rate:rads:- rate:lsb/131 t_us t_ms t_s seq encoder temp still _ gyro.z
time gx
getParameters setParameters parameterNames subscriptions channelId
subscribeParameterUpdates method params subuid topics options prefix publish pubuid setproperties gyrodrift_memory
knowledge written_s calibration age_s first curve place count
t_device_s rate_dps t_host_s encoder_deg temp_c split session zero heading status reload stop #
$HEROT, *3A : = , ; | [ ] { } ( )
""".split()  # noqa: SIM905 - a list of a hundred words is no easier to read
"""What the parsers know."""

SCALARS = (
    "0", "-0", "-1", "1e999", "-1e999", "1e-320", "1e308", "nan", ".nan", "inf", "-.inf", "null", "~", "true", "on",
    "''", "0x1F", "0o17", "017", "0b1", "1_000", "1:30", "1:2:3", "1e", "1.", ".5", "+.5", "--1", "2026-01-01",
    "2026-99-99", "²", "١٢", "1\u00a0000", "!!python/object:os.system x", "!!binary x", "!!set {a, b}", "!!float x",
    "!!int x", "&a [*a]", "*a", "<<: *a", "{[]: 1}", "{{}: 1}", "[[[]]]", "? a", "|", ">", "%TAG", "---", "...",
    '"\\u0000"', '"\\ud800"', "\x1b[2J", "\u202e", "%s", "%n", "%ff", "{0}", "${HOME}", "../../x", "/dev/zero",
    "a" * 300, "9" * 400, "9" * 5000, "1" * 300 + "a", "0." + "0" * 400 + "1", "1" + "_" * 300 + "1", "[" * 100,
    "(" * 200, "-" * 300, "." * 300,
)  # fmt: skip
"""Values at the edge of what a format allows, and beyond."""

DEEPEST = 4


def changed_word(content: bytes, random: Random) -> bytes:
    """A word or a scalar put somewhere."""
    at = random.randint(0, len(content))
    word = random.choice(random.choice((WORDS, SCALARS))).encode(errors="surrogatepass")
    return content[:at] + word + content[at + random.choice((0, 0, len(word))) :]


def changed_cell(content: bytes, random: Random) -> bytes:
    """One of the cells of one of the lines is another value, is missing, or there twice; or the line is."""
    lines = content.split(b"\n")
    row = random.randrange(len(lines))
    mark = random.choice([each for each in (b",", b";", b"\t", b"|", b":", b" ") if each in lines[row]] or [b","])
    cells = lines[row].split(mark)
    place = random.randrange(len(cells))
    match random.randrange(6):
        case 0:
            del cells[place]
        case 1:
            cells.insert(place, random.choice(cells))
        case 2:
            lines.insert(row, lines[random.randrange(len(lines))])
        case _:
            cells[place] = random.choice(SCALARS).encode(errors="surrogatepass")
    lines[row] = mark.join(cells)
    return b"\n".join(lines)


def changed_scalar(content: bytes, random: Random) -> bytes:
    """What stands behind a colon in one of the lines is another value; or a line of a known word is put in."""
    lines = content.split(b"\n")
    row = random.randrange(len(lines))
    key, colon, _ = lines[row].rpartition(b":")
    value = random.choice(SCALARS).encode(errors="surrogatepass")
    if colon and random.randrange(4):
        lines[row] = key + b": " + value
    else:
        indent = b" " * random.choice((0, 0, 2, 4))
        lines.insert(row, indent + random.choice((b"", b"- ")) + random.choice(WORDS).encode() + b": " + value)
    return b"\n".join(lines)


def nested(content: bytes, random: Random) -> bytes:
    """Brackets within brackets, deeper than a parser goes."""
    opening, closing = random.choice((("[", "]"), ("{", "}"), ("(", ")"), ('{"a":', "}"), ("{a: ", "}"), ("- ", "")))
    depth = 12_000 if not random.randrange(30) else random.choice((2, 5, 5, 60, 200, 1_500))
    at = random.randint(0, len(content))
    made = (opening * depth + random.choice(SCALARS) + closing * random.choice((0, depth))).encode(
        errors="surrogatepass"
    )
    return content[:at] + made + content[at:]


def changed_json(content: bytes, random: Random) -> bytes:
    """One value of one of the lines that are JSON is another one; a new line where that is none."""
    lines = content.split(b"\n")
    row = random.randrange(len(lines))
    try:
        value = json.loads(lines[row])
    except (ValueError, RecursionError):
        lines.insert(row, _encoded(_any_value(random, 0)))
    else:
        lines[row] = _encoded(_with_change(value, random, 0))
    return b"\n".join(lines)


def _with_change(value: Any, random: Random, depth: int) -> Any:
    if isinstance(value, dict) and value and random.randrange(4) and depth < 20:
        key = random.choice(list(value))
        changed = {**value, key: _with_change(value[key], random, depth + 1)}
        match random.randrange(6):
            case 0:
                del changed[key]
            case 1:
                changed[random.choice(WORDS)] = _any_value(random, depth)
        return changed
    if isinstance(value, list) and value and random.randrange(4) and depth < 20:
        place = random.randrange(len(value))
        return [*value[:place], _with_change(value[place], random, depth + 1), *value[place + random.randrange(2) :]]
    return _any_value(random, depth)


NUMBERS = (0, -1, 10, 1 << 31, 1 << 63, 1 << 64, 10**400, 0.5, 1e308, -1e-320, float("nan"), float("inf"))


def _any_value(random: Random, depth: int) -> Any:
    match random.randrange(8):
        case 0 if depth < DEEPEST:
            return [_any_value(random, depth + 1) for _ in range(random.choice((0, 1, 2, 30)))]
        case 1 if depth < DEEPEST:
            return {random.choice(WORDS): _any_value(random, depth + 1) for _ in range(random.choice((0, 1, 3)))}
        case kind:
            return random.choice((WORDS, WORDS, SCALARS, NUMBERS, (None, True, False))[kind % 5])


def _encoded(value: Any) -> bytes:
    try:
        return json.dumps(value).encode(errors="surrogatepass")
    except (ValueError, RecursionError):
        return b"null"


def changed_packed(content: bytes, random: Random) -> bytes:
    """A message of MessagePack: an array of four, of which some are odd; lengths may lie."""
    number = struct.pack(">Bd", 0xCB, random.choice((0.0, -1.0, 1e308, float("nan"), float("inf"))))
    odd = (
        b"\xff",
        b"\x00",
        number,
        b"\xc0",
        b"\x80",
        b"\x90",
        b"\xdd\xff\xff\xff\xff",
        b"\xc6\x7f\xff\xff\xff",
        b"\xa1\xff",
    )
    parts = (
        random.choice(odd),
        random.choice(odd),
        b"\x02",
        random.choice((number, b"\xd3" + random.randbytes(8), *odd)),
    )
    made = b"\x94" + b"".join((b"\xff", *parts[1:]) if random.randrange(2) else parts)
    return made if random.randrange(2) else content + made


def with_display(content: bytes, random: Random) -> bytes:
    """A line more, as a program prints its own values: dictionaries, sets, tuples, with and without sense."""
    lines = content.split(b"\n")
    lines.insert(random.randint(0, len(lines)), _display(random, 0).encode(errors="surrogatepass"))
    return b"\n".join(lines)


VALUES = ("1", "-1", "1.5", "1e999", "1j", "'gz'", "'t'", "True", "None", "nan", "b'x'", "()", "[]", "{}", "...")
"""What stands in displays that a program prints, and what Python knows beside."""


def _display(random: Random, depth: int) -> str:
    """One value, or brackets with more of them in it; the first is always in brackets."""
    if depth and (depth > DEEPEST or random.randrange(3)):
        return random.choice(random.choice((VALUES, VALUES, VALUES, VALUES, SCALARS)))
    opening, closing = random.choice(("{}", "{}", "[]", "()"))
    is_pair = opening == "{" and bool(random.randrange(4))
    items = [_item(random, depth, is_pair=is_pair) for _ in range(random.choice((0, 1, 2, 5)))]
    prefix = random.choice(("", "", "", "", "-", "+", "1-", "set", "dict"))
    return f"{prefix if depth else ''}{opening}{', '.join(items)}{closing}"


def _item(random: Random, depth: int, *, is_pair: bool) -> str:
    value = _display(random, depth + 1)
    return f"{_display(random, depth + 1)}: {value}" if is_pair else value
