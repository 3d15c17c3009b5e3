"""A text at a port and in a file: one judge and one verdict."""

import json
import re
from pathlib import Path
from random import Random

import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st
from sources_support import Host
from support import speaking_on

from gyrodrift.session.files import load_session
from gyrodrift.values.errors import DataError, GyrodriftError, LinkError

ROWS, STEP_S = 60, 0.02
CLOCKS = {"t_ms": 1e3, "micros": 1e6, "time_s": 1.0, "": 0.0}
"""Labels of a clock with its ticks in a second; empty for a text without one."""

QUANTITIES = (
    *("gz", "gz_dps", "wz_rad_s", "yaw rate (deg/s)", "gyro_z", "gx_dps", "gy_dps", "delta_yaw (deg)", "yaw (deg)"),
    *("heading", "az", "temp", "node", "gz_bias (dps)", "motor", "gyro_z (0.1 deg/s)", "q0", "speed (rps)"),
)
READ = "read without a question"
SPEC = re.compile(r"--columns '([^']*)'")
PLACEHOLDER = re.compile(r"\bt_UNIT\b|\bt_(?:s|ms|us|ns)\b")
"""A clock, whose unit a port hears from its pace, and a file may have to ask for."""


def text_of(form: str, clock: str, names: list[str], seed: int) -> list[str]:
    """Lines of a board that prints these quantities."""
    dice = Random(seed)
    rows: list[dict[str, str]] = []
    for number in range(ROWS):
        row = {clock: f"{1000 + number * STEP_S * CLOCKS[clock]:.{3 if CLOCKS[clock] == 1.0 else 0}f}"} if clock else {}
        for name in names:
            value = (
                "AB"[number % 2] if name == "node" else f"{dice.gauss(100.0 if name == 'heading' else 0.4, 0.1):.3f}"
            )
            row[name] = value
        rows.append(row)
    match form:
        case "JSON":
            return [json.dumps({k: v if k == "node" else float(v) for k, v in row.items()}) for row in rows]
        case "labels":
            return [" ".join(f"{name}: {value}" for name, value in row.items()) for row in rows]
        case _:
            mark = {"commas": ",", "tabs": "\t", "semicolons": ";"}[form]
            return ["ready", mark.join(rows[0]), *(mark.join(row.values()) for row in rows)]


def proposed(message: str) -> str:
    """SPEC that a message proposes, with any unit of the clock, and labels in place of positions."""
    found = SPEC.search(message)
    return PLACEHOLDER.sub("t_UNIT", found[1]) if found else ""


def at_a_port(port: Path, lines: list[str]) -> str:
    with speaking_on(port) as device, Host(port, baud=115200, timeout_s=ROWS * STEP_S) as host:
        try:
            host.hear(device, [f"{line}\n".encode() for line in [*lines, *lines[-2:]]], STEP_S)
        except LinkError as error:
            return proposed(str(error))
    return READ


def in_a_file(path: Path, lines: list[str]) -> str:
    """Proposed SPEC, or READ."""
    path.write_text("\n".join(lines) + "\n")
    try:
        load_session(path)
    except DataError as error:
        return proposed(str(error))
    except GyrodriftError as error:
        raise AssertionError(f"{error}: {lines[:2]}") from error
    return READ


def entries(spec: str) -> set[str]:
    """Entries besides that of the clock, without labels, since a port may name columns by their position."""
    return {entry.rpartition("=")[2].strip() for entry in spec.split(",")} - {"t_UNIT", "_", "seq", ""}


@pytest.mark.promise("Text and units")
@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.sampled_from(["JSON", "labels", "commas", "tabs", "semicolons"]),
    st.sampled_from(sorted(CLOCKS)),
    st.lists(st.sampled_from(QUANTITIES), min_size=1, max_size=4, unique=True),
    st.integers(0, 99),
)
def test_a_port_proposes_what_a_file_proposes_or_reads(
    tmp_path: Path, port: Path, form: str, clock: str, names: list[str], seed: int
) -> None:
    """A text has the same verdict at a port and in a file: what a file reads by itself, a port proposes."""
    if form == "labels":
        names = [name for name in names if name != "node"]  # a word after a label is a part of the next label
    assume(len(names) + bool(clock) > 1)  # a single number per line makes no table
    lines = text_of(form, clock, names, seed)
    heard, read = at_a_port(port, lines), in_a_file(tmp_path / ("s.jsonl" if form == "JSON" else "s.txt"), lines)
    if read == READ:
        assert heard
        assert "UNIT" not in heard.replace("t_UNIT", "")
    else:
        assert entries(heard) == entries(read)
