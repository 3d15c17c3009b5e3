"""Examples of docs/firmware/README.md: a record for another sensor, and the header in other firmware."""

import json
import re
import shutil
from pathlib import Path
from typing import Any

import pytest
from firmware_support import HEADERS, HERE, MICROPYTHON, ROOT, SKETCH, STRICT, run, same_sensor
from golden_frames import AXES_HELLO, AXES_SAMPLES

README = ROOT / "docs" / "firmware" / "README.md"
HELLO_BYTES, SAMPLE_BYTES = len(AXES_HELLO), len(next(iter(AXES_SAMPLES.values())))


def blocks(language: str) -> list[str]:
    """Code of the page."""
    return re.findall(rf"^```{language}\n(.*?)^```$", README.read_text(), re.MULTILINE | re.DOTALL)


@pytest.fixture
def cc() -> str:
    result = shutil.which("cc")
    if result is None:
        pytest.skip("there is no C compiler: apt-get install gcc")
    return result


def test_the_record_of_another_sensor_fits(cc: str, tmp_path: Path) -> None:
    in_c, in_python = blocks("c")[0], blocks("python")[0]
    header = (SKETCH / "gyro_sensors.h").read_text()
    last = '    {"ICM-20948'
    assert last in header
    (tmp_path / "gyro_sensors.h").write_text(header.replace(last, in_c + last))
    run(cc, *STRICT, f"-I{tmp_path}", HERE / "sensor_records.c", "-o", tmp_path / "records")
    (line,) = [line for line in run(tmp_path / "records").splitlines() if "MPU-6500" in line]
    names: dict[str, Any] = {}
    exec((MICROPYTHON / "gyro_sensors.py").read_text() + f"\nADDED = {in_python}", names)
    assert same_sensor(json.loads(line), names["ADDED"])


def test_the_header_is_used_as_shown(cc: str, tmp_path: Path) -> None:
    include, _, body = blocks("c")[1].partition("\n")
    body += blocks("c")[2] + blocks("c")[3]
    source = f"""{include}
void uart_write(const uint8_t *bytes, uint8_t count);
void send(uint16_t seq, uint32_t t_us, int16_t rate_raw, const int16_t *g, const int16_t *a, int16_t temp_centi_c,
          float yaw_deg, float yaw_sigma_deg, float bias_dps);
void send(uint16_t seq, uint32_t t_us, int16_t rate_raw, const int16_t *g, const int16_t *a, int16_t temp_centi_c,
          float yaw_deg, float yaw_sigma_deg, float bias_dps) {{
{body}}}
"""
    (tmp_path / "own.c").write_text(source)
    assert run(cc, "-std=c99", *STRICT, f"-I{HEADERS}", "-fsyntax-only", tmp_path / "own.c") == ""


def test_the_table_of_baud_rates_is_right() -> None:
    rows = re.findall(r"^\| (\d+) \| (\d+) \| (\d+) % \|$", README.read_text(), re.MULTILINE)
    assert len(rows) == 4
    for baud, most, share in ((int(a), int(b), int(c)) for a, b, c in rows):
        assert most == (baud // 10 - HELLO_BYTES) // SAMPLE_BYTES
        assert share == round((200 * SAMPLE_BYTES + HELLO_BYTES) * 10 / baud * 100)
