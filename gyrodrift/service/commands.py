"""Commands of `gyrodrift ctl`, carried out by the running service."""

import time
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from ipaddress import ip_address
from math import isfinite, nan
from typing import Any
from urllib.parse import urlsplit

from gyrodrift.outputs.output import ControlAccess
from gyrodrift.outputs.status import OutputStatus, aid_status
from gyrodrift.service.config_follower import ConfigFollower
from gyrodrift.service.control import CommandError, ControlCommand, Later, number
from gyrodrift.service.guided import GuidedCalibration
from gyrodrift.service.loop import Statements
from gyrodrift.service.recording_switch import RecordingSwitch
from gyrodrift.service.reporting import Reporting
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.source_lines import SourceLines
from gyrodrift.service.stdout import JsonLines
from gyrodrift.values.aid import Aid
from gyrodrift.values.errors import CalibrationError, ConfigError, UsageError

WEB = "web"
FASTEST_HZ = 1e6
OPENING_S = 3.0
"""Longest wait of `page` for a page that is being opened, s."""

SAMPLE_S = 1.0
"""Longest wait of `heading --sigma` and `turn-rate` for the next sample, s."""

CTL = "ctl"
"""Name of the second source that a person is."""

WRITING_S = 3.0
"""Longest wait of `record stop` for the disk, s; a slower disk goes on writing behind the answer."""

SIGMA = "--sigma"
NO_REST_WORD = "auto"
"""Argument of `rest` that ends `rest 0` and `rest 1`: the device's own statements count again."""


@dataclass(slots=True)
class ServiceCommands:
    """Parts of the service that carry out the commands.

    stdout
        JSON lines on stdout; None if a terminal shows one line.
    access
        Token of the live page.
    """

    follower: ConfigFollower
    stdout: JsonLines | SourceLines | None
    reporting: Reporting
    stop: StopSignal
    statements: Statements
    recording: RecordingSwitch
    calibration: GuidedCalibration
    access: ControlAccess

    def all(self) -> dict[str, ControlCommand]:
        """Commands by name."""
        commands = (
            ControlCommand("zero", self._zero),
            ControlCommand("heading DEG [--sigma DEG]", self._heading),
            ControlCommand("turn-rate DPS --sigma DPS", self._turn_rate),
            ControlCommand("rest 0|1|auto", self._rest),
            ControlCommand("rate HZ", self._rate),
            ControlCommand("record start|stop", self._record),
            ControlCommand("calibrate start|positions|axis-turns|mark|undo|finish|cancel|state", self._calibrate),
            ControlCommand("page", self._page),
            ControlCommand("status", self._status),
            ControlCommand("reload", self._reload),
            ControlCommand("stop", self._stop),
        )
        return {command.usage.split()[0]: command for command in commands}

    def _zero(self, words: list[str]) -> Mapping[str, Any]:
        _check_empty(words, "zero")
        self.follower.pipeline.zero()
        self.reporting.feed.hear("yaw_zeroed", {})
        return {"yaw_deg": self.follower.pipeline.yaw_deg}

    def _heading(self, words: list[str]) -> Mapping[str, Any] | Later:
        words, sigma_deg = _sigma_of(words)
        heading_deg = number(words, "heading DEG, clockwise from north, and maybe --sigma DEG") % 360.0
        pipeline = self.follower.pipeline
        if sigma_deg is None or not pipeline.reference.has_north:
            pipeline.set_heading(heading_deg)
            self.reporting.feed.hear("heading_set", {"heading_deg": heading_deg})
        if sigma_deg is None:
            return {"heading_deg": heading_deg}
        return self._aid(Aid(CTL, "heading", -heading_deg, sigma=sigma_deg), {"heading_deg": heading_deg})

    def _turn_rate(self, words: list[str]) -> Mapping[str, Any] | Later:
        words, sigma_dps = _sigma_of(words)
        rate_dps = number(words, usage := "turn-rate DPS --sigma DPS, counter-clockwise positive")
        if sigma_dps is None:
            raise CommandError(f"expected {usage}")
        aid = Aid(f"{CTL}_turn_rate", "turn_rate", rate_dps, sigma=sigma_dps)
        return self._aid(aid, {"turn_rate_dps": rate_dps})

    def _aid(self, aid: Aid, fields: dict[str, Any]) -> Later:
        """Hand a measurement to the filter with the next sample; the answer says how it agrees."""
        run = self.follower.pipeline.run
        if not isfinite(run.state.yaw_sigma_deg) and run.state.samples > 0:
            raise CommandError(f"the filter {run.filter.name} gives no uncertainty to weigh it against")
        self.statements.take(aid)
        until_s = time.monotonic() + SAMPLE_S

        def answer() -> Mapping[str, Any] | None:
            if any(waiting is aid for _, waiting in self.statements.waiting):
                if time.monotonic() < until_s:
                    return None
                return {**fields, "aid": None, "note": "no sample has come yet; it waits for the next one"}
            status = self.follower.pipeline.run.aids.get(aid.name)
            return {**fields, "aid": None if status is None else aid_status(status)}

        return answer

    def _rest(self, words: list[str]) -> Mapping[str, Any]:
        if words not in (["0"], ["1"], [NO_REST_WORD]):
            raise CommandError(f"expected rest 0 or rest 1, or rest {NO_REST_WORD} to end it")
        witness = self.follower.pipeline.witness
        if witness is None:
            raise CommandError(f"the filter {self.follower.pipeline.filter.name} takes no witness of rest")
        still = None if words == [NO_REST_WORD] else float(words[0])
        is_new = self.statements.still != still
        self.statements.still = nan if still is None else still
        return {"still": still, "is_believed": witness.is_believed or is_new}

    def _rate(self, words: list[str]) -> Mapping[str, Any]:
        rate_hz = number(words, "rate HZ, or rate 0 for every sample")
        if not 0.0 <= rate_hz <= FASTEST_HZ:
            raise CommandError(f"expected rate HZ with a number from 0 to {FASTEST_HZ:.0f}")
        if self.stdout is None:
            raise CommandError("stdout shows one line on a terminal; start serve with --json")
        self.stdout.set_rate(rate_hz or None)
        return {"rate_hz": rate_hz or None}

    def _record(self, words: list[str]) -> Mapping[str, Any] | Later:
        if words not in (["start"], ["stop"]):
            raise CommandError("expected record start or record stop")
        if words == ["stop"]:
            return self._stop_recording()
        try:
            self.recording.start()
        except UsageError as error:
            raise CommandError(str(error)) from error
        self.reporting.feed.hear("recording_started", {"file": self.recording.file})
        return {"file": self.recording.file}

    def _stop_recording(self) -> Later:
        ended, until_s = self.recording.stop(), time.monotonic() + WRITING_S

        def answer() -> Mapping[str, Any] | None:
            if ended is not None and not ended.is_over and time.monotonic() < until_s:
                return None
            files = [] if ended is None else [str(path) for path in ended.paths]
            self.reporting.feed.hear("recording_stopped", {"files": files})
            if ended is not None and ended.failure:
                lost = f"{ended.unrecorded} samples are not recorded"
                raise CommandError(f"it is stopped, but it had failed: {ended.failure}; {lost}")
            return {"files": files}

        return answer

    def _calibrate(self, words: list[str]) -> Mapping[str, Any] | Later:
        match words:
            case ["start" | "positions" | "axis-turns" as kind]:
                return _refused(self.calibration.start(kind))
            case ["state"]:
                return self.calibration.state()
            case ["mark" | "undo" | "finish" | "cancel" as word]:
                try:
                    return self.calibration.press(word)
                except CalibrationError as error:
                    raise CommandError(str(error)) from error
        raise CommandError("expected calibrate start, positions, axis-turns, mark, undo, finish, cancel or state")

    def _page(self, words: list[str]) -> Later:
        _check_empty(words, "page")
        until_s = time.monotonic() + OPENING_S

        def answer() -> Mapping[str, Any] | None:
            try:
                return {"url": page_url(self.reporting.feed.statuses(), self.access.token)}
            except CommandError:
                if time.monotonic() < until_s and any(spec.name == WEB for spec in self.reporting.feed.specs):
                    return None
                raise

        return answer

    def _status(self, words: list[str]) -> Mapping[str, Any]:
        _check_empty(words, "status")
        return asdict(self.reporting.status())

    def _reload(self, words: list[str]) -> Later:
        _check_empty(words, "reload")
        if self.follower.watch is None:
            raise CommandError("the service runs without --config")
        pending_changes = self.follower.reload(self.follower.watch)

        def answer() -> Mapping[str, Any] | None:
            try:
                changes = pending_changes()
            except ConfigError as error:
                raise CommandError(str(error)) from error
            return None if changes is None else {"changes": changes}

        return answer

    def _stop(self, words: list[str]) -> Mapping[str, Any]:
        _check_empty(words, "stop")
        self.stop.is_set = True
        return {}


