"""Faults of three axes: on the wire, in files, and in the checks of accelerations."""

from mutate.fault import Fault

PROTOCOLS, MCAP = "gyrodrift/link/protocols", "gyrodrift/session/mcap"
CHECKS = "gyrodrift/session/checks"
WIRE_TESTS = ("tests/link/protocols/test_three_axes.py", "tests/link/protocols/test_native.py")
FILE_TESTS = ("tests/session/mcap/test_three_axes.py",)
TABLE_TESTS = ("tests/session/tables/test_three_axes.py",)
CHECK_TESTS = ("tests/session/test_acceleration_checks.py", *TABLE_TESTS)

FAULTS = (
    Fault(
        "axes/clipped-acceleration-used",
        f"{PROTOCOLS}/native.py",
        "flags & (ACCEL_VALID | ACCEL_CLIPPED) == ACCEL_VALID",
        "flags & ACCEL_VALID == ACCEL_VALID",
        "An acceleration that is cut off points in a wrong direction.",
        WIRE_TESTS,
    ),
    Fault(
        "axes/rest-by-flag-of-acceleration",
        f"{PROTOCOLS}/native.py",
        "self._inertial(flags, raw), AXES_STILL",
        "self._inertial(flags, raw), STILL",
        "A device with a valid acceleration always stands still.",
        WIRE_TESTS,
    ),
    Fault(
        "axes/acceleration-used-twice",
        f"{PROTOCOLS}/witmotion.py",
        "            self._forces_mps2 = NO_FORCES\n",
        "",
        "Rates without an acceleration get the one before.",
        WIRE_TESTS,
    ),
    Fault(
        "axes/vectornav-z-down",
        f"{PROTOCOLS}/vectornav.py",
        "return None if inertial is None else upside_down(inertial)",
        "return inertial",
        "The rates about y and z have the wrong sign.",
        WIRE_TESTS,
    ),
    Fault(
        "axes/xsens-order",
        f"{PROTOCOLS}/xsens.py",
        "tuple(map(degrees, _vector(items, RATES)))",
        "tuple(map(degrees, (*_vector(items, RATES)[1::-1], _vector(items, RATES)[2])))",
        "The rates about x and y are exchanged.",
        WIRE_TESTS,
    ),
    Fault(
        "axes/csv-without-gravity",
        "gyrodrift/columns/shape.py",
        "_follows_rate(readings) and _feels_gravity(readings)",
        "_follows_rate(readings)",
        "Any seven numbers are rates and accelerations.",
        WIRE_TESTS,
    ),
    Fault(
        "axes/rows-of-one-size",
        f"{MCAP}/proofs.py",
        "    for layout in CHECKED_ROWS:\n",
        "    for layout in CHECKED_ROWS[:1]:\n",
        "Samples with three axes are not found in a damaged file.",
        FILE_TESTS,
    ),
    Fault(
        "axes/repair-forgets-axes",
        f"{MCAP}/read.py",
        "has_axes, has_device_yaw = session.gyro_dps is not None,",
        "has_axes, has_device_yaw = False,",
        "A repaired file has lost its samples or their axes.",
        FILE_TESTS,
    ),
    Fault(
        "axes/old-rows-unmarked",
        f"{MCAP}/layout.py",
        '"dddddd" * has_axes',
        '"ddddd" * has_axes',
        "The acceleration along z is not written.",
        FILE_TESTS,
    ),
    Fault(
        "axes/zeros-are-axes",
        "gyrodrift/session/session.py",
        "        if gyro_dps is None or (accel_mps2 is None and not gyro_dps[:, :2].any()):\n",
        "        if gyro_dps is None:\n",
        "A single-axis gyro in an Imu message has three axes.",
        FILE_TESTS,
    ),
    Fault(
        "axes/autopilot-z-down",
        "gyrodrift/session/logs/autopilot.py",
        "-degrees(1.0), -degrees(1.0), 1.0, -1.0, -1.0]",
        "-degrees(1.0), -degrees(1.0), 1.0, 1.0, 1.0]",
        "Logs of autopilots have z up for the rates and z down for the accelerations.",
        ("tests/session/logs/test_autopilot.py",),
    ),
    Fault(
        "axes/acceleration-of-table-in-counts",
        "gyrodrift/session/tables/plan.py",
        "**dict.fromkeys(FORCE_TARGETS, force_scale)",
        "**dict.fromkeys(FORCE_TARGETS, 1.0)",
        "Accelerations of a blackbox stay in counts.",
        TABLE_TESTS,
    ),
    Fault(
        "axes/flip-keeps-acceleration",
        "gyrodrift/session/session.py",
        "None if array is None else array * UPSIDE_DOWN for array in (self.gyro_dps, self.accel_mps2)",
        "array for array in (self.gyro_dps, self.accel_mps2)",
        "--flip inverts the yaw rate alone.",
        TABLE_TESTS,
    ),
    Fault(
        "axes/gravity-in-any-unit",
        "gyrodrift/columns/sizes.py",
        "    return abs(length - gravity) <= error * gravity\n",
        "    return length <= 2.0 * gravity\n",
        "Accelerations in g count as m/s².",
        CHECK_TESTS,
    ),
    Fault(
        "axes/swapped-axes-agree",
        f"{CHECKS}/examine.py",
        "axes.residual > AGREES >= axes.best_residual",
        "axes.residual > 10.0 >= axes.best_residual",
        "Swapped axes of an accelerometer pass.",
        CHECK_TESTS,
    ),
    Fault(
        "axes/encoder-against-z",
        "gyrodrift/facts/reference.py",
        "(session.gyro_dps * means).sum(axis=1)",
        "(session.gyro_dps * means)[:, 2]",
        "A tilted gyro seems to have a wrong unit.",
        CHECK_TESTS,
    ),
)
