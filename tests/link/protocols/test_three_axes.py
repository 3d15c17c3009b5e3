"""Three axes through every protocol that carries them, from the encoders of the device and from golden frames."""

from math import degrees, isnan, nan

import golden_frames as golden
import pytest

from firmware_sim.rig import Base
from firmware_sim.wire.csv import axes_csv_line
from firmware_sim.wire.encoder import Measurement, Vector
from firmware_sim.wire.registry import ENCODERS
from firmware_sim.wire.witmotion import wt901_frame
from gyrodrift.columns.shape import has_csv_shape
from gyrodrift.link.protocols.csv import CsvDecoder
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.protocols.text import text_protocol
from gyrodrift.link.protocols.vectornav_ascii import VectornavAsciiDecoder
from gyrodrift.link.protocols.witmotion import WitmotionDecoder
from gyrodrift.link.protocols.xsens import XsensDecoder
from gyrodrift.values.sample import Reading

GRAVITY_MPS2 = 9.80665
COLUMNS = "t_ms=t_ms, gx=gx:lsb/131, gy=gy:lsb/131, gz=rate:lsb/131, ax=ax:lsb/16384, ay=ay:lsb/16384, az=az:lsb/16384"
ALL_AXES = {
    "native": (0.0051, 0.0025),
    "csv": (1e-12, 1e-12),
    "witmotion": (0.031, 0.0025),
    "witmotion-ble": (0.031, 0.0025),
    "vectornav": (1e-5, 1e-5),
    "vectornav-ascii": (5e-5, 6e-4),
    "xsens": (1e-5, 1e-5),
    "text": (0.0039, 0.0004),
}
"""Half a step of rate, deg/s, and of acceleration, m/s², by protocol."""


def decoded(protocol: str, measurements: list[Measurement]) -> list[Reading]:
    base = Base(dps_per_lsb=0.01)
    stream = b"".join(frame.content for frame in ENCODERS[protocol].recorded(measurements, base))
    made = text_protocol(COLUMNS) if protocol == "text" else PROTOCOLS[protocol]
    return made.decoder().push(stream)


def measurements(forces_mps2: Vector | None) -> list[Measurement]:
    """A sensor that tilts and turns."""
    return [
        Measurement(
            0.01 * i, 10_000 * i, i, 0.3 * i, None, None, gyro_dps=(1.0 - 0.1 * i, 2.5, 0.3 * i), accel_mps2=forces_mps2
        )
        for i in range(60)
    ]


@pytest.mark.parametrize("protocol", ALL_AXES)
def test_a_protocol_carries_all_axes_in_their_order_and_sign(protocol: str) -> None:
    sent = measurements((1.5, -3.25, 9.0))
    readings = decoded(protocol, sent)
    step_dps, step_mps2 = ALL_AXES[protocol]
    assert len(readings) >= 55
    for m, reading in zip(sent[-len(readings) :], readings, strict=True):
        assert reading.inertial is not None
        assert reading.inertial[:3] == pytest.approx(m.gyro_dps, abs=step_dps)
        assert reading.inertial[3:] == pytest.approx(m.accel_mps2, abs=step_mps2)
        assert reading.rate_dps == reading.inertial.gyro_z_dps


@pytest.mark.parametrize("protocol", ["native", "csv", "witmotion", "vectornav", "xsens"])
def test_rates_go_on_where_acceleration_is_missing(protocol: str) -> None:
    for reading in decoded(protocol, measurements((nan, nan, nan))):
        assert reading.inertial is not None
        assert reading.inertial.gyro_y_dps == pytest.approx(2.5, abs=0.031)
        assert all(map(isnan, reading.inertial[3:]))


@pytest.mark.parametrize("protocol", ["native", "csv", "bno08x-rvc", "navx", "nmea"])
def test_a_single_axis_stays_one(protocol: str) -> None:
    sent = [Measurement(0.01 * i, 10_000 * i, i, 0.5 * i, None, None) for i in range(40)]
    readings = decoded(protocol, sent)
    assert readings
    assert all(reading.inertial is None for reading in readings)


def test_a_wt901_pairs_an_acceleration_with_the_rates_after_it() -> None:
    """An acceleration counts once; without a new one it is missing."""
    forces, rates = wt901_frame(0x51, 100, -200, 2048, 2500), wt901_frame(0x52, 16, -32, 64, 2500)
    readings = WitmotionDecoder().push(forces + rates + rates + forces + rates + rates)
    assert [reading.inertial is not None and isnan(reading.inertial.accel_z_mps2) for reading in readings] == [
        False,
        True,
        False,
        True,
    ]
    dps, mps2 = 2000.0 / 32768.0, 16.0 * GRAVITY_MPS2 / 32768.0
    expected = (16 * dps, -32 * dps, 64 * dps, 100 * mps2, -200 * mps2, 2048 * mps2)
    assert readings[0].inertial == pytest.approx(expected)


def test_the_z_axis_of_a_vectornav_points_down() -> None:
    """An example of its maker: y and z change their sign."""
    readings = VectornavAsciiDecoder().push(golden.VECTORNAV_VNYMR * 4)
    expected = (degrees(-0.000018), -degrees(0.001122), degrees(0.000551), -1.258, 0.100, 9.701)
    assert readings[-1].inertial == pytest.approx(expected)


