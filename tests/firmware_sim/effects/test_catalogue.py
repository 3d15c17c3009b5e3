"""The catalogue: the 27 effects of the contract, each with its stage, its sizes and a word on what is typical."""

import pytest

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect, Place

STAGES = {
    "sensor": "scale_factor scale_asymmetry nonlinearity deadband saturation quantization bandwidth latency "
    "bias_instability rate_random_walk popcorn spikes vibration vibration_rectification g_sensitivity",
    "environment": "temp_bias temp_scale warmup",
    "platform": "backlash",
    "encoder": "encoder_eccentricity encoder_slip encoder_quantization",
    "clock": "clock_drift timestamp_jitter",
    "link": "usb_batching sample_drop stale_hold",
}
"""Section 7 of the contract, typed out."""


def test_the_catalogue_is_that_of_the_contract() -> None:
    """No effect is missing, none is called otherwise, and each belongs to its stage."""
    stages: dict[str, set[str]] = {}
    for name, kind in CATALOGUE.items():
        stages.setdefault(kind.stage, set()).add(name)
    assert stages == {stage: set(names.split()) for stage, names in STAGES.items()}
    assert len(CATALOGUE) == 27


@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_every_effect_says_what_is_typical(kind: type[Effect]) -> None:
    """Its docstring has a sentence on usual sizes, and it knows where it acts."""
    assert kind.__doc__ is not None
    assert "Typical" in kind.__doc__
    assert isinstance(kind.place, Place)


@pytest.mark.parametrize("size", ["small", "typical"])
@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_every_size_is_within_bounds_and_states_every_parameter(kind: type[Effect], size: str) -> None:
    """A rig takes both sizes as they are, and nothing in them is left to a default."""
    values = getattr(kind, size)
    assert set(values) == set(kind.model_fields) - {"name"}
    assert kind.model_validate(values).model_dump() == {"name": kind.model_fields["name"].default, **values}


@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_typical_is_not_small(kind: type[Effect]) -> None:
    """The two sizes differ."""
    assert kind.small != kind.typical
