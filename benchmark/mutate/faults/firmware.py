"""Faults of the libraries for microcontrollers: files of users, values of a gyro, and the filter for MicroPython."""

from mutate.fault import Fault

FOLDER = "gyrodrift/firmware/library_folder.py"
GYRO = "gyrodrift/firmware/my_gyro.py"
MICROPYTHON = "gyrodrift/firmware/files/micropython"
LIBRARY_TESTS = ("tests/firmware/test_library.py",)
GYRO_TESTS = ("tests/firmware/test_my_gyro.py",)
BOARD_TESTS = ("tests/firmware/test_micropython_filters.py",)

FAULTS = (
    Fault(
        "firmware/changed-file-lost",
        FOLDER,
        "return content == text.encode() or _hash(content) == recorded",
        "return True",
        "A file that a user has changed is overwritten.",
        LIBRARY_TESTS,
    ),
    Fault(
        "firmware/other-origin",
        FOLDER,
        "_hash(content) == recorded",
        "not recorded",
        "A file of another origin is overwritten.",
        LIBRARY_TESTS,
    ),
    Fault(
        "firmware/directions-swapped",
        GYRO,
        "*(float(c.sign), c.scale_ccw, c.scale_cw,",
        "*(float(c.sign), c.scale_cw, c.scale_ccw,",
        "Each direction gets the scale of the other one.",
        GYRO_TESTS,
    ),
    Fault(
        "firmware/mount-lost",
        GYRO,
        "        gyro.mount.axes,\n",
        "        IDENTITY,\n",
        "Three axes stay in the frame of the sensor.",
        GYRO_TESTS,
    ),
    Fault(
        "firmware/scale-of-three-axes",
        GYRO,
        "RESTLEVEL.scaled(restlevel, calibration.axes_scale_sigma),",
        "RESTLEVEL.scaled(restlevel, calibration.scale_sigma),",
        "The sigma of three axes is that of one calibrated axis.",
        GYRO_TESTS,
    ),
    Fault(
        "firmware/comment-ends",
        GYRO,
        '.replace("*/", "* /")',
        "",
        "The id of a device ends the comment of a header.",
        GYRO_TESTS,
    ),
    Fault(
        "firmware/hdr-run-never-ends",
        f"{MICROPYTHON}/gyrodrift_hdr.py",
        "self.samples >= 2 and sign == self._sign_before",
        "self.samples >= 2",
        "HDR in MicroPython learns ever more slowly.",
        BOARD_TESTS,
    ),
    Fault(
        "firmware/hdr-plain-sum",
        f"{MICROPYTHON}/gyrodrift_hdr.py",
        "        self._lost_deg = (yaw_deg - self.yaw_deg) - angle_deg\n",
        "        self._lost_deg = angle_deg\n",
        "The lost part of the sum is another number.",
        BOARD_TESTS,
    ),
)
