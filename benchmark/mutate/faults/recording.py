"""Faults of recording while it happens."""

from mutate.fault import Fault

RECORDING, TESTS = "gyrodrift/recording", "tests/recording"

FAULTS = (
    Fault(
        "recording/no-sync",
        f"{RECORDING}/disk.py",
        "            os.fsync(self._file.fileno())\n            self._synced_s,",
        "            self._synced_s,",
        "A power cut costs all that the system had not written by itself.",
        (f"{TESTS}/test_disk.py",),
    ),
    Fault(
        "recording/sync-never-due-again",
        f"{RECORDING}/disk.py",
        "            rest = rest[count:]\n        self._is_dirty = True\n",
        "            rest = rest[count:]\n        self._is_dirty = self._written <= len(content)\n",
        "Only the first bytes of a file are synced before its end.",
        (f"{TESTS}/test_disk.py",),
    ),
    Fault(
        "recording/short-write",
        f"{RECORDING}/disk.py",
        "        while rest:\n            count",
        "        if rest:\n            count",
        "What the system did not take at once is lost.",
        (f"{TESTS}/test_disk.py", f"{TESTS}/test_recorder.py"),
    ),
    Fault(
        "recording/no-lock",
        f"{RECORDING}/disk.py",
        "            lock_file(file, wait=True)  # a search for interrupted files holds the lock for a moment\n",
        "",
        "Another program takes a file that is being written for an interrupted one.",
        (f"{TESTS}/test_disk.py",),
    ),
    Fault(
        "recording/no-bound",
        f"{RECORDING}/disk.py",
        "        if self.waiting_bytes > MOST_WAITING_BYTES:",
        "        if self.waiting_bytes > MOST_WAITING_BYTES * 64:",
        "A disk that hangs fills the memory.",
        (f"{TESTS}/test_disk.py",),
    ),
    Fault(
        "recording/written-over",
        f"{RECORDING}/disk.py",
        'FileIO(self.path, "xb+", ',
        'FileIO(self.path, "wb+", ',
        "A file of that name is written over.",
        (f"{TESTS}/test_disk.py", f"{TESTS}/test_recorder.py"),
    ),
    Fault(
        "recording/tick-does-not-flush",
        f"{RECORDING}/recorder.py",
        "        self._writer.flush()\n        self.unflushed = 0\n",
        "        self.unflushed = 0\n",
        "Samples stay in memory until the file ends: a kill loses all of them.",
        (f"{TESTS}/test_killed.py", f"{TESTS}/test_recorder.py"),
    ),
    Fault(
        "recording/events-lost",
        f"{RECORDING}/recorder.py",
        "            self._writer.add_event(event, t_host_s, fields)\n        self._waiting.clear()\n",
        "            pass\n        self._waiting.clear()\n",
        "Events between two files are in neither of them.",
        (f"{TESTS}/test_recorder.py",),
    ),
    Fault(
        "recording/waiting-twice",
        f"{RECORDING}/recorder.py",
        "        self._waiting.clear()\n        self._events.clear()\n",
        "        self._events.clear()\n",
        "Raw bytes that waited for a file are in all files that follow.",
        (f"{TESTS}/test_recorder.py",),
    ),
    Fault(
        "recording/full-disk-not-counted",
        f"{RECORDING}/resilient.py",
        "        self.unrecorded += recorder.unflushed\n",
        "",
        "Samples that were in memory when a disk failed are counted as recorded.",
        (f"{TESTS}/test_resilient.py",),
    ),
    Fault(
        "recording/duration-inclusive",
        f"{RECORDING}/duration.py",
        "if sample.t_device_s < until_s]",
        "if sample.t_device_s <= until_s]",
        "A recording of a second has one sample too many.",
        (f"{TESTS}/test_duration.py",),
    ),
)
