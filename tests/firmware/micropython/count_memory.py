"""For MicroPython: how many bytes of memory a thousand samples of `main.py` take, on a board that takes none itself."""

import gc
import sys

SAMPLES = 1000
WHO = b"\x68"


class Clock:
    """Five milliseconds a sample."""

    ms = 0

    def ticks_us(self) -> int:
        return self.ms * 1000

    def ticks_ms(self) -> int:
        return self.ms

    def ticks_add(self, ticks: int, further: int) -> int:
        return ticks + further

    def ticks_diff(self, end: int, start: int) -> int:
        return end - start

    def sleep_ms(self, ms: int) -> None:
        pass


class Pin:
    IN = IRQ_RISING = 0

    def __init__(self, *_: int) -> None:
        pass

    def irq(self, *_: object, **__: bool) -> None:
        pass


class I2C:
    def __init__(self, *_: int, **__: object) -> None:
        pass

    def readfrom_mem(self, _address: int, _register: int, _count: int) -> bytes:
        return WHO

    def readfrom_mem_into(self, _address: int, _register: int, into: bytearray) -> None:
        into[0] = into[6] = into[12] = CLOCK.ms & 0xFF

    def writeto_mem(self, _address: int, _register: int, _value: bytes) -> None:
        pass


class Machine:
    Pin, I2C = Pin, I2C

    @staticmethod
    def idle() -> None:
        CLOCK.ms += 5


class Out:
    sent = 0

    def write(self, frame: memoryview) -> None:
        if len(frame) == 30:
            self.sent += 1


CLOCK, OUT = Clock(), Out()
sys.modules["machine"] = Machine
sys.modules["time"] = CLOCK

import main  # noqa: E402 - the board has to be there first

gyro = main.Gyro(OUT)
main.HELLO_MS = 1 << 29  # HELLO may take some, once a second
used = 0
for measured in range(SAMPLES + 1):
    if measured == 1:
        gc.collect()
        gc.disable()
        used = gc.mem_alloc()
    gyro._on_data_ready(None)
    gyro.step()
sys.stdout.write(f"{OUT.sent} {gc.mem_alloc() - used}")