def _sigma_of(words: list[str]) -> tuple[list[str], float | None]:
    """Words without `--sigma NUMBER`, and the number; None without it."""
    if SIGMA not in words:
        return words, None
    index = words.index(SIGMA)
    sigma = number(words[index + 1 : index + 2], f"a number behind {SIGMA}")
    if sigma <= 0.0:
        raise CommandError(f"expected a number above 0 behind {SIGMA}")
    return words[:index] + words[index + 2 :], sigma


def _refused(answer: Later) -> Later:
    """Turn a CalibrationError of an answer into a CommandError."""

    def checked() -> Mapping[str, Any] | None:
        try:
            return answer()
        except CalibrationError as error:
            raise CommandError(str(error)) from error

    return checked


def _check_empty(words: list[str], usage: str) -> None:
    if words:
        raise CommandError(f"expected {usage} alone")


def page_url(outputs: Iterable[OutputStatus], token: str) -> str:
    """URL of the first open live page on loopback, with the token that lets its buttons work.

    Browsers do not send the part after the `#`.

    Raises
    ------
    CommandError
        If there is none.
    """
    statuses = [status for status in outputs if status.output.partition(":")[0] == WEB]
    pages = [urlsplit(status.address) for status in statuses]
    open_pages = [page for page in pages if page.hostname and page.port]
    if not statuses:
        raise CommandError("no live page is open; start serve with --output web")
    if not open_pages:
        raise CommandError(f"the live page is not open: {statuses[0].problem or 'is being opened'}")
    for page in open_pages:
        host = _loopback_of(page.hostname or "")
        if host:
            return f"{page.scheme}://{host}:{page.port}/#token={token}"
    raise CommandError(f"the page listens on {open_pages[0].hostname} alone; its buttons need host=127.0.0.1")


def _loopback_of(host: str) -> str:
    """Loopback name under which a server that listens on this host is reached; empty if it is not."""
    if host == "localhost":
        return host
    try:
        address = ip_address(host)
    except ValueError:
        return ""
    if address.is_unspecified:
        return "127.0.0.1" if address.version == 4 else "[::1]"
    name = f"[{host}]" if address.version == 6 else host
    return name if address.is_loopback else ""
