"""Log of a link: frequent events are reported together, and none is lost at the end."""

from typing import Any

import structlog

from gyrodrift.link.events import LinkEvents


def test_what_comes_often_is_told_at_once_then_together_and_the_last_at_the_end() -> None:
    now_s, report = [0.0], list[tuple[str, dict[str, Any]]]()
    events = LinkEvents(structlog.get_logger(), monotonic=lambda: now_s[0])
    events.listeners.append(lambda event, fields: report.append((event, fields)))
    for name in ("a", "b", "c"):
        events("device", device_id=name)
    assert report == [("device", {"device_id": "a"})]
    events.report_pending()
    assert len(report) == 1
    now_s[0] = 2.0
    events.report_pending()
    assert report[1:] == [("device", {"device_id": "c", "times": 2})]
    events("device", device_id="d")
    events.report_pending(is_end=True)
    assert report[2:] == [("device", {"device_id": "d"})]
    events.report_pending(is_end=True)
    assert len(report) == 3
