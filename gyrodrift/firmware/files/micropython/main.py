"""Gyro on I2C for gyrodrift: sends rates, accelerations and temperature in the native protocol.

The data-ready pin of the sensor starts an interrupt, which reads the clock. So traffic on I2C or the serial line does
not shift sample times. `seq` counts missed measurements, too. A sample allocates no memory, because garbage collection
would take as long as a sample.
"""

import sys
import time
from array import array

import machine
from gyro_sensors import BURST_BYTES, SENSORS, GyroSensor
from gyrodrift_native import (
    ACCEL_CLIPPED,
    ACCEL_VALID,
    AXES,
    FILTER_HDR,
    FILTER_RESTLEVEL,
    RATE_CLIPPED,
    TEMPERATURE_VALID,
    FrameWriter,
)

# Settings of your robot.
I2C_ID, SDA_PIN, SCL_PIN, DATA_READY_PIN = (0, 4, 5, 6) if sys.platform == "rp2" else (0, 21, 22, 19)  # Pico, ESP32
AXIS = 2  # axis that points up: 0 x, 1 y, 2 z; it is sent as z
IS_UPSIDE_DOWN = False  # True if it points down
FILTER = ""  # "restlevel" or "hdr": the board filters, too, and sends that yaw beside each sample

I2C_HZ = 400_000
RESET_MS = 100  # of the MPU-6050, the slowest
HELLO_MS = 1000
NO_SIGMA = float("nan")
SILENCE_MS = 300  # after this silence the sensor is set up again: it lost its settings or its cable


def new_filter(name: str) -> object:
    """Filter of the board; None for an empty name."""
    if name == "restlevel":
        from gyrodrift_restlevel import Restlevel

        return Restlevel()
    if name == "hdr":
        from gyrodrift_hdr import Hdr

        return Hdr()
    return None


