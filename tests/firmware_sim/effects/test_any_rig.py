"""Any rig at all: whatever effects come together at whatever size, the measurements hang together."""

from typing import Any

import numpy as np
import pytest
from annotated_types import Ge, Gt, Le
from effects_bench import Record, effect_of, profile_of, record, rig_of
from hypothesis import given
from hypothesis import strategies as st

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.effects.effect import Effect
from firmware_sim.measure import COUNTS_MAX
from firmware_sim.rig import Base, Rig

MOTION = profile_of(
    {"kind": "sine", "seconds": 0.5, "amplitude_dps": 120.0, "frequency_hz": 2.0},
    {"kind": "ramp", "seconds": 0.2, "to_dps": -90.0},
    {"kind": "hold", "seconds": 0.5},
    {"kind": "rest", "seconds": 0.3},
)
SAMPLES = 200


def bounds_of(metadata: list[Any]) -> tuple[float, float]:
    """The smallest and the largest number that a field of an effect takes."""
    (low,) = [mark.ge if isinstance(mark, Ge) else mark.gt for mark in metadata if isinstance(mark, Ge | Gt)]
    (high,) = [mark.le for mark in metadata if isinstance(mark, Le)]
    assert isinstance(low, int | float)
    assert isinstance(high, int | float)
    is_open = any(isinstance(mark, Gt) for mark in metadata)
    return float(np.nextafter(low, high)) if is_open else low, high


def parameters_of(kind: type[Effect]) -> dict[str, tuple[float, float]]:
    """Bounds by name."""
    return {name: bounds_of(field.metadata) for name, field in kind.model_fields.items() if name != "name"}


def any_of(kind: type[Effect]) -> st.SearchStrategy[Effect]:
    values: dict[str, st.SearchStrategy[Any]] = {}
    for name, (low, high) in parameters_of(kind).items():
        if kind.model_fields[name].annotation is int:
            values[name] = st.integers(int(low), int(high))
        else:  # what is just above zero has a test of its own
            values[name] = st.floats(1e-6 if 0.0 < low < 1e-6 else low, high)
    return st.builds(kind, **values)


effects = st.one_of([any_of(kind) for kind in CATALOGUE.values()])
bases = st.builds(
    Base,
    sample_rate_hz=st.floats(50.0, 1000.0),
    dps_per_lsb=st.floats(1e-4, 0.1),
    noise_dps_rthz=st.floats(1e-4, 0.1),
    bias_dps=st.floats(-50.0, 50.0),
    encoder_cpr=st.integers(0, 100_000),
    encoder_absolute=st.booleans(),
    encoder_phase_deg=st.floats(-360.0, 360.0),
    host_delay_s=st.floats(0.0, 1.0),
    host_jitter_s=st.floats(0.0, 0.1),
)
rigs = st.builds(Rig, base=bases, effects=st.lists(effects, max_size=8).map(tuple))


def played(rig: Rig, seed: int = 0, block_samples: int = 64) -> Record:
    return record(rig, MOTION, SAMPLES / rig.base.sample_rate_hz, seed, block_samples)


def arrays(run: Record) -> list[np.ndarray[Any, Any]]:
    return [getattr(run, name) for name in run.__slots__]


@pytest.mark.parametrize("end", [0, 1], ids=["smallest", "largest"])
@pytest.mark.parametrize("kind", CATALOGUE.values(), ids=list(CATALOGUE))
def test_every_effect_runs_at_both_ends_of_its_bounds(kind: type[Effect], end: int) -> None:
    """The smallest and the largest parameters that a rig file may state give numbers."""
    effect = kind.model_validate({name: bounds[end] for name, bounds in parameters_of(kind).items()})
    assert all(np.isfinite(array).all() for array in arrays(played(rig_of(effect))))


@given(rigs)
def test_every_number_is_one_and_within_its_range(rig: Rig) -> None:
    run = played(rig)
    assert all(np.isfinite(array).all() for array in arrays(run))
    assert (np.abs(run.rate_dps) <= COUNTS_MAX * rig.base.dps_per_lsb * (1.0 + 1e-12)).all()


@given(rigs)
def test_counter_and_device_clock_rise(rig: Rig) -> None:
    run = played(rig)
    for array in (run.seq, run.t_device_us):
        assert (np.diff(array, prepend=-1) > 0).all()


@given(rigs)
def test_nothing_arrives_before_it_was_measured_or_out_of_order(rig: Rig) -> None:
    """The host has a sample after its delay at the earliest, and after the sample before it or with it."""
    run = played(rig)
    assert (run.t_host_s >= run.t_s + rig.base.host_delay_s - 1e-9).all()
    assert (np.diff(run.t_host_s) >= 0.0).all()


