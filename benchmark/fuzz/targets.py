"""What is fuzzed: each target takes any bytes, and raises where something other than an error of ours comes of them."""

import shutil
import struct
from collections.abc import Callable
from contextlib import suppress
from math import isfinite, isinf, isnan
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from firmware_sim.motion.profile import load_profile
from firmware_sim.rig import load_rig, parse_effect
from firmware_sim.yaml_file import FileError
from fuzz.client_targets import clients, sockets
from fuzz.damage_target import check_damage
from fuzz.source_target import source_decoders
from gyrodrift.columns.guess import guess
from gyrodrift.columns.spec import columns_of
from gyrodrift.config.model import load_config
from gyrodrift.config.outputs import output_of
from gyrodrift.filters.registry import FILTERS
from gyrodrift.link.clocks.arrival import ArrivalClock
from gyrodrift.link.clocks.device import DeviceClock
from gyrodrift.link.protocols.detect import Detector
from gyrodrift.link.protocols.registry import PROTOCOLS
from gyrodrift.link.text_decoder import TextDecoder
from gyrodrift.service.memory_file import MemoryDamagedError, read_memory
from gyrodrift.session.files import load_session
from gyrodrift.session.mcap.raw import read_raw
from gyrodrift.session.mcap.repair import repair
from gyrodrift.simulation.published_set import read_rows
from gyrodrift.tune.search.journal import Journal
from gyrodrift.values.errors import GyrodriftError
from gyrodrift.values.sample import Reading

Target = Callable[[bytes], None]

LONGEST_MESSAGE = 45_000
"""Characters of what is said of anything."""

CHUNK = 61
SPECS = ("t_ms, _, rate", "t_us, rate:rads:-, encoder, temp", "gyro.z=rate, time=t_s", "_, _, _, rate:lsb/131")
MOST_TEXT = 1 << 14
"""Bytes of lines that are read by each of the SPECS."""

READING = struct.Struct("<IHfBf")

_FOLDER = TemporaryDirectory(prefix="gyrodrift-fuzz-")
FOLDER = Path(_FOLDER.name)


def decoders(content: bytes) -> None:
    """The bytes of a device, in one piece and in many: the same readings, of finite numbers or none."""
    for protocol in [each for each in PROTOCOLS.values() if each.is_detected]:
        whole, cut = protocol.decoder(), protocol.decoder()
        at_once = whole.push(content)
        in_pieces = [each for at in range(0, len(content), CHUNK) for each in cut.push(content[at : at + CHUNK])]
        assert repr(at_once) == repr(in_pieces)
        assert whole.counters == cut.counters
        check_readings(at_once)


def check_readings(readings: list[Reading]) -> None:
    """What every decoder promises of a reading."""
    for reading in readings:
        assert reading.t_us is None or 0 <= reading.t_us < 1 << 32
        assert reading.seq is None or 0 <= reading.seq < 1 << 16
        for value in (reading.encoder_deg, reading.temp_c):
            assert isfinite(value) or isnan(value)
        if reading.inertial is not None:
            assert repr(reading.inertial.gyro_z_dps) == repr(reading.rate_dps)
            assert not any(map(isinf, reading.inertial))


def detector(content: bytes) -> None:
    """Which protocol it is, as bytes come."""
    found = Detector([each for each in PROTOCOLS.values() if each.is_detected])
    for at in range(0, len(content), CHUNK):
        if found.push(content[at : at + CHUNK]) is not None:
            return


def text(content: bytes) -> None:
    """Lines of other people's text: read by columns that are known, and looked at to propose some."""
    content = content[:MOST_TEXT]
    for spec in SPECS:
        check_readings(TextDecoder(columns_of(spec)).push(content))
    guessed = guess(content.decode(errors="replace").split("\n"), 100.0)
    if guessed is not None and guessed.spec is not None:
        TextDecoder(columns_of(guessed.spec)).push(content)


def columns(content: bytes) -> None:
    """What `--columns` and `--output` are given, and what `--effect` is."""
    words = content.decode(errors="replace")
    told(lambda: columns_of(words))
    told(lambda: output_of(words))
    told(lambda: parse_effect(words))


