"""Libraries that `gyrodrift firmware` writes in a test."""

import os
import shutil
from pathlib import Path
from typing import Any

import pytest
import yaml
from firmware_support import run

from gyrodrift.cli import main

CALIBRATED: dict[str, Any] = {
    "filter": "restlevel",
    "mount": {"up": "+y", "forward": "-x"},
    "sample_rate_hz": 100,
    "hdr": {"i_c_dps": 0.001},
    "restlevel": {"window_s": 0.4},
    "calibration": {
        "date": "2026-05-01T12:00:00+00:00",
        "device_id": 'of "mine" */ \\',
        "sign": -1,
        "scale_ccw": 1.012,
        "scale_ccw_se": 0.001,
        "scale_cw": 0.99,
        "scale_cw_se": 0.002,
        "bias_dps": 0.3,
        "temp_c": 25.0,
        "bias_dps_per_c": 0.01,
        "temp_low_c": 10.0,
        "temp_high_c": 45.0,
        "gyro_bias_xy_dps": [0.1, -0.2],
        "gyro_matrix": [[1.01, 0.002, -0.003], [0.001, 0.99, 0.004], [-0.005, 0.006, 1.02]],
        "accel_offset_mps2": [0.1, 0.2, -0.3],
        "accel_scale": [1.01, 0.98, 1.005],
    },
}
"""A config with a value for everything that a header takes; the id of its device tries to end comments."""


def library(folder: Path, target: str, *further: str | Path) -> Path:
    """Library of a target, written into a new folder."""
    out = folder / f"gyrodrift_{target}"
    assert main(["firmware", "--out", str(out), "--target", target, "--quiet", *map(str, further)]) == 0
    return out


def calibrated_config(folder: Path, filter_name: str = "restlevel", **calibration: object) -> Path:
    """File with CALIBRATED, for a filter and with further values of the calibration."""
    path = folder / "my.yaml"
    content = {**CALIBRATED, "filter": filter_name, "calibration": CALIBRATED["calibration"] | calibration}
    path.write_text(yaml.safe_dump(content))
    return path


def need(program: str, package: str) -> None:
    """Skip the test without a program of a Debian package."""
    if shutil.which(program) is None:
        pytest.skip(f"there is no {program}: apt-get install {package}")


def cmake_built(source: Path, into: Path) -> None:
    """Configure and build a folder with CMake; a warning of the compiler is an error."""
    need("cmake", "cmake")
    need("cc", "gcc")
    os.environ.setdefault("CMAKE_BUILD_PARALLEL_LEVEL", "1")
    run("cmake", "-S", source, "-B", into, "-DCMAKE_C_FLAGS=-Wall -Wextra -Werror -pedantic -ffp-contract=off")
    run("cmake", "--build", into)
