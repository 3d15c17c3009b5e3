"""For MicroPython: `main.py` on a board that is not there, with an MPU-6050 on its I2C.

The chip is that of RM-MPU-6000A 4.2. Time passes while the program idles, sleeps and speaks with the chip; the clock
begins a second before its 30 bits end. `asked.json` says how long, and how the chip is plugged in. What the chip
measured is written to `truth.json` beside the frames: t_us, then counts: yaw rate, temperature, accelerations.
"""

import json
import sys

with open("/asked.json") as request:  # noqa: PTH123 - it has no pathlib
    REQUEST = json.load(request)

TICKS = 1 << 30
IDLE_US, I2C_BYTE_US = 100, 25


class OverError(Exception):
    """The board was switched off."""


class Chip:
    """Registers, and what becomes of them with time."""

    def __init__(self) -> None:
        self.now_us = 0
        self.next_us = 0
        self.truth: list = []
        self.on_rise = None
        self.reset()

    def reset(self) -> None:
        self.registers = bytearray(256)
        self.registers[0x6B] = 0x40
        self.registers[0x75] = 0x68

    def pass_time(self, us: int) -> None:
        self.now_us += us
        if self.now_us > REQUEST["seconds"] * 1_000_000:
            raise OverError
        while self.next_us <= self.now_us:
            self._measure()

    def _measure(self) -> None:
        is_asleep = self.registers[0x6B] & 0x40 or not self.registers[0x38] & 1
        if is_asleep or self.registers[0x1A] & 7 in (0, 7):
            self.next_us += 1000
            return
        rate = (len(self.truth) * 37) % 65536 - 32768
        temp = len(self.truth) % 20000 - 12000
        self._put(0x41, temp)
        accels = [(len(self.truth) * step) % 8192 - 4096 for step in (11, 13, 17)]
        for position, value in ((0x43, 111), (0x45, -222), (0x47, rate)):
            self._put(position, value)
        for index, value in enumerate(accels):
            self._put(0x3B + 2 * index, value)
        self.truth.append([self.next_us, rate, temp] + accels)  # noqa: RUF005 - MicroPython has no stars in a list
        now_us, self.now_us = self.now_us, self.next_us
        if self.on_rise is not None and REQUEST["pin"]:
            self.on_rise(None)
        self.now_us = now_us
        self.next_us += 1000 * (1 + self.registers[0x19])

    def _put(self, index: int, value: int) -> None:
        self.registers[index] = value >> 8 & 0xFF
        self.registers[index + 1] = value & 0xFF


CHIP = Chip()


class Pin:
    IN, IRQ_RISING = 0, 1

    def __init__(self, *_: int) -> None:
        pass

    def irq(self, handler: object, _trigger: int, **_: bool) -> None:
        CHIP.on_rise = handler


class I2C:
    """At 400 kHz a byte takes 25 us, with all that belongs to it."""

    def __init__(self, *_: int, **__: object) -> None:
        pass

    def readfrom_mem_into(self, address: int, register: int, into: bytearray) -> None:
        self._speak(address, 3)
        into[:] = CHIP.registers[register : register + len(into)]
        CHIP.pass_time(len(into) * I2C_BYTE_US)

    def readfrom_mem(self, address: int, register: int, count: int) -> bytearray:
        into = bytearray(count)
        self.readfrom_mem_into(address, register, into)
        return into

    def writeto_mem(self, address: int, register: int, values: bytes) -> None:
        self._speak(address, 2 + len(values))
        CHIP.registers[register] = values[0]
        if register == 0x6B and values[0] & 0x80:
            CHIP.reset()

    def _speak(self, address: int, count: int) -> None:
        CHIP.pass_time(count * I2C_BYTE_US)
        if address != 0x68 or CHIP.now_us < REQUEST["absent"] * 1_000_000:
            raise OSError(5)


class Machine:
    Pin, I2C = Pin, I2C

    @staticmethod
    def idle() -> None:
        CHIP.pass_time(IDLE_US)


class Time:
    @staticmethod
    def ticks_us() -> int:
        return (TICKS - 1_000_000 + CHIP.now_us) % TICKS

    @staticmethod
    def ticks_ms() -> int:
        return CHIP.now_us // 1000

    @staticmethod
    def sleep_ms(ms: int) -> None:
        CHIP.pass_time(ms * 1000)

    @staticmethod
    def ticks_add(ticks: int, further: int) -> int:
        return (ticks + further) % TICKS

    @staticmethod
    def ticks_diff(end: int, start: int) -> int:
        return (end - start + TICKS // 2) % TICKS - TICKS // 2


sys.modules["machine"] = Machine
sys.modules["time"] = Time

import main  # noqa: E402 - the board has to be there first

main.AXIS, main.IS_UPSIDE_DOWN = REQUEST["up"]
main.FILTER = REQUEST["filter"]
try:
    main.main()
except OverError:
    sys.stdout.write("\n" + json.dumps(CHIP.truth))
