"""The host's clock is set while samples come in: time goes on, and what begins again has the new calendar."""

import time
from pathlib import Path
from typing import Any

import pytest
from support import near, never, speaking_on

from gyrodrift.link.link import Link
from gyrodrift.link.options import LinkOptions
from gyrodrift.recording.recorder import Recorder, RecordOptions
from gyrodrift.session.mcap.read import read_mcap
from gyrodrift.values.sample import Sample

SET = "host_clock_set"


@pytest.mark.promise("Recovery")
@pytest.mark.parametrize("set_by_s", [3600.0, -3600.0])
def test_a_recording_has_one_calendar_and_the_next_file_the_new_one(
    tmp_path: Path, port: Path, monkeypatch: pytest.MonkeyPatch, set_by_s: float
) -> None:
    """If the host clock is set, the recording starts a new file with the new time."""
    report: list[tuple[str, dict[str, Any]]] = []
    real = time.time
    with speaking_on(port) as device:
        recorders: list[Recorder] = []

        def hear(event: str, **fields: Any) -> None:
            report.append((event, fields))
            for item in recorders:
                item.on_event(event, fields)

        link = Link(LinkOptions(str(port), 115200, "csv"), hear)
        recorder = Recorder(RecordOptions(tmp_path / "out"), link)
        recorders.append(recorder)

        def hear_lines(first: int) -> list[Sample]:
            device.send_all(b"".join(b"%d,%d\n" % (i * 10_000, i) for i in range(first, first + 10)), never)
            recorder.take(samples := link.read())
            return samples

        heard = hear_lines(0)
        link.follow_host_clock()
        monkeypatch.setattr(time, "time", lambda: real() + set_by_s)
        heard += hear_lines(10)
        link.follow_host_clock()
        heard += hear_lines(20)
        link.follow_host_clock()
        recorder.close()
        link.close()
    assert report[-1] == ("host_clock_set", {"seconds": near(set_by_s, 0.1)})
    assert [sample.rate_dps for sample in heard] == [float(i) for i in range(30)]
    before, after = (read_mcap(path) for path in recorder.paths)
    assert before.t_host_s is not None
    assert after.t_host_s is not None
    assert (len(before.rate_dps), len(after.rate_dps)) == (20, 10)
    assert before.t_host_s[-1] - before.t_host_s[0] < 60.0
    assert after.t_host_s[0] - before.t_host_s[-1] == near(set_by_s, 60.0)
    assert after.t_device_s[0] - before.t_device_s[-1] == near(0.01)


@pytest.mark.parametrize(("step_s", "told"), [(0.2, []), (-0.4, []), (0.6, [SET]), (-2.0, [SET]), (40.0, [SET])])
def test_a_step_of_half_a_second_counts(
    port: Path, monkeypatch: pytest.MonkeyPatch, step_s: float, told: list[str]
) -> None:
    """Parts of a second, as of a clock that is slewed, are not worth another file."""
    report: list[str] = []
    with speaking_on(port):
        link = Link(LinkOptions(str(port)), lambda event, **_: report.append(event))
        real = time.time
        monkeypatch.setattr(time, "time", lambda: real() + step_s)
        link.follow_host_clock()
        link.close()
    assert report == ["link_open", *told]
