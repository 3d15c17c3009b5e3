"""What `gyrodrift ctl` can ask of a running service."""

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from math import nan
from typing import Any

from gyrodrift.errors import ConfigError
from gyrodrift.service.control import CommandError, ControlCommand, Later, number
from gyrodrift.service.filtering import Filtering
from gyrodrift.service.reporting import Reporting
from gyrodrift.service.rest_word import RestWord
from gyrodrift.service.signals import StopSignal
from gyrodrift.service.stdout import JsonLines

FASTEST_HZ = 1e6

UNSAID = "auto"
"""What takes back a word of rest: the device's own counts again, if it says any."""


@dataclass(slots=True)
class ServiceCommands:
    """Who carries them out."""

    filtering: Filtering
    stdout: JsonLines | None
    reporting: Reporting
    stop: StopSignal
    word: RestWord

    def all(self) -> dict[str, ControlCommand]:
        """By name."""
        return {
            "zero": ControlCommand("zero", self._zero),
            "heading": ControlCommand("heading DEG", self._heading),
            "rest": ControlCommand("rest 0|1", self._rest),
            "rate": ControlCommand("rate HZ", self._rate),
            "status": ControlCommand("status", self._status),
            "reload": ControlCommand("reload", self._reload),
            "stop": ControlCommand("stop", self._stop),
        }

    def _zero(self, words: list[str]) -> Mapping[str, Any]:
        _none(words, "zero")
        self.filtering.zero()
        self.reporting.feed.hear("yaw_zeroed", {})
        return {"yaw_deg": self.filtering.yaw_deg}

    def _heading(self, words: list[str]) -> Mapping[str, Any]:
        heading_deg = number(words, "heading DEG, clockwise from north") % 360.0
        self.filtering.set_heading(heading_deg)
        self.reporting.feed.hear("heading_set", {"heading_deg": heading_deg})
        return {"heading_deg": heading_deg}

    def _rest(self, words: list[str]) -> Mapping[str, Any]:
        if words not in (["0"], ["1"], [UNSAID]):
            raise CommandError(f"expected rest 0 or rest 1, or rest {UNSAID} to take it back")
        witness = self.filtering.witness
        if witness is None:
            raise CommandError(f"the filter {self.filtering.filter.name} takes no witness of rest")
        said = None if words == [UNSAID] else float(words[0])
        is_new = self.word.still != said
        self.word.still = nan if said is None else said
        return {"still": said, "is_believed": witness.is_believed or is_new}

    def _rate(self, words: list[str]) -> Mapping[str, Any]:
        rate_hz = number(words, "rate HZ, or rate 0 for every sample")
        if not 0.0 <= rate_hz <= FASTEST_HZ:
            raise CommandError(f"expected rate HZ with a number from 0 to {FASTEST_HZ:.0f}")
        if self.stdout is None:
            raise CommandError("stdout shows one line on a terminal; start serve with --json")
        self.stdout.set_rate(rate_hz or None)
        return {"rate_hz": rate_hz or None}

    def _status(self, words: list[str]) -> Mapping[str, Any]:
        _none(words, "status")
        return asdict(self.reporting.status())

    def _reload(self, words: list[str]) -> Later:
        _none(words, "reload")
        if self.filtering.watch is None:
            raise CommandError("the service runs without --config")
        changes = self.filtering.reload(self.filtering.watch)

        def answer() -> Mapping[str, Any] | None:
            try:
                found = changes()
            except ConfigError as error:
                raise CommandError(str(error)) from error
            return None if found is None else {"changes": found}

        return answer

    def _stop(self, words: list[str]) -> Mapping[str, Any]:
        _none(words, "stop")
        self.stop.is_set = True
        return {}


def _none(words: list[str], usage: str) -> None:
    if words:
        raise CommandError(f"expected {usage} alone")
