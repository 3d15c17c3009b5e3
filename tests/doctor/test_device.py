"""Findings of `gyrodrift doctor` at a simulated device: each fault and effect, over a real pty."""

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import NamedTuple, cast

import pytest
from doctor_support import FAST, SECONDS, assert_findings, device, doctor
from support import speaking_on

from gyrodrift.doctor.checks.sensor import still
from gyrodrift.doctor.evidence import DeviceEvidence
from gyrodrift.facts.session_facts import SessionFacts

QUIET_RIG = "base: {sample_rate_hz: 100, dps_per_lsb: %s, noise_dps_rthz: %s, bias_dps: %s}\n"
SWAY = "about: To and fro.\nsegments: [{kind: sine, seconds: 60, amplitude_dps: 30, frequency_hz: 0.3}]\n"
RADIANS_RIG = (
    "base: {sample_rate_hz: 100, dps_per_lsb: 0.00013, noise_dps_rthz: 0.00006, bias_dps: 0.006, encoder_cpr: 0}\n"
)
RADIANS = """about: Turns of 90 deg/s as numbers in rad/s, with rests between them.
segments:
  - {kind: rest, seconds: 4}
  - {kind: ramp, seconds: 1, to_dps: 1.57}
  - {kind: hold, seconds: 4}
  - {kind: ramp, seconds: 1, to_dps: 0}
"""
REST = ("--profile", "rest")
LIVE = (*REST, "--speed", "1")
ZERO_RIG = "base: {sample_rate_hz: 100, noise_dps_rthz: 0, bias_dps: 0}\n"
MEASURED = frozenset({"noise", "bias", "drift_plain", "drift_restlevel"})
RIG, PROFILE = Path("rig.yaml"), Path("profile.yaml")


class Case(NamedTuple):
    """A simulated device by its words, and findings about it; a path among the words is one of the files.

    absent
        Checks without a finding.
    options
        Words for doctor.
    files
        Texts of rigs and profiles.
    """

    words: tuple[str | Path, ...]
    expected: tuple[tuple[str, str, str], ...]
    absent: frozenset[str] = frozenset()
    options: tuple[str, ...] = ("--seconds", SECONDS)
    files: Mapping[Path, str] = {}


