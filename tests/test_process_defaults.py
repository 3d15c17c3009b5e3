"""How the suite was started changes nothing for the processes of its tests."""

import json
import subprocess
import sys
from pathlib import Path

from process_defaults import DEFINED, ROOT

STARTED = """
import signal, subprocess, sys
from pathlib import Path
signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT, signal.SIGCHLD})
sys.path.insert(0, sys.argv[1])
from process_defaults import set_process_defaults
set_process_defaults(Path(sys.argv[2]))
subprocess.run([sys.executable, "-c", sys.argv[3]], check=True)
"""
"""Program of a test process; its child prints the state that it was given."""

CHILD = """
import json, os, signal
ignored = [number for number in signal.valid_signals() if signal.getsignal(number) is signal.SIG_IGN]
blocked = list(signal.pthread_sigmask(signal.SIG_BLOCK, ()))
print(json.dumps({
    "ignored": sorted(set(ignored) - {signal.SIGPIPE, signal.SIGXFSZ}),  # Python itself ignores these two
    "blocked": blocked, "umask": os.umask(0), "folder": os.getcwd(), "environment": dict(os.environ)}))
"""

AWKWARD = """
trap '' INT HUP QUIT TERM USR1 USR2
umask 077
cd /
export COLUMNS=20 LINES=3 NO_COLOR=1 FORCE_COLOR=1 TZ=Asia/Kathmandu LC_ALL=C PYTHONPATH=/nowhere NOTIFY_SOCKET=/nowhere
unset TERM HOME
exec "$@" <&-
"""


def test_a_child_gets_the_same_whatever_the_shell_had(tmp_path: Path) -> None:
    """Ignored signals, umask, folder, colours, widths, time zone, locale, no home, standard input closed."""
    words = [sys.executable, "-c", STARTED, str(ROOT / "tests"), str(tmp_path), CHILD]
    done = subprocess.run(["bash", "-c", AWKWARD, "bash", *words], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    given = json.loads(done.stdout)
    environment = given.pop("environment")
    assert given == {"ignored": [], "blocked": [], "umask": 0o022, "folder": str(ROOT)}
    assert environment.items() >= (DEFINED | {"HOME": str(tmp_path)}).items()
    assert not environment.keys() & {"COLUMNS", "LINES", "NO_COLOR", "FORCE_COLOR", "NOTIFY_SOCKET"}