def clocks(content: bytes) -> None:
    """Readings of any clock and counter: samples with finite times; every filter takes them, or passes them by."""
    fields = [READING.unpack_from(content, at) for at in range(0, len(content) - READING.size + 1, READING.size)]
    for clock, has_clock in ((DeviceClock(1.7e9), True), (ArrivalClock(1.7e9), False)):
        arrival_s = 100.0
        states = [(known, known.coefficients(known.params()), known.state()) for known in FILTERS.values()]
        for t_us, seq, rate_dps, late, _ in fields:
            arrival_s += late * 1e-3
            reading = Reading(t_us if has_clock else None, seq if has_clock and late % 2 else None, rate_dps)
            for sample in clock.stamp([reading], arrival_s):
                assert isfinite(sample.t_device_s)
                for known, c, state in states:
                    known.step(c, state, sample.t_device_s, sample.rate_dps)
                    assert isfinite(state.yaw_deg)


def config(content: bytes) -> None:
    """The file that `serve` watches."""
    told(lambda: load_config(written("c.yaml", content)))


def rig(content: bytes) -> None:
    """A rig, and a profile of motion."""
    path = written("r.yaml", content)
    told(lambda: load_rig(path))
    told(lambda: load_profile(str(path)))


def mcap(content: bytes) -> None:
    """A session, ours or of others: its samples, its raw bytes, and its end where it has none."""
    path = written("s.mcap", content)
    told(lambda: load_session(path))
    told(lambda: sum(len(read.content) for read in read_raw(path)))
    told(lambda: load_session(path, allow_damage=True))
    told(lambda: repair(path))
    told(lambda: load_session(path))
    for other in FOLDER.glob("s.mcap?*"):
        other.unlink()


def damage(content: bytes) -> None:
    """A recording of ours of which some bytes are changed: nothing is read that was not written."""
    FOLDER.mkdir(exist_ok=True)
    check_damage(FOLDER, content)


def csv(content: bytes) -> None:
    """A session as people have them, and a table of published ones."""
    path = written("s.csv", content)
    told(lambda: load_session(path))
    told(lambda: load_session(path, columns_of(SPECS[len(content) % len(SPECS)])))
    told(lambda: read_rows(path))


def journal(content: bytes) -> None:
    """What `tune --resume` goes on from."""
    path = written("j.npz", content)
    told(lambda: Journal(path, "fuzz", is_resumed=True))


def memory(content: bytes) -> None:
    """What `serve --memory` begins with."""
    path = written("m.json", content)
    try:
        found = read_memory(path)
    except MemoryDamagedError as error:
        assert 0 < len(str(error)) < LONGEST_MESSAGE  # noqa: PT017 - likewise
        return
    known = FILTERS["restlevel"]
    assert found is not None
    assert known.memory is not None
    with suppress(ValueError):  # is told, and the memory is begun anew
        state = known.memory.begun(known.params(), known.memory.read(found.knowledge), found.age_s(2e9), 25.0)
        for index in range(100):
            known.step(known.coefficients(known.params()), state, 0.01 * index, 0.1 * (index % 3))
        assert isfinite(state.yaw_deg)


def told(act: Callable[[], Any]) -> None:
    """It goes well, or ends with an error of ours in a message that a person can read."""
    try:
        act()
    except (GyrodriftError, FileError) as error:
        assert 0 < len(str(error)) < LONGEST_MESSAGE  # noqa: PT017 - an error is one of two ways to go well


def written(name: str, content: bytes) -> Path:
    """A file of the process."""
    path = FOLDER / name
    path.write_bytes(content)
    return path


def forget() -> None:
    """Take the files away."""
    shutil.rmtree(FOLDER, ignore_errors=True)


TARGETS: dict[str, Target] = {
    each.__name__: each
    for each in (
        decoders,
        detector,
        text,
        columns,
        clocks,
        config,
        rig,
        mcap,
        damage,
        csv,
        journal,
        memory,
        clients,
        sockets,
        source_decoders,
    )
}
