"""JSON for any wrapper: what `gyrodrift.effects.apply` takes."""

import json
from typing import Any

from gyrodrift.diagnose.export.exported import Exported, ExportedEffect, MeasuredValue
from gyrodrift.diagnose.export.formats import FormatExport, off_the_rate
from gyrodrift.diagnose.inference.parameters import unit_of
from gyrodrift.effects import EFFECTS

FILE = "effects.json"
FORMAT, VERSION = "gyrodrift-effects", 1
"""Name and version of the format. By definition: the public interface has them."""

UNKNOWN = "gyrodrift.effects does not know it"


def effects_json(exported: Exported) -> FormatExport:
    """Effects on the rate under `effects`, the others under `not_expressed` with the reason."""
    missing = {effect.name: UNKNOWN for effect in exported.effects if effect.name not in EFFECTS}
    missing |= off_the_rate(exported.effects)
    expressed = [effect for effect in exported.effects if effect.name not in missing]
    content = {
        "format": FORMAT,
        "version": VERSION,
        "says": exported.says,
        "sample_rate_hz": exported.sample_rate_hz,
        "effects": [entry_of(effect) for effect in expressed],
        "noise": noise_entries(exported),
        "not_expressed": [
            {**entry_of(effect), "why": missing[effect.name]} for effect in exported.effects if effect.name in missing
        ],
    }
    text = json.dumps(content, indent=1, ensure_ascii=False, allow_nan=False) + "\n"
    return FormatExport("json", {FILE: text}, tuple(effect.name for effect in expressed), missing)


def entry_of(effect: ExportedEffect) -> dict[str, Any]:
    """An effect with parameters, units, intervals and probability."""
    has = {} if effect.in_simulator is None else {"in_simulator": dict(effect.in_simulator)}
    return {
        "effect": effect.name,
        "parameters": dict(effect.parameters),
        "units": {name: unit_of(name) for name in effect.parameters},
        "intervals": {name: list(interval) for name, interval in effect.intervals.items()},
        "probability": round(effect.probability, 4),
        "tied_with": list(effect.tied_with),
        **has,
    }


def noise_entries(exported: Exported) -> list[dict[str, Any]]:
    """Measured noise and bias in the form of effects; the interval is the range over the sessions."""
    return [
        _measured_entry("white_noise", "density_dps_rthz", exported.noise_dps_rthz),
        _measured_entry("constant_bias", "bias_dps", exported.bias_dps),
    ]


def _measured_entry(name: str, parameter: str, measured: MeasuredValue) -> dict[str, Any]:
    return {
        "effect": name,
        "parameters": {parameter: measured.value},
        "sessions": {parameter: [measured.low, measured.high]},
    }
