"""Faults of the config."""

from mutate.fault import Fault

FAULTS = (
    Fault(
        "config/same-second-missed",
        "gyrodrift/config/watch.py",
        "    return status.st_mtime_ns, status.st_ino, status.st_size\n",
        "    return status.st_mtime_ns, 0, status.st_size\n",
        "A file of the same size that is renamed over the config with the old time is not seen.",
        ("tests/config/test_watch.py",),
    ),
    Fault(
        "config/mistake-told-over-and-over",
        "gyrodrift/config/watch.py",
        "            self._version = version\n            self._begin_reading()\n",
        "            self._begin_reading()\n",
        "A file that was changed is read at every tick.",
        ("tests/config/test_watch.py",),
    ),
    Fault(
        "config/reading-is-waited-for",
        "gyrodrift/config/reading.py",
        "        os.set_blocking(self._stream.fileno(), False)\n",
        "        os.set_blocking(self._stream.fileno(), True)\n",
        "The service waits for the process that reads its config.",
        ("tests/config/test_reading.py",),
    ),
    Fault(
        "config/gone-at-once",
        "gyrodrift/config/watch.py",
        "        return self._in_vain >= GONE_LOOKS\n",
        "        return self._in_vain > 0\n",
        "An editor that renames makes the config gone for a moment.",
        ("tests/config/test_watch.py",),
    ),
    Fault(
        "config/first-mistake-only",
        "gyrodrift/config/model.py",
        "is_told = number < MOST_PROBLEMS",
        "is_told = number < 1",
        "Of many mistakes only the first is explained.",
        ("tests/config/test_model.py",),
    ),
    Fault(
        "config/change-not-told",
        "gyrodrift/config/model.py",
        "        return [*changed, *gone, *new]\n",
        "        return [*changed, *new]\n",
        "An output that a new config closes is not told.",
        ("tests/config/test_model.py", "tests/config/test_outputs.py"),
    ),
    Fault(
        "config/block-defaults",
        "gyrodrift/config/model.py",
        "        return default if params is None else params\n",
        "        return default if params is not None else default\n",
        "Parameters of the config are ignored.",
        ("tests/config/test_model.py",),
    ),
)
