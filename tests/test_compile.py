"""Compiled functions where nothing can be kept between runs."""

import subprocess
import sys

NOWHERE = """
import os
os.environ |= {"NUMBA_CACHE_LOCATOR_CLASSES": "UserProvidedCacheLocator", "NUMBA_CACHE_DIR": "/proc/nowhere"}
import numpy as np
import gyrodrift.diagnose.features.design_matrix, gyrodrift.diagnose.recording.kalman
import gyrodrift.diagnose.recording.motion
import gyrodrift.evaluation.kernels.hdr, gyrodrift.evaluation.kernels.restlevel
import gyrodrift.compare.methods.plain
from gyrodrift.compare.methods.plain import _by_sign
print(len(_by_sign(np.ones(3), 0.1, 1.0)))
"""


def test_without_a_home_and_in_a_package_that_is_read_only_everything_still_runs() -> None:
    done = subprocess.run([sys.executable, "-c", NOWHERE], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "3\n"