def test_a_recorded_message_of_an_mti_300_has_all_axes() -> None:
    message = golden.XSENS_MTI300 + bytes((-sum(golden.XSENS_MTI300[1:]) & 0xFF,))
    (reading,) = XsensDecoder().push(message)
    assert reading.inertial is not None
    assert reading.inertial[3:] == pytest.approx((-0.05551, 9.81466, 0.21842), abs=1e-4)
    assert reading.inertial.gyro_z_dps == reading.rate_dps == pytest.approx(degrees(-0.00163019), rel=1e-5)


def lines(count: int, force_mps2: Vector, gyro_dps: Vector = (0.1, 0.2, 0.3)) -> bytes:
    return b"".join(axes_csv_line(10_000 * i, gyro_dps, force_mps2) for i in range(count))


def test_csv_has_encoder_temperature_and_rest_after_the_axes() -> None:
    line = axes_csv_line(7, (1.0, 2.0, 3.0), (0.5, nan, 9.75), 12.5, 21.25, 1.0)
    assert line == b"7,1.0,2.0,3.0,0.5,nan,9.75,12.5,21.25,1.0\r\n"
    reading = CsvDecoder().push(line * 3)[0]
    assert (reading.rate_dps, reading.encoder_deg, reading.temp_c, reading.still) == (3.0, 12.5, 21.25, 1.0)
    assert reading.inertial == pytest.approx((1.0, 2.0, 3.0, 0.5, nan, 9.75), nan_ok=True)


def test_csv_with_three_axes_is_detected_by_gravity() -> None:
    detector = Detector([protocol for protocol in PROTOCOLS.values() if protocol.is_detected])
    detected = detector.push(lines(30, (0.0, 0.1, 9.8)))
    assert detected is not None
    assert detected[0].name == "csv"


@pytest.mark.parametrize("force", [(0.0, 0.01, 1.0), (0.0, 10.0, 16384.0), (0.2, 0.1, 0.0), (0.0, 0.0, 0.0)])
def test_other_lines_of_seven_numbers_are_not_taken_for_csv(force: Vector) -> None:
    """Acceleration in g or in counts, or rates last, also of a gyro at rest: their columns are asked."""
    assert not has_csv_shape(CsvDecoder().push(lines(30, force)))


@pytest.mark.parametrize("force", [(nan, nan, nan), (0.1, nan, 9.8)])
def test_csv_is_detected_while_the_accelerometer_is_silent(force: Vector) -> None:
    """A stream begins with `nan` if its accelerometer starts late."""
    assert has_csv_shape(CsvDecoder().push(lines(30, force)))


@pytest.mark.parametrize("columns", [6, 11])
def test_a_line_with_a_wrong_number_of_axes_is_damaged(columns: int) -> None:
    decoder = CsvDecoder()
    decoder.push(b",".join([b"1"] * columns) + b"\n")
    assert decoder.counters.damaged == 1


def test_columns_of_text_give_axes_units_and_signs() -> None:
    """Rates in rad/s, accelerations in g, z down in the text."""
    made = text_protocol("t_ms, gx:rads, gy:rads:-, gz:rads:-, ax:g, ay:g:-, az:g:-, temp")
    readings = made.decoder().push(b"10,0.1,0.2,-0.3,0.5,0,-1,21\n20,0.1,0.2,-0.3,0.5,0,-1,21\n30,0.1,0,0,0,0,-1,21\n")
    expected = (degrees(0.1), -degrees(0.2), degrees(0.3), 0.5 * GRAVITY_MPS2, 0.0, GRAVITY_MPS2)
    assert readings[0].inertial == pytest.approx(expected)
    assert readings[0].rate_dps == pytest.approx(degrees(0.3))


def test_columns_without_acceleration_give_three_rates() -> None:
    readings = text_protocol("t_ms, gx, gy, gz").decoder().push(b"10,1,2,3\n20,1,2,3\n30,1,2,3\n")
    assert readings[0].inertial == pytest.approx((1.0, 2.0, 3.0, nan, nan, nan), nan_ok=True)
    assert text_protocol("t_ms, gx, _, gz").decoder().push(b"10,1,2,3\n20,1,2,3\n30,1,2,3\n")[0].inertial is None


def test_json_lines_give_axes_by_their_labels() -> None:
    columns = "ms=t_ms, gyro.x=gx, gyro.y=gy, gyro.z=rate, acc.x=ax:g, acc.y=ay:g, acc.z=az:g"
    line = b'{"ms":%d,"gyro":{"x":1,"y":2,"z":3},"acc":{"x":0,"y":0.5,"z":1}}\n'
    readings = text_protocol(columns).decoder().push(b"".join(line % (10 * i) for i in range(4)))
    assert readings[0].inertial == pytest.approx((1.0, 2.0, 3.0, 0.0, 0.5 * GRAVITY_MPS2, GRAVITY_MPS2))


def test_a_rate_that_no_gyro_has_damages_the_line_on_any_axis() -> None:
    decoder = text_protocol("t_ms, gx, gy, gz").decoder()
    decoder.push(b"10,1,2,3\n20,1,2,3\n30,1,2,3\n40,1,90000,3\n")
    assert decoder.counters.damaged == 1
