"""Faults of session files: writing, reading, repair, CSV, and files of others."""

from mutate.fault import Fault

MCAP, TESTS = "gyrodrift/session/mcap", "tests/session/mcap"
FOREIGN = "tests/session/foreign"

FAULTS = (
    Fault(
        "session/data-crc-not-added",
        f"{MCAP}/write.py",
        "        self.crc = zlib.crc32(content, self.crc)\n",
        "        self.crc = zlib.crc32(content)\n",
        "The CRC of a recording is that of its last piece.",
        (f"{TESTS}/test_mcap_session.py",),
    ),
    Fault(
        "session/summary-start",
        f"{MCAP}/write.py",
        "        start = self.size + len(data_end)\n",
        "        start = self.size\n",
        "The footer points at the end of the data instead of the summary.",
        (f"{TESTS}/test_mcap_session.py",),
    ),
    Fault(
        "session/first-time-kept",
        f"{MCAP}/write.py",
        "self.first_ns, self.last_ns = min(self.first_ns, first_ns), max(self.last_ns, last_ns)",
        "self.first_ns, self.last_ns = first_ns, last_ns",
        "The statistics tell the time of the last message as that of the first.",
        (f"{TESTS}/test_mcap_session.py",),
    ),
    Fault(
        "session/counter-as-number",
        f"{MCAP}/write.py",
        "                number & 0xFFFFFFFF,\n",
        "                seq & 0xFFFFFFFF,\n",
        "A sample has the counter of the device in place of its number in the file.",
        (f"{TESTS}/test_damage.py",),
    ),
    Fault(
        "session/flush-keeps-rows",
        f"{MCAP}/write.py",
        "        self._rows.clear()\n",
        "",
        "Each flush writes all samples once more.",
        (f"{TESTS}/test_mcap_session.py",),
    ),
    Fault(
        "session/still-repeated",
        f"{MCAP}/write.py",
        "        self._still = still\n        text =",
        "        text =",
        "What is said of rest is written with each sample.",
        (f"{TESTS}/test_mcap_session.py",),
    ),
    Fault(
        "session/repair-not-truncated",
        f"{MCAP}/repair.py",
        "    file.truncate(end)\n",
        "",
        "Torn bytes may stay behind the end of a repaired file.",
        (f"{TESTS}/test_repair.py",),
    ),
    Fault(
        "session/repair-without-lock",
        f"{MCAP}/repair.py",
        "            lock(path, file)\n",
        "",
        "A recording is repaired while it is being written.",
        (f"{TESTS}/test_repair.py",),
    ),
    Fault(
        "session/torn-zeros-whole",
        f"{MCAP}/walk.py",
        "        return end <= self.stretch.stop and not is_torn\n",
        "        return end <= self.stretch.stop\n",
        "A read whose end is the zeros of a power cut is taken for whole.",
        (f"{TESTS}/test_repair.py",),
    ),
    Fault(
        "session/wrong-checksums-read",
        f"{MCAP}/proofs.py",
        '_runs(rows[rows["salt"] == salt])',
        "_runs(rows)",
        "Samples of a damaged file are read though their checksums are wrong.",
        (f"{TESTS}/test_damage.py",),
    ),
    Fault(
        "session/lost-seal-not-told",
        f"{MCAP}/proofs.py",
        "        if number > expected:\n",
        "        if False:\n",
        "A loss of link events or raw bytes is not told.",
        (f"{TESTS}/test_damage.py",),
    ),
    Fault(
        "session/tail-written-over",
        f"{MCAP}/tail.py",
        "    while os.path.lexists(free):\n",
        "    while False:\n",
        "A second repair has no name for the tail that it keeps.",
        (f"{TESTS}/test_repair.py",),
    ),
    Fault(
        "session/csv-counter-wraps",
        "gyrodrift/session/csv.py",
        "np.where(np.abs(column) < WHOLE, column, -1)",
        "np.where(np.abs(column) < np.inf, column, -1)",
        "A counter beyond all that is counted becomes some other number.",
        ("tests/session/test_csv_session.py::test_a_counter_beyond_all_that_is_counted_is_none",),
    ),
)