CASES = {
    "bit flips, lost samples, a reset, a sensor that hangs": Case(
        (
            *(*REST, "--fault", "bit_flips", "--effect", "sample_drop:share_percent=3"),
            *("--fault", "reset:from_s=8", "--fault", "stuck_value:from_s=16"),
        ),
        (
            ("stuck", "error", "The rate was constant for"),
            ("stuck", "error", "set up the sensor again"),
            ("damage", "error", "frames are damaged"),
            ("damage", "error", "Shorten the cable"),
            ("gaps", "warning", "Lost: "),
            ("restarts", "warning", "The device restarted once."),
        ),
    ),
    "lines of stale samples with scattered times": Case(
        (
            *REST,
            "--protocol",
            "csv",
            "--effect",
            "stale_hold:share_percent=20",
            "--effect",
            "timestamp_jitter:sigma_ms=3",
        ),
        (
            ("protocol", "note", "It sends csv: lines without a checksum"),
            ("damage", "ok", "All lines could be read."),
            ("repeats", "warning", "repeat the previous one"),
            ("stamps", "warning", "data-ready interrupt"),
        ),
    ),
    "vibration above half the sample rate": Case(
        (*REST, "--effect", "vibration:amplitude_dps=0.5,frequency_hz=73"),
        (("aliasing", "warning", "A tone of 27 Hz"), ("aliasing", "warning", "an alias of 73, 127 Hz or more")),
    ),
    "vibration behind a low-pass": Case(
        (*REST, "--effect", "vibration:amplitude_dps=0.5,frequency_hz=12", "--effect", "bandwidth:cutoff_hz=12"),
        (("aliasing", "note", "A tone of 12 Hz"),),
    ),
    "coarse steps, and a range that ends": Case(
        ("--profile", "turntable", "--effect", "saturation:limit_dps=40", "--effect", "quantization:step_dps=0.25"),
        (
            ("resolution", "warning", "The step of the rate is 0.2"),
            ("clipped", "warning", "samples read exactly "),
            ("stuck", "ok", ""),
            ("repeats", "ok", ""),
        ),
    ),
    "a sensor at its rail, at another rate than HELLO says": Case(
        (*REST, "--fault", "full_scale:from_s=7", "--fault", "rate_change:from_s=6"),
        (
            ("clipped", "error", "Out of range: "),
            ("clipped", "error", "stuck at its limit"),
            ("sample_rate", "warning", "the device states 100 Hz."),
            ("rate_changes", "warning", "from 100 to 50 Hz"),
        ),
    ),
    "no device clock": Case(
        (*REST, "--protocol", "witmotion"), (("protocol", "note", "It sends witmotion, which has no device clock"),)
    ),
    "noise and bias beyond the data sheet": Case(
        (*REST, "--rig", RIG),
        (
            ("noise", "warning", "times the 0.005 of the MPU-6050"),
            ("noise", "warning", "DLPF_CFG"),
            ("bias", "warning", "the MPU-6050 may have ±20"),
        ),
        options=("--seconds", SECONDS, "--sensor", "MPU-6050"),
        files={RIG: QUIET_RIG % (0.00763, 0.02, 25.0)},
    ),
    "noise and range short of the data sheet: a mean hides noise, and a finer range is offered": Case(
        (*REST, "--rig", RIG),
        (
            ("sensor", "ok", "ICM-20948, set to ±1000 deg/s"),
            ("noise", "note", "something averages"),
            ("resolution", "note", "Choose ±250 deg/s"),
        ),
        options=("--seconds", SECONDS, "--sensor", "icm20948"),
        files={RIG: QUIET_RIG % (0.03049, 0.0035, 0.35)},
    ),
    "a plug that is pulled and put back": Case(
        (*LIVE, "--fault", "unplug:from_s=1,seconds=0.3"),
        (("unplugged", "warning", "The port was reconnected once"), ("unplugged", "warning", "cable and hub")),
        options=("--seconds", "2.5"),
    ),
    "a plug that stays pulled: what came before is told all the same": Case(
        (*LIVE, "--fault", "unplug:from_s=0.8,seconds=100"),
        (("unplugged", "error", "went away while doctor listened"), ("damage", "ok", "")),
        options=("--seconds", "1.2"),
    ),
    "a device that stops in the middle of a stream": Case(
        (*LIVE, "--fault", "stall:from_s=0.5,seconds=100"),
        (("silence", "error", "No sample for"), ("silence", "error", "firmware hangs")),
        options=("--seconds", "2"),
    ),
    **{
        f"{protocol}, a family that says exactly 0 at rest: its own filter has taken bias and noise away": Case(
            (*LIVE, "--protocol", protocol, "--rig", RIG),
            (("stuck", "note", "was exactly 0 for"), ("stuck", "note", "hides its bias")),
            options=("--seconds", "2.5"),
            files={RIG: ZERO_RIG},
        )
        for protocol in ("witmotion", "witmotion-ble", "bno08x-rvc")
    },
    "a rate of 0 of any other device, as an MPU-6050 says that has reset itself": Case(
        (*LIVE, "--rig", RIG),
        (("stuck", "error", "The sensor hangs on its bus"),),
        options=("--seconds", "2.5"),
        files={RIG: ZERO_RIG},
    ),
    "rates in radians: nothing is made of them in deg/s": Case(
        ("--protocol", "csv", "--rig", RIG, "--profile", PROFILE),
        (("rate_unit", "error", "rad/s instead of deg/s"), ("rate_unit", "error", "rate:rads")),
        absent=MEASURED,
        options=("--seconds", "1"),
        files={RIG: RADIANS_RIG, PROFILE: RADIANS},
    ),
    "a device that never rests": Case(
        ("--profile", PROFILE), (("still", "warning", "Leave it on a table"),), absent=MEASURED, files={PROFILE: SWAY}
    ),
    "a clock of milliseconds: nothing else is made of such times": Case(
        (*LIVE, "--protocol", "csv", "--fault", "millisecond_clock"),
        (("clock_unit", "error", "counts milliseconds"), ("clock_unit", "error", "--columns")),
        absent=frozenset({"sample_rate", "still", "bias"}),
        options=("--seconds", "3"),
    ),
    "a baud rate that was given and is not that of the device": Case(
        (*LIVE, "--fault", "wrong_baud:baud=9600"),
        (("protocol", "error", "at 115200 baud"), ("protocol", "error", "without --baud")),
        options=("--timeout", "1", "--baud", "115200"),
    ),
}