@given(rigs, st.integers(0, 2**40))
def test_the_same_seed_gives_the_same_bytes_for_any_rig(rig: Rig, seed: int) -> None:
    """Two runs agree in every bit."""
    item, second = played(rig, seed), played(rig, seed)
    assert [array.tobytes() for array in arrays(item)] == [array.tobytes() for array in arrays(second)]


@given(rigs, st.integers(1, 2 * SAMPLES))
def test_the_size_of_the_blocks_makes_no_difference_to_any_rig(rig: Rig, block_samples: int) -> None:
    """A float may round otherwise, and so a clock may differ by a microsecond; the rest of clock and link may not."""
    item, second = played(rig), played(rig, block_samples=block_samples)
    assert item.seq.tolist() == second.seq.tolist()
    assert item.t_host_s.tolist() == second.t_host_s.tolist()
    np.testing.assert_allclose(item.encoder_deg, second.encoder_deg, atol=1e-9)
    np.testing.assert_allclose(item.t_device_us, second.t_device_us, atol=1.01)
    assert np.mean(np.abs(item.rate_dps - second.rate_dps) > 1.01 * rig.base.dps_per_lsb) < 0.01


@given(st.lists(effects, max_size=6, unique_by=lambda effect: effect.name), st.randoms())
def test_the_order_of_a_rig_file_makes_no_difference(listed: list[Effect], random: Any) -> None:
    """Effects act in the order of the catalogue, however they are listed."""
    shuffled = random.sample(listed, len(listed))
    item, second = (played(rig_of(*effects)) for effects in (listed, shuffled))
    assert [array.tobytes() for array in arrays(item)] == [array.tobytes() for array in arrays(second)]


REST = [effect_of(name) for name in CATALOGUE]


def ids_of(effect: Effect) -> str:
    return effect.name


def spike_places(peer: Effect | None) -> set[int]:
    """Numbers of the samples at which spikes make a difference to a rig with another effect."""
    spikes = CATALOGUE["spikes"].model_validate({"height_dps": 50.0, "share_percent": 5.0})
    with_them, without = (record(rig_of(peer, extra), MOTION, 10.0) for extra in (spikes, None))
    return set(with_them.seq[np.abs(with_them.rate_dps - without.rate_dps) > 25.0].tolist())


@pytest.mark.parametrize("peer", [e for e in REST if e.name not in {"spikes", "stale_hold"}], ids=ids_of)
def test_spikes_come_at_the_same_samples_beside_any_other_effect(peer: Effect) -> None:
    """Switching one effect on leaves the realisation of another as it was; only what got lost is missing."""
    arrived = set(record(rig_of(peer), MOTION, 10.0).seq.tolist())
    alone = spike_places(None)
    assert len(alone) > 20
    assert spike_places(peer) == alone & arrived


@pytest.mark.parametrize("peer", [e for e in REST if e.name != "sample_drop"], ids=ids_of)
def test_the_same_samples_are_lost_beside_any_other_effect(peer: Effect) -> None:
    alone, next_to = (record(rig_of(effect_of("sample_drop"), extra), MOTION, 10.0) for extra in (None, peer))
    assert alone.seq.size < 1000
    assert alone.seq.tolist() == next_to.seq.tolist()


@pytest.mark.parametrize("peer", [e for e in REST if e.name not in {"timestamp_jitter", "clock_drift"}], ids=ids_of)
def test_stamps_scatter_the_same_beside_any_other_effect(peer: Effect) -> None:
    """Every sample that arrives has the stamp that it has without the other effect."""
    alone, next_to = (record(rig_of(effect_of("timestamp_jitter"), extra), MOTION, 10.0) for extra in (None, peer))
    assert next_to.t_device_us.tolist() == alone.t_device_us[next_to.seq].tolist()


@pytest.mark.parametrize("name", ["popcorn", "rate_random_walk", "bias_instability"])
@pytest.mark.parametrize("peer", ["spikes", "sample_drop", "popcorn", "rate_random_walk", "bias_instability"])
def test_a_bias_goes_its_way_beside_any_other_effect(name: str, peer: str) -> None:
    if name == peer:
        return
    bare, item, two, pair = (
        record(rig_of(*map(effect_of, names)), MOTION, 100.0) for names in ([], [name], [peer], [name, peer])
    )
    index = pair.seq
    next_to = pair.rate_dps - two.rate_dps
    assert np.abs(next_to - (item.rate_dps - bare.rate_dps)[index]).max() <= 2.01 * 0.00763


@pytest.mark.parametrize("name", ["popcorn", "rate_random_walk", "bias_instability", "spikes", "vibration"])
def test_the_same_effect_twice_is_another_realisation_each_time(name: str) -> None:
    """Two of a kind are not one of double size."""
    bare, item, two = (record(rig_of(*[effect_of(name)] * times), MOTION, 100.0).rate_dps for times in (0, 1, 2))
    assert np.abs((two - bare) - 2.0 * (item - bare)).max() > 0.01
