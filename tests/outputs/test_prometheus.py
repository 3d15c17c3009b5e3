"""The output prometheus, scraped by Prometheus itself, and read by promtool and over HTTP."""

import json
import shutil
import socket
import subprocess
import time
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from outputs_support import address_of, csv_at_100_hz, hub, serving
from support import PATIENCE_S, never

from gyrodrift.outputs.status import FilterStatus, LinkStatus, OutputStatus, ServiceStatus

pytest.importorskip("prometheus_client", reason="the extra prometheus is not installed")
from prometheus_client.parser import text_string_to_metric_families

STATUS = ServiceStatus(
    link=LinkStatus(port="/dev/gyro", is_open=True, samples=1234, jitter_ms=2.5, rate_hz=100.0),
    filter=FilterStatus(
        "restlevel",
        yaw_deg=12.5,
        bias_dps=-0.25,
        aids={"gps.course": {"age_s": 1.5, "weight": None, "differs": None}},
    ),
    outputs=(OutputStatus("tcp", "127.0.0.1:7117", "", (), 2, 99, 3), OutputStatus('udp:host="x"', problem="no")),
)


@pytest.fixture
def page() -> Iterator[str]:
    """Address of a page that tells of STATUS."""
    with hub("prometheus:port=0") as outputs:
        address = outputs.address
        outputs.status(STATUS)
        url = f"http://{address}/metrics"
        until_s = time.monotonic() + PATIENCE_S
        while "gyrodrift_link_samples_total 1234.0" not in fetched(url):
            assert time.monotonic() < until_s, fetched(url)
        yield url


def test_a_second_source_has_its_age(page: str) -> None:
    assert 'gyrodrift_aid_age_seconds{name="gps.course"} 1.5' in fetched(page)
    assert "gyrodrift_aid_weight_ratio{" not in fetched(page)


def test_the_yaw_of_the_device_is_a_gauge_where_it_sends_one(page: str) -> None:
    """A device without a filter has none of them."""
    assert "gyrodrift_device" not in fetched(page)
    own = FilterStatus("restlevel", device_yaw_deg=2.5, device_bias_dps=-0.5, device_difference_deg=-0.25)
    with hub("prometheus:port=0") as outputs:
        url = f"http://{outputs.address}/metrics"
        outputs.status(replace(STATUS, filter=own))
        until_s = time.monotonic() + PATIENCE_S
        while "gyrodrift_device_yaw_degrees 2.5" not in (text := fetched(url)):
            assert time.monotonic() < until_s, text
    assert "gyrodrift_device_difference_degrees -0.25" in text
    assert "gyrodrift_device_drift_degrees_per_second -0.5" in text
    assert "gyrodrift_device_yaw_sigma_degrees " not in text


def fetched(url: str, accept: str = "text/plain") -> str:
    request = urllib.request.Request(url, headers={"Accept": accept})
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        assert answer.headers["Content-Type"].startswith(accept.partition(";")[0])
        return str(answer.read().decode())


def test_it_tells_of_link_filter_and_outputs(page: str) -> None:
    families = text_string_to_metric_families(fetched(page))
    values = {
        (sample.name, sample.labels.get("output")): sample.value for family in families for sample in family.samples
    }
    assert values["gyrodrift_link_jitter_seconds", None] == 0.0025
    assert values["gyrodrift_yaw_degrees", None] == 12.5
    assert values["gyrodrift_output_clients", "tcp"] == 2
    assert values["gyrodrift_output_dropped_total", "tcp"] == 3
    assert values["gyrodrift_output_open", 'udp:host="x"'] == 0
    assert ("gyrodrift_heading_degrees", None) not in values


def test_a_tilt_is_shown_where_there_is_one(page: str) -> None:
    assert "gyrodrift_tilt_degrees" not in fetched(page)
    tilt = FilterStatus("restlevel", tilt_deg=22.0, roll_deg=10.0, pitch_deg=-20.0, tilt_sigma_deg=0.4)
    with hub("prometheus:port=0") as outputs:
        url = f"http://{outputs.address}/metrics"
        outputs.status(replace(STATUS, filter=tilt))
        until_s = time.monotonic() + PATIENCE_S
        while "gyrodrift_pitch_degrees -20.0" not in (text := fetched(url)):
            assert time.monotonic() < until_s, text
    for line in ("gyrodrift_tilt_degrees 22.0", "gyrodrift_roll_degrees 10.0", "gyrodrift_tilt_sigma_degrees 0.4"):
        assert line in text


