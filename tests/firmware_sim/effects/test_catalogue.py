"""The catalogue: every effect has its stage, its sizes and a word on what is typical; 28 are promised to users."""

import pytest

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect, EffectSlot

STAGES = {
    "sensor": "scale_factor misalignment scale_asymmetry nonlinearity deadband saturation quantization bandwidth "
    "latency bias_instability rate_random_walk popcorn spikes vibration vibration_rectification g_sensitivity",
    "environment": "temp_bias temp_scale warmup",
    "platform": "backlash",
    "encoder": "encoder_eccentricity encoder_slip encoder_quantization",
    "clock": "clock_drift timestamp_jitter",
    "link": "usb_batching sample_drop stale_hold",
}
"""Names that rig files and gap.json are promised to know, typed out."""


def test_the_promised_effects_are_there() -> None:
    promised = {name: stage for stage, names in STAGES.items() for name in names.split()}
    assert len(promised) == 28
    assert {name: CATALOGUE[name].stage for name in promised} == promised
    assert {kind.stage for kind in CATALOGUE.values()} <= set(STAGES)


@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_every_effect_says_what_is_typical(kind: type[Effect]) -> None:
    assert kind.__doc__ is not None
    assert "Typical" in kind.__doc__
    assert isinstance(kind.slot, EffectSlot)


@pytest.mark.parametrize("size", ["small", "typical"])
@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_every_size_is_within_bounds_and_states_every_parameter(kind: type[Effect], size: str) -> None:
    """A rig takes both sizes as they are, and nothing in them is left to a default."""
    values = getattr(kind, size)
    assert set(values) == set(kind.model_fields) - {"name"}
    assert kind.model_validate(values).model_dump() == {"name": kind.model_fields["name"].default, **values}


@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_typical_is_not_small(kind: type[Effect]) -> None:
    assert kind.small != kind.typical
