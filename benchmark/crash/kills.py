"""Writers of ours, killed at a moment; each function gives what was found, or fails."""

import shutil
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

from support import PATIENCE_S, Command, ours

from firmware_sim.pty import LinkInUseError, PtyDevice
from firmware_sim.wire.csv import csv_line
from gyrodrift.config.model import load_config
from gyrodrift.filters.hdr import HdrParams
from gyrodrift.session.files import load_session, session_paths
from gyrodrift.session.mcap.ending import interrupted
from gyrodrift.session.mcap.repair import repair

WRITER = """
import sys, itertools
from pathlib import Path
from gyrodrift.io.files import write_whole
path = Path(sys.argv[1])
for number in itertools.count():
    write_whole(path, (f"hdr: {{tau_s: {number % 2}.25}}\\n" + "# padding\\n" * 20 for _ in range(1)))
    print(number, flush=True)
"""


def killed_writer(folder: Path, moment_s: float) -> float:
    """`tau_s` of a config that is written again and again: whole after a kill, whichever it is, and readable."""
    path = folder / "c.yaml"
    path.write_text("hdr: {tau_s: 0.25}\n")
    writer = subprocess.Popen([sys.executable, "-c", WRITER, path], stdout=subprocess.PIPE)
    assert writer.stdout is not None
    writer.stdout.readline()
    time.sleep(moment_s)
    writer.kill()
    writer.wait()
    writer.stdout.close()
    assert path.read_text().count("# padding\n") == 20
    hdr = load_config(path).params
    assert isinstance(hdr, HdrParams)
    return hdr.tau_s


def killed_tune(sessions: Path, folder: Path, moment_s: float, iterations: int = 4000) -> None:
    """Killed, then taken up: the bytes of a run that was left alone, and no half config at any time."""
    words = ["tune", str(sessions), "--iterations", str(iterations), "--jobs", "1", "--method", "carla", "--quiet"]
    alone, out = folder / "a" / "c.yaml", folder / "b" / "c.yaml"
    for path in (alone, out):
        path.parent.mkdir(exist_ok=True)
    if not alone.exists():
        subprocess.run(ours(*words, "--out", "c.yaml"), cwd=alone.parent, check=True, capture_output=True)
    out.unlink(missing_ok=True)
    _killed([*words, "--out", "c.yaml"], out.parent, moment_s)
    if out.exists():
        load_config(out)
    subprocess.run(ours(*words, "--out", "c.yaml", "--resume"), cwd=out.parent, check=True, capture_output=True)
    assert out.read_bytes() == alone.read_bytes()


def killed_diagnose(sessions: Path, rig: Path, folder: Path, moment_s: float) -> None:
    """Each file of the report is there whole, or not at all."""
    _killed(["diagnose", str(sessions), "--rig", str(rig), "--out", "report", "--quiet"], folder, moment_s)
    for path in (folder / "report").glob("[!.]*"):
        ends = {".html": "</html>", ".json": "}", ".yaml": "\n"}
        assert path.read_text().rstrip(" ").rstrip("\n").endswith(ends[path.suffix].rstrip("\n"))
    shutil.rmtree(folder / "report", ignore_errors=True)


def killed_serve(folder: Path, moment_s: float) -> int:
    """What a service had said as lines a second before it was killed is in its recording; how many samples are."""
    port, out = folder / "gyro", folder / "sessions"
    shutil.rmtree(out, ignore_errors=True)
    with suppress(LinkInUseError):
        port.unlink(missing_ok=True)
    device = PtyDevice(port)
    try:
        with Command("serve", "--port", port, "--record", out) as serve:
            begun_s, said, times_s = time.monotonic(), 0, list[float]()
            while (now_s := time.monotonic()) < begun_s + PATIENCE_S:
                if device.send(csv_line(said * 5000, said % 50 / 4.0, None, None)):
                    said += 1
                    times_s.append(now_s)
                serve._read(0.0)
                if times_s and now_s > times_s[0] + moment_s and serve.out:
                    break
                time.sleep(0.005)
            serve.process.send_signal(signal.SIGKILL)
            serve.process.wait()
            in_time = sum(each_s < time.monotonic() - 1.0 for each_s in times_s) - len("held")
    finally:
        device.close()
    if in_time <= 0:  # there may be a file, a beginning of one, or none
        for path in interrupted(out):
            repair(path)
        return 0
    (path,) = session_paths([out])
    kept = load_session(path)
    first = said_before_it_listened(kept.rate_dps.tolist())
    assert in_time <= first + len(kept.rate_dps) <= said
    expected = [number % 50 / 4.0 for number in range(first, first + len(kept.rate_dps))]
    assert kept.rate_dps.tolist() == expected, (first, kept.rate_dps.tolist())
    repair(path)
    assert len(load_session(path).rate_dps) == len(kept.rate_dps)
    return len(kept.rate_dps)


def said_before_it_listened(rates_dps: list[float]) -> int:
    """How many samples a port that was just opened threw away: what lies in it is of an earlier time."""
    return round(rates_dps[0] * 4.0) if rates_dps else 0


def _killed(words: list[str], folder: Path, moment_s: float) -> None:
    process = subprocess.Popen(ours(*words), cwd=folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    with suppress(subprocess.TimeoutExpired):
        process.wait(moment_s)
    process.kill()
    process.wait()
