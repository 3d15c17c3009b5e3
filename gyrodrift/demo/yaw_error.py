"""Yaw error against the encoder, of the integrated rate and of the corrected yaw."""

from dataclasses import dataclass, field
from typing import Any

HISTORY = 4096


@dataclass(slots=True)
class YawError:
    """Mean |error| in degrees; all angles are 0 at the first sample.

    raw_deg, corrected_deg, true_deg
        The latest angles.
    history
        (t_s, raw error, corrected error) of the samples, thinned when the list grows long.
    """

    samples: int = 0
    t_s: float = 0.0
    raw_deg: float = 0.0
    corrected_deg: float = 0.0
    true_deg: float = 0.0
    rate_dps: float = 0.0
    bias_dps: float = 0.0
    raw_sum_deg: float = 0.0
    corrected_sum_deg: float = 0.0
    first_s: float = 0.0
    history: list[tuple[float, float, float]] = field(default_factory=list)
    _first_encoder_deg: float = 0.0

    def add(self, line: dict[str, Any]) -> None:
        """Add a line of `serve`; lines without an encoder angle are ignored."""
        if "encoder_deg" not in line:
            return
        t_s = float(line["t_s"])
        if self.samples:
            self.raw_deg += 0.5 * (self.rate_dps + float(line["rate_dps"])) * (t_s - self.t_s)
        else:
            self.first_s = t_s
            self._first_encoder_deg = float(line["encoder_deg"])
        self.t_s = t_s
        self.samples += 1
        self.rate_dps, self.bias_dps = float(line["rate_dps"]), float(line["bias_dps"])
        self.corrected_deg = float(line["yaw_deg"])
        self.true_deg = float(line["encoder_deg"]) - self._first_encoder_deg
        self.raw_sum_deg += abs(self.raw_error_deg)
        self.corrected_sum_deg += abs(self.corrected_error_deg)
        self.history.append((t_s, self.raw_error_deg, self.corrected_error_deg))
        if len(self.history) > 2 * HISTORY:
            self.history = self.history[::2]

    @property
    def elapsed_s(self) -> float:
        """Device time since the first sample, s."""
        return self.t_s - self.first_s

    @property
    def raw_error_deg(self) -> float:
        """Error of the integrated rate, deg."""
        return self.raw_deg - self.true_deg

    @property
    def corrected_error_deg(self) -> float:
        """Error of the corrected yaw, deg."""
        return self.corrected_deg - self.true_deg

    @property
    def raw_mean_deg(self) -> float:
        """Mean |error| of the integrated rate, deg."""
        return self.raw_sum_deg / max(1, self.samples)

    @property
    def corrected_mean_deg(self) -> float:
        """Mean |error| of the corrected yaw, deg."""
        return self.corrected_sum_deg / max(1, self.samples)
