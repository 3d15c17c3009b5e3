"""Units as people write them."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from gyrodrift.columns.spec import columns_of
from gyrodrift.columns.units import SPELLINGS, Dimension, unit_in, unit_of


@pytest.mark.parametrize(
    ("text", "dimension", "option"),
    [
        *[(text, "rate", "dps") for text in ("deg/s", "°/s", "º/s", "dps", "DPS", "degrees/sec", "degrees per second")],
        *[(text, "rate", "rads") for text in ("rad/s", "rads", "radians/s", "rad/sec", "rad*s^-1", "Rad / s")],
        *[(text, "rate", "mdps") for text in ("mdps", "mdeg/s", "m°/s")],
        ("mrad/s", "rate", "mrads"),
        ("deg/min", "rate", "lsb/60"),
        ("°/h", "rate", "lsb/3600"),
        ("rpm", "rate", "lsb/0.166667"),
        ("°", "angle", "deg"),
        ("Degrees", "angle", "deg"),
        ("rad", "angle", "rad"),
        *[(text, "acceleration", "mps2") for text in ("m/s^2", "m/s²", "m/s2", "m/s/s", "m/s**2")],
        ("g", "acceleration", "g"),
        ("mg", "acceleration", "mg"),
        ("mG", "magnetic field", ""),
        ("µT", "magnetic field", ""),
        ("ms", "time", "t_ms"),
        ("µs", "time", "t_us"),
        ("seconds", "time", "t_s"),
        ("Hz", "frequency", ""),
        ("°C", "temperature", ""),
        ("LSB", "counts", ""),
    ],
)
def test_spellings_of_a_unit_are_understood(text: str, dimension: str, option: str) -> None:
    unit = unit_of(text)
    assert unit is not None
    assert (unit.dimension, unit.option) == (dimension, option)


@pytest.mark.parametrize("text", ["", "x", "z", "gz", "heading", "G", "1", "rad/s/s/s", "deg/s" * 20])
def test_other_words_are_no_unit(text: str) -> None:
    assert unit_of(text) is None


@pytest.mark.parametrize(
    ("label", "option"),
    [
        ("Gyroscope z (rad/s)", "rads"),
        ("gyro_z [deg/s]", "dps"),
        ("gyro_z_rad_s", "rads"),
        ("angular_velocity_deg_per_s", "dps"),
        ("wz_dps", "dps"),
        ("Time (s)", "t_s"),
        ("time_us", "t_us"),
        ("t_s", "t_s"),
        ("accel_x_m_s2", "mps2"),
        ("acc x (mg)", "mg"),
        ("roll [deg]", "deg"),
    ],
)
def test_a_label_names_its_unit(label: str, option: str) -> None:
    unit = unit_in(label)
    assert unit is not None
    assert unit.option == option


@pytest.mark.parametrize("label", ["gz", "gyro z", "Gyro Z", "a_g", "gyro_x", "t", "omega_s", "rate", ""])
def test_an_axis_or_a_name_is_no_unit(label: str) -> None:
    assert unit_in(label) is None


def test_every_unit_of_a_rate_can_be_written_in_a_spec() -> None:
    meanings = {Dimension.RATE: "rate", Dimension.ANGLE: "yaw", Dimension.ACCELERATION: "rate, ax"}
    for unit in SPELLINGS.values():
        if unit.dimension in meanings:
            assert columns_of(f"{meanings[unit.dimension]}:{unit.option}")[-1].unit == unit.option


@given(st.text(max_size=200))
def test_any_text_is_a_unit_or_none(text: str) -> None:
    assert unit_in(text) in {None, *SPELLINGS.values(), unit_of("mG")}
