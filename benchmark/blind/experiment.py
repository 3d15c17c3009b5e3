"""Does the next recording that `diagnose` proposes name the cause? `python -m benchmark blind.experiment --out DIR`.

Each case is a rig with one effect, played through a motion that shows little of it. Where `diagnose` does not name the
effect, or ties it, one more set of sessions is simulated with the motion that it proposes, and one with a motion at
random of the same length; each is diagnosed together with the first. Only the command line is used. Cases with a
result are not run again.
"""

import argparse
import re
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from math import exp, log
from pathlib import Path
from random import Random
from typing import Any

from gyrogap.chance import wilson
from gyrogap.json_files import write_json
from this_tree import run_gyrodrift

from blind.gap import Said, load_json, read_gap

SESSIONS, FIRST_MINUTES = 3, 4.0

MINUTES = re.compile(r"^about: ['\"]?([\d.]+) min\b", re.MULTILINE)
PROBABILITY = re.compile(r"with probability ([\d.]+)")

RIGS = {
    "fine": "base: {noise_dps_rthz: 0.0035, bias_dps: 0.35, encoder_cpr: 36000}",
    "coarse": "base: {dps_per_lsb: 0.0153, noise_dps_rthz: 0.006, bias_dps: -0.6, encoder_cpr: 8192}",
}

POORLY_SHOWN = (
    ("rest", "warmup:amplitude_dps=-0.06,time_constant_s=240"),
    ("rest", "temp_bias:slope_dps_per_c=0.008"),
    ("drive", "warmup:amplitude_dps=0.03"),
    ("drive", "temp_bias:slope_dps_per_c=0.003"),
    ("drive", "temp_scale:slope_percent_per_c=0.01"),
    ("drive", "bandwidth:cutoff_hz=30"),
    ("drive", "latency:delay_ms=2"),
    ("drive", "nonlinearity:error_percent_fs=0.06"),
    ("drive", "saturation:limit_dps=190"),
    ("drive", "vibration_rectification:bias_dps_at_100_dps=0.02"),
    ("constant-spin", "scale_asymmetry:error_percent=0.08"),
    ("constant-spin", "scale_factor:error_percent=0.12"),
    ("constant-spin", "vibration_rectification:bias_dps_at_100_dps=0.03"),
    ("constant-spin", "g_sensitivity:amplitude_dps=0.01"),
    ("constant-spin", "encoder_eccentricity:amplitude_deg=0.04"),
    ("constant-spin", "backlash:play_deg=0.03"),
    ("constant-spin", "deadband:width_dps=0.1"),
    ("constant-spin", "bandwidth:cutoff_hz=40"),
    ("constant-spin", "latency:delay_ms=4"),
    ("constant-spin", "temp_scale:slope_percent_per_c=0.01"),
)
"""A shipped motion, and an effect that it does not show, or not apart from others."""


@dataclass(frozen=True, slots=True)
class Case:
    """A rig of RIGS, a motion, an effect, and the seed of its sessions."""

    name: str
    rig: str
    motion: str
    effect: str
    seed: int

    @property
    def cause(self) -> str:
        """Name of the effect."""
        return self.effect.partition(":")[0]


def cases(seed: int) -> list[Case]:
    """Every pair of POORLY_SHOWN with each rig."""
    pairs = [(rig, motion, effect) for rig in RIGS for motion, effect in POORLY_SHOWN]
    return [
        Case(f"{rig}-{motion}-{effect.partition(':')[0]}", rig, motion, effect, seed + 10 * number)
        for number, (rig, motion, effect) in enumerate(pairs)
    ]


def names(said: Said, cause: str) -> bool:
    """Whether a cause is named first, and tied with nothing."""
    return bool(said.named) and said.named[0].effect == cause and not said.named[0].tied_with


def random_profile(minutes: float, seed: int) -> str:
    """A motion of constant rates, swings and rests, each of random length, speed and sign, as a profile's file."""
    rng = Random(seed)
    lines, left_s = [f"about: {minutes:g} min at random", "segments:", "  - {kind: rest, seconds: 5}"], 60 * minutes - 5
    while left_s > 0.0:
        seconds = rng.uniform(4.0, 20.0)
        seconds = left_s if left_s - seconds < 4.0 else seconds
        rate_dps = rng.choice([-1.0, 1.0]) * exp(rng.uniform(log(2.0), log(200.0)))
        periods = max(1, round(seconds * exp(rng.uniform(log(0.3), log(3.0)))))
        lines.append("  - " + rng.choice(_pieces(seconds, rate_dps, periods / seconds)))
        left_s -= seconds
    return "\n".join(lines) + "\n"


