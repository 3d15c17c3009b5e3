"""Faults of the simulated device."""

from mutate.fault import Fault

FAULTS = (
    Fault(
        "firmware_sim/crc-init",
        "firmware_sim/wire/native.py",
        "    crc = 0xFFFF\n",
        "    crc = 0\n",
        "The CRC begins with 0, as that of another protocol does.",
        ("tests/firmware_sim/test_wire.py",),
    ),
    Fault(
        "firmware_sim/clip-wraps",
        "firmware_sim/block.py",
        "return np.clip(counts, -COUNTS_MAX, COUNTS_MAX).astype(np.int16)",
        "return counts.astype(np.int64).astype(np.int16)",
        "A rate beyond the range wraps around to the other sign.",
        ("tests/firmware_sim/test_measure.py",),
    ),
    Fault(
        "firmware_sim/stuck-forgets",
        "firmware_sim/faults/measurements.py",
        "if len(before) or last is None:",
        "if len(before) or True:",
        "A stuck rate changes with each block.",
        ("tests/firmware_sim/test_faults.py",),
    ),
    Fault(
        "firmware_sim/hello-once",
        "firmware_sim/wire/native.py",
        "if t_us / 1e6 >= next_hello_s or t_us < last_us:",
        "if t_us / 1e6 >= next_hello_s:",
        "A device whose clock began anew says nothing of its scale until the old time is reached.",
        ("tests/firmware_sim/test_faults.py", "tests/firmware_sim/test_wire.py"),
    ),
    Fault(
        "firmware_sim/pty-not-closed",
        "firmware_sim/pty.py",
        "        os.close(self.fd)\n        self.fd = -1",
        "        self.fd = -1",
        "The descriptor of a pty stays open when the device is unplugged.",
        ("tests/firmware_sim/test_pty.py",),
    ),
    Fault(
        "firmware_sim/host-order",
        "firmware_sim/measure.py",
        "        self._last_arrival_s = float(ordered_s[-1])\n",
        "",
        "A sample may overtake the last one of the block before.",
        ("tests/firmware_sim/test_measure.py",),
    ),
)