class Gyro:
    """Reads the sensor, with its interrupt, and writes frames."""

    def __init__(self, out: object) -> None:
        self._out = out
        self._filter = new_filter(FILTER)
        self._writer = FrameWriter()
        self._burst = bytearray(BURST_BYTES)
        self._axes = array("h", [0] * (2 * AXES))  # rates, then accelerations
        self._sensor = None
        self._address = 0
        self._quiet_starts = 0  # starts of the sensor since its last measurement
        self._ready_seq = self._ready_us = 0
        self._seq = 0  # of the last measurement read
        self._last_us = time.ticks_us()
        self._t_us = [0, 0]  # device clock in two halves, the low half first
        self._hello_ms = self._sample_ms = time.ticks_ms()
        self._i2c = machine.I2C(I2C_ID, sda=machine.Pin(SDA_PIN), scl=machine.Pin(SCL_PIN), freq=I2C_HZ)
        pin = machine.Pin(DATA_READY_PIN, machine.Pin.IN)
        try:
            pin.irq(self._on_data_ready, machine.Pin.IRQ_RISING, hard=True)
        except TypeError:  # MicroPython port without hard interrupts
            pin.irq(self._on_data_ready, machine.Pin.IRQ_RISING)
        self._find_sensor()

    def step(self) -> None:
        """Send HELLO and the sample that are due, restart a silent sensor, then wait for an interrupt."""
        now_ms = time.ticks_ms()
        if time.ticks_diff(now_ms, self._hello_ms) >= HELLO_MS:
            self._hello_ms = time.ticks_add(self._hello_ms, HELLO_MS)
            self._send_hello()
        if self._sensor is not None:
            self._take_sample()
        if time.ticks_diff(time.ticks_ms(), self._sample_ms) >= SILENCE_MS:
            self._find_sensor()
        machine.idle()

    def _on_data_ready(self, _pin: machine.Pin) -> None:
        self._ready_us = time.ticks_us()
        self._ready_seq = self._ready_seq + 1 & 0xFFFF

    def _take_sample(self) -> None:
        seq = self._ready_seq
        ready_us = self._ready_us
        if seq == self._seq:
            return
        self._seq = seq
        try:
            self._i2c.readfrom_mem_into(self._address, self._sensor.burst_reg, self._burst)
        except OSError:
            return
        if self._ready_seq != seq:  # overtaken by the next measurement: rate and time may not match
            return
        if self._quiet_starts > 2:
            self._quiet_starts = 0
            self._send_hello()
        self._quiet_starts = 0
        self._send_sample(ready_us)
        self._sample_ms = time.ticks_ms()

    def _send_sample(self, ready_us: int) -> None:
        sensor, flags = self._sensor, TEMPERATURE_VALID | ACCEL_VALID
        if self._read_axes(sensor.rates_at, 0):
            flags |= RATE_CLIPPED
        if self._read_axes(sensor.accels_at, AXES):
            flags |= ACCEL_CLIPPED
        factor, divisor, centi_c_at_zero = sensor.centi_c
        centi_c = (self._value_at(sensor.temp_at) * factor + divisor // 2) // divisor + centi_c_at_zero
        self._let_time_pass(ready_us)
        self._out.write(self._writer.sample3(flags, self._seq, self._t_us, self._axes, centi_c))
        if self._filter is not None:
            self._send_yaw(ready_us)

    def _send_yaw(self, ready_us: int) -> None:
        chosen = self._filter
        chosen.update_us(ready_us, self._axes[2] * self._sensor.dps_per_lsb)
        sigma_deg = chosen.yaw_sigma_deg if FILTER == "restlevel" else NO_SIGMA
        self._out.write(self._writer.yaw(self._seq, self._t_us, chosen.yaw_deg, sigma_deg, chosen.bias_dps))

    def _read_axes(self, index: int, slot: int) -> bool:
        """Read x, y and z into the frame whose z axis points up; True if one is at the end of its range.

        AXIS becomes z by a cyclic exchange. Upside down is half a turn about x. Both keep the frame right-handed.
        """
        is_clipped = False
        for axis in range(AXES):
            value = self._value_at(index + 2 * ((AXIS + 1 + axis) % AXES))
            if value in (32767, -32768):
                is_clipped = True
            if IS_UPSIDE_DOWN and axis:
                value = min(-value, 32767)
            self._axes[slot + axis] = value
        return is_clipped

    def _let_time_pass(self, ready_us: int) -> None:
        """Advance the 32-bit clock of the protocol; the clock of the board has 30 bits."""
        low = self._t_us[0] + time.ticks_diff(ready_us, self._last_us)
        self._last_us = ready_us
        self._t_us[0] = low & 0xFFFF
        self._t_us[1] = self._t_us[1] + (low >> 16) & 0xFFFF

    def _value_at(self, index: int) -> int:
        first, second = self._burst[index], self._burst[index + 1]
        value = first << 8 | second if self._sensor.is_big_endian else second << 8 | first
        return value - 0x10000 if value & 0x8000 else value

    def _name(self) -> str:
        """Sensor name, or the wiring fault that the log of gyrodrift then shows."""
        if self._sensor is None:
            return "no gyro on I2C"
        return "INT pin is quiet" if self._quiet_starts > 2 else self._sensor.id

    def _send_hello(self) -> None:
        sensor = self._sensor
        rate_hz, dps_per_lsb, mps2_per_lsb = 0, 1.0, 0.0
        if sensor is not None:
            rate_hz, dps_per_lsb, mps2_per_lsb = sensor.sample_rate_hz, sensor.dps_per_lsb, sensor.mps2_per_lsb
        if self._filter is None:
            self._out.write(self._writer.hello3(rate_hz, dps_per_lsb, 0, self._name(), mps2_per_lsb))
            return
        number = FILTER_RESTLEVEL if FILTER == "restlevel" else FILTER_HDR
        fields = (rate_hz, dps_per_lsb, 0, self._name(), AXES, mps2_per_lsb, number)
        self._out.write(self._writer.hello_filter(*fields))

    def _find_sensor(self) -> None:
        self._sensor = None
        for sensor in SENSORS:
            for address in sensor.addresses:
                if self._sensor is None and self._is_started(sensor, address):
                    self._sensor, self._address = sensor, address
        self._quiet_starts += 1
        self._send_hello()  # before samples with a new scale
        self._sample_ms = time.ticks_ms()

    def _is_started(self, sensor: GyroSensor, address: int) -> bool:
        try:
            if self._i2c.readfrom_mem(address, sensor.who_reg, 1)[0] != sensor.who:
                return False
            for index, (register, value) in enumerate(sensor.writes):
                self._i2c.writeto_mem(address, register, bytes([value]))
                if index == 0:
                    time.sleep_ms(RESET_MS)
        except OSError:
            return False
        return True


def main() -> None:
    """Run until the board is switched off."""
    gyro = Gyro(sys.stdout.buffer)
    while True:
        gyro.step()


if __name__ == "__main__":
    main()