@pytest.mark.promise("Clients of outputs")
def test_names_that_are_no_text_are_told_with_escapes() -> None:
    """A path that is not valid text appears with escapes in metrics and `status`."""
    odd = replace(
        STATUS,
        link=replace(STATUS.link, port="/dev/gy\udcff"),
        outputs=(OutputStatus("unix:path=/tmp/\udcfe", "/tmp/\udcfe", "", (), 0, 0, 0),),
    )
    with hub("prometheus:port=0") as outputs:
        url = f"http://{outputs.address}/metrics"
        outputs.status(odd)
        until_s = time.monotonic() + PATIENCE_S
        while "udcff" not in (text := fetched(url)):
            assert time.monotonic() < until_s, text
    assert r'port="/dev/gy\\udcff"' in text
    assert r'output="unix:path=/tmp/\\udcfe"' in text


def test_open_metrics_are_given_to_who_asks_for_them(page: str) -> None:
    assert fetched(page, "application/openmetrics-text; version=1.0.0").endswith("# EOF\n")
    with pytest.raises(urllib.error.HTTPError) as answer, urllib.request.urlopen(page + "x", timeout=PATIENCE_S):
        pass
    with answer.value as response:
        assert response.code == 404
        assert b"/metrics" in response.read()


def test_promtool_finds_no_fault(page: str) -> None:
    """Names, units and help as Prometheus would have them."""
    promtool = shutil.which("promtool")
    if promtool is None:
        pytest.skip("promtool, of Debian's package prometheus, is not installed")
    result = subprocess.run(
        [promtool, "check", "metrics"], input=fetched(page), capture_output=True, text=True, check=False
    )
    assert (result.returncode, result.stdout, result.stderr) == (0, "", "")


def test_prometheus_scrapes_a_service(port: Path, tmp_path: Path) -> None:
    """The real server asks the real command, and answers a query."""
    prometheus = shutil.which("prometheus")
    if prometheus is None:
        pytest.skip("Debian's package prometheus is not installed")
    with serving(port, "--output", "prometheus:port=0") as (serve, device):
        host, number = address_of(serve, "prometheus")
        device.send_all(csv_at_100_hz(60), never)
        serve.take_lines(59)
        config = tmp_path / "prometheus.yml"
        jobs = [{"job_name": "gyro", "scrape_interval": "1s", "static_configs": [{"targets": [f"{host}:{number}"]}]}]
        config.write_text(json.dumps({"scrape_configs": jobs}))
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            web = f"127.0.0.1:{free.getsockname()[1]}"
        command = [prometheus, f"--config.file={config}", f"--storage.tsdb.path={tmp_path / 'tsdb'}"]
        with subprocess.Popen([*command, f"--web.listen-address={web}"], stderr=subprocess.DEVNULL) as server:
            try:
                assert requested(web, "gyrodrift_link_samples_total >= 59")["metric"]["job"] == "gyro"
                assert requested(web, "up == 1")["metric"]["instance"] == f"{host}:{number}"
            finally:
                server.kill()


def requested(web: str, query: str) -> Any:
    """The first series of a query, once there is one."""
    until_s = time.monotonic() + PATIENCE_S
    url = f"http://{web}/api/v1/query?query={urllib.parse.quote(query)}"
    while True:
        assert time.monotonic() < until_s, f"Prometheus has nothing for {query}"
        try:
            with urllib.request.urlopen(url, timeout=PATIENCE_S) as answer:
                result = json.loads(answer.read())["data"]["result"]
        except OSError:
            result = []  # it is starting
        if result:
            return result[0]
        time.sleep(0.1)


@pytest.mark.promise("Clients of outputs")
@pytest.mark.parametrize(
    "accept",
    [
        'application/openmetrics-text; version="1.0.0"',
        "application/openmetrics-text;version=1.x",
        "text/plain;version=1.0.0.0.0.0",
        "text/plain;version=\xb2",
        'a;b="c;d,e";;=,,',
        ";" * 8000,
        "",
    ],
)
def test_no_accept_header_is_an_error(page: str, accept: str) -> None:
    """No Accept header causes an error."""
    request = urllib.request.Request(page, headers={"Accept": accept})
    with urllib.request.urlopen(request, timeout=PATIENCE_S) as answer:
        assert answer.status == 200
        assert b"gyrodrift_link_samples_total 1234.0" in answer.read()


def test_a_quoted_version_is_understood(page: str) -> None:
    assert fetched(page, 'application/openmetrics-text; version="1.0.0"').endswith("# EOF\n")