@pytest.mark.promise("Text and units")
@pytest.mark.parametrize("case", CASES.values(), ids=CASES)
def test_a_fault_has_its_finding(port: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], case: Case) -> None:
    """`doctor` does not report a hanging sensor for a family that sends exact zeros at rest."""
    for name, text in case.files.items():
        (tmp_path / name).write_text(text)
    with device(port, *FAST, *(tmp_path / word if isinstance(word, Path) else word for word in case.words)):
        status, result = doctor(capsys, "--port", port, *case.options)
    assert_findings(result, case.expected)
    assert not case.absent & result.keys()
    severities = {item["severity"] for item in result.values()}
    assert status == (3 if "error" in severities else 0)


def test_a_healthy_device_has_no_finding_that_matters(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with device(port, *REST):
        status, result = doctor(capsys, "--port", port, "--seconds", "3", "--sensor", "mpu6050")
    assert status == 0
    assert {item["severity"] for item in result.values()} <= {"ok", "note"}
    fine = "port protocol baud line_budget damage restarts gaps sample_rate stamps stuck repeats clipped noise"
    assert_findings(result, [(name, "ok", "") for name in fine.split()])
    assert_findings(
        result, [("sensor", "ok", "MPU-6050, set to ±250 deg/s"), ("bias", "ok", "the MPU-6050 may have ±20")]
    )
    assert_findings(result, [("drift_start_calibration", "ok", "by white noise alone. Later changes of the bias")])
    assert result["bias"]["value"] == pytest.approx(0.35, abs=0.01)
    assert result["drift_plain"]["value"] == pytest.approx(3600 * 0.35, rel=0.03)
    assert result["drift_plain"]["says"].startswith("Plain integration drifts 21 deg in a minute")
    assert result["line_budget"]["value"] == pytest.approx(10 * 20.3 * 100 / 115200, rel=0.02)


@pytest.mark.parametrize(
    ("seconds", "words"), [(2.9, "2.9 s are too short to find a rest"), (30.0, "did not stand still")]
)
def test_a_short_look_is_not_taken_for_motion(seconds: float, words: str) -> None:
    facts = SimpleNamespace(duration_s=seconds, rest=None)
    finding = still(DeviceEvidence("gyro"), cast("SessionFacts", facts))
    assert finding is not None
    assert words in finding.says


def test_what_half_a_minute_of_rest_shows(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Noise, temperature, bias that moves, and what each filter leaves; what cannot be known is said."""
    with device(port, *FAST, *REST, "--effect", "warmup:amplitude_dps=0.5,time_constant_s=200"):
        _, result = doctor(capsys, "--port", port, "--seconds", SECONDS)
    assert_findings(
        result,
        [
            ("noise", "ok", "deg/s/√Hz"),
            ("temperature", "note", " °C within "),
            ("bias_moves", "note", "The bias moved by -0."),
            ("clock_drift", "note", "times as fast as this computer: this is a replay"),
            ("sensor", "note", "MPU-6050 at ±250"),
            ("drift_start_calibration", "ok", "A start calibration of 3 s drifts ±"),
            ("drift_hdr", "ok", "learns the remaining bias from turns"),
            ("drift_restlevel", "ok", "does not drift at rest"),
        ],
    )
    assert result["noise"]["value"] == pytest.approx(2**0.5 * 0.0035, rel=0.15)
    assert result["drift_restlevel"]["value"] < result["drift_plain"]["value"] / 10


def test_samples_in_bunches(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with device(port, *REST, "--effect", "usb_batching:interval_ms=100"):
        _, result = doctor(capsys, "--port", port, "--seconds", "2")
    assert_findings(
        result, [("bursts", "note", "Samples arrive in bursts of"), ("jitter", "note", "Samples arrive unevenly")]
    )
    assert result["bursts"]["value"] > 5


def test_a_device_that_says_nothing(port: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An error, with what to look at."""
    with speaking_on(port):
        status, result = doctor(capsys, "--port", port, "--timeout", "0.5")
    assert status == 3
    assert_findings(
        result, [("protocol", "error", "whether TX and RX are swapped"), ("port", "ok", "The port is /dev/pts/")]
    )