def _pieces(seconds: float, rate_dps: float, frequency_hz: float) -> tuple[str, ...]:
    """Segments of a length, each as a profile writes it."""
    amplitude_dps, held_s = rate_dps / max(1.0, frequency_hz), seconds - 0.8
    return (
        f"{{kind: rest, seconds: {seconds:.9f}}}",
        f"{{kind: sine, seconds: {seconds:.9f}, amplitude_dps: {amplitude_dps:.9f}, frequency_hz: {frequency_hz:.9f}}}",
        f"{{kind: steps, rates_dps: [{rate_dps:.9f}], ramp_seconds: 0.4, hold_seconds: {held_s:.9f}}}",
    )


def run_case(case: Case, folder: Path) -> dict[str, Any]:
    """What was said at first, with the proposed motion, and with one at random."""
    folder.mkdir(parents=True, exist_ok=True)
    rig = folder / "base.yaml"
    rig.write_text(RIGS[case.rig] + "\neffects: []\n")
    first = _simulated(case, rig, case.motion, FIRST_MINUTES, folder / "first", case.seed)
    said = _diagnosed([first], rig, folder / "report")
    found: dict[str, Any] = {"case": case.name, "cause": case.cause, "at_first": names(said, case.cause)}
    if found["at_first"]:
        return found
    proposed = folder / "report" / "next-profile.yaml"
    text = proposed.read_text() if proposed.is_file() else ""
    found |= {"next": load_json(folder / "report" / "gap.json")["next"], "is_proposed": bool(text)}
    length = MINUTES.search(text)
    minutes = float(length[1]) if length else FIRST_MINUTES
    drawn = folder / "random.yaml"
    drawn.write_text(random_profile(minutes, case.seed))
    for key, profile in (("proposed", proposed), ("random", drawn)):
        if profile.is_file():
            more = _simulated(case, rig, str(profile), minutes, folder / key, case.seed + 1)
            found[key] = names(_diagnosed([first, more], rig, folder / f"report-{key}"), case.cause)
    return found


def _simulated(case: Case, rig: Path, motion: str, minutes: float, out: Path, seed: int) -> Path:
    words = ["--rig", str(rig), "--effect", case.effect, "--profile", motion, "--sessions", str(SESSIONS)]
    run_gyrodrift("simulate", "--out", str(out), *words, "--minutes", f"{minutes:g}", "--seed", str(seed))
    return out


def _diagnosed(sessions: Sequence[Path], rig: Path, out: Path) -> Said:
    run_gyrodrift("diagnose", *map(str, sessions), "--rig", str(rig), "--out", str(out), "--jobs", "1")
    return read_gap(load_json(out / "gap.json"))


def summary(results: Sequence[dict[str, Any]]) -> list[str]:
    """Shares with their intervals; a case without a proposal is one in which the proposed motion named nothing."""
    open_cases = [one for one in results if not one["at_first"]]
    lines = [f"{len(results)} cases, {len(open_cases)} tied or undetected at first"]
    for key in ("proposed", "random"):
        hits, total = sum(bool(one.get(key)) for one in open_cases), len(open_cases)
        low, high = wilson(hits, total)
        lines.append(f"named with the {key} motion: {hits} of {total} ({low:.2f} to {high:.2f})")
    told = [(match, one) for one in open_cases if (match := PROBABILITY.search(one["next"])) and "proposed" in one]
    if told:
        mean = sum(float(match[1]) for match, _ in told) / len(told)
        lines.append(
            f"predicted in the mean {mean:.2f}, came true {sum(one['proposed'] for _, one in told)} of {len(told)}"
        )
    return lines


def main(argv: Sequence[str] | None = None) -> int:
    """Run what has no result, then sum up."""
    parser = argparse.ArgumentParser(prog="python -m benchmark blind.experiment", description=__doc__)
    parser.add_argument("--out", type=Path, required=True, help="folder of the results")
    parser.add_argument("--seed", type=int, default=5000, help="of the sessions (5000)")
    parser.add_argument("--only", default="", help="part of a case's name")
    arguments = parser.parse_args(argv)
    results = []
    for case in cases(arguments.seed):
        if arguments.only in case.name:
            path = arguments.out / f"{case.name}.json"
            if not path.is_file():
                write_json(path, run_case(case, arguments.out / case.name))
            results.append(load_json(path))
            print(results[-1], file=sys.stderr, flush=True)
    print("\n".join(summary(results)))
    return 0


if __name__ == "__main__":
    sys.exit(main())
