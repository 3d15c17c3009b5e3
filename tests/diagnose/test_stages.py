"""Causes in the adopted rig, and remarks of recordings on the rig before a simulation."""

from dataclasses import replace

import numpy as np
import pytest
from inference_support import candidate

from firmware_sim.rig import Base, Rig, parse_effect
from gyrodrift.diagnose.inference.verdict import NamedCause
from gyrodrift.diagnose.recording.facts import Contradiction
from gyrodrift.diagnose.simulate.candidate import Candidate
from gyrodrift.diagnose.simulate.candidates import KINDS
from gyrodrift.diagnose.simulate.response_table import Sized
from gyrodrift.diagnose.stages import adopted, with_facts


def named(text: str, in_rig: str | None = None) -> NamedCause:
    """A cause, of an effect that a rig may have at another size."""
    effect = parse_effect(text)
    tried: Candidate = replace(
        candidate("latency"),
        name=effect.name,
        parameter=KINDS[effect.name].parameter,
        in_rig=parse_effect(in_rig) if in_rig else None,
    )
    return NamedCause(Sized(tried, 1.0), effect, "group", "", 0.9, 0.9, (), ())


def rig(*texts: str) -> Rig:
    return Rig(effects=tuple(map(parse_effect, texts)))


def test_what_is_new_comes_behind_what_the_rig_has() -> None:
    assert adopted(rig("temp_bias"), [named("latency:delay_ms=9")]) == rig("temp_bias", "latency:delay_ms=9")
    assert adopted(rig("temp_bias"), []) == rig("temp_bias")


def test_a_wrong_size_is_replaced_and_not_stacked() -> None:
    wrong = named("scale_factor:error_percent=0.4", in_rig="scale_factor:error_percent=1.2")
    result = adopted(rig("scale_factor:error_percent=1.2", "latency"), [wrong])
    assert result == rig("latency", "scale_factor:error_percent=0.4")


@pytest.mark.parametrize(
    ("remaining", "stood", "is_gone"),
    [
        ("scale_factor:error_percent=0.05", "scale_factor:error_percent=1.2", True),
        ("scale_factor:error_percent=-0.05", "scale_factor:error_percent=1.2", True),
        ("scale_factor:error_percent=0.2", "scale_factor:error_percent=1.2", False),
        ("latency:delay_ms=0.3", "latency:delay_ms=20", True),
        ("g_sensitivity:amplitude_dps=0", "g_sensitivity", True),
        # A low-pass of 4 Hz, a limit of 60 deg/s and 720 counts are more than 45 Hz, 2000 deg/s and 36,000 counts.
        ("bandwidth:cutoff_hz=4", "bandwidth:cutoff_hz=45", False),
        ("saturation:limit_dps=60", "saturation:limit_dps=2000", False),
        ("encoder_quantization:cpr=720", "encoder_quantization:cpr=36000", False),
    ],
)
def test_of_what_has_gone_nothing_stays(remaining: str, stood: str, is_gone: bool) -> None:  # noqa: FBT001 - parametrized
    assert adopted(rig(stood), [named(remaining, in_rig=stood)]) == (rig() if is_gone else rig(remaining))


def test_what_is_small_and_new_is_no_remainder() -> None:
    assert adopted(rig(), [named("latency:delay_ms=0.3")]) == rig("latency:delay_ms=0.3")


def contradiction(fact: str, sessions: float | None) -> Contradiction:
    return Contradiction(fact, 36_000.0, sessions, "", "")


def test_facts_of_the_sessions_take_the_place_of_the_rigs() -> None:
    """Counts as a whole number; what has no number, or is no entry of the rig, changes nothing."""
    result = with_facts(rig("latency"), [contradiction("encoder_cpr", 4096.2), contradiction("dps_per_lsb", 0.0305)])
    assert (result.base.encoder_cpr, result.base.dps_per_lsb) == (4096, 0.0305)
    assert result.effects == rig("latency").effects
    same = [contradiction("encoder_cpr", None), contradiction("range_dps", 900.0), contradiction("turn_ratio", 9000.0)]
    assert with_facts(rig(), same) == rig()
    assert isinstance(result.base, Base)
    assert np.isfinite(result.base.dps_per_lsb)
