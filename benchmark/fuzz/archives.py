"""Changes of files whose checksums stay right: records of MCAP, whole or in chunks, and members of zip archives."""

import struct
import zipfile
from binascii import crc32
from collections.abc import Iterator
from io import BytesIO
from random import Random
from typing import NamedTuple

import lz4.frame
import zstandard

MAGIC = b"\x89MCAP0\r\n"
HEAD = struct.Struct("<BQ")
CHUNK_HEAD = struct.Struct("<QQQII")
"""Of a chunk: first and last time, length and CRC of its records, length of the name of the compression."""

DAMAGE, MOST_DAMAGES = struct.Struct("<BHHB"), 8
"""Of the target `damage`: kind, place, length and byte of one change."""

CHUNK, DATA_END = 0x06, 0x0F
LONGEST_CHUNK = 1 << 20
EDGE_BYTES = (b"\xff" * 8, b"\0" * 8, b"\xff\xff\xff\xff\0\0\0\0", b"\1\0\0\0", struct.pack("<d", float("nan")))


class Record(NamedTuple):
    """A record of MCAP: its opcode and what follows its head."""

    opcode: int
    body: bytes


def changed_recording(content: bytes, random: Random) -> bytes:
    """One of the records changed, doubled, lost, cut or moved; checksums of chunks and data are right, mostly."""
    records = list(_records(content[len(MAGIC) :]))
    if not records:
        return content
    place = random.randrange(len(records))
    match random.randrange(8):
        case 0:
            del records[place]
        case 1:
            records.insert(place, random.choice(records))
        case 2:
            records[place] = records[place]._replace(opcode=random.choice((1, 3, 4, 5, 6, 7, 12, 15, 0, 255)))
        case _:
            records[place] = _changed_record(records[place], random)
    made = MAGIC + b"".join(_written(_with_crc(records, random))) + MAGIC
    return made[: random.randint(0, len(made))] if not random.randrange(8) else made


def _records(content: bytes) -> Iterator[Record]:
    at = 0
    while at + HEAD.size <= len(content):
        opcode, length = HEAD.unpack_from(content, at)
        if not opcode or at + HEAD.size + length > len(content):
            return
        yield Record(opcode, content[at + HEAD.size : at + HEAD.size + length])
        at += HEAD.size + length


def _written(records: list[Record]) -> Iterator[bytes]:
    return (HEAD.pack(record.opcode, len(record.body)) + record.body for record in records)


def _with_crc(records: list[Record], random: Random) -> list[Record]:
    """The data section ends with the CRC of what stands before; sometimes with none, or a wrong one."""
    end = next((place for place, record in enumerate(records) if record.opcode == DATA_END), None)
    if end is None:
        return records
    data = MAGIC + b"".join(_written(records[:end]))
    crc = random.choice((crc32(data), crc32(data), 0, 1))
    return [*records[:end], Record(DATA_END, struct.pack("<I", crc)), *records[end + 1 :]]


def _changed_record(record: Record, random: Random) -> Record:
    if record.opcode == CHUNK and random.randrange(4):
        return Record(CHUNK, _changed_chunk(record.body, random))
    return record._replace(body=_changed_body(record.body, random))


def _changed_body(body: bytes, random: Random) -> bytes:
    """Some bytes, a length or a number at the edge of what it can be."""
    made, at = bytearray(body), random.randint(0, len(body))
    match random.randrange(4):
        case 0:
            edge = random.choice(EDGE_BYTES)
            made[at : at + len(edge)] = edge
        case 1:
            del made[at : at + random.randint(1, 40)]
        case 2:
            made[at:at] = random.randbytes(random.randint(1, 9))
        case _ if made:
            made[at % len(made)] ^= 1 << random.randrange(8)
    return bytes(made)


def _changed_chunk(body: bytes, random: Random) -> bytes:
    """A chunk in which one of the records is changed, compressed in any way; its CRC is right, mostly."""
    try:
        begin_ns, end_ns, records = _unpacked(body)
    except (ValueError, RuntimeError, zstandard.ZstdError, struct.error, MemoryError):
        return _changed_body(body, random)
    inside = list(_records(records))
    if inside:
        place = random.randrange(len(inside))
        inside[place] = inside[place]._replace(body=_changed_body(inside[place].body, random))
    plain = b"".join(_written(inside))
    packed, name = random.choice(
        ((plain, b""), (lz4.frame.compress(plain), b"lz4"), (zstandard.compress(plain), b"zstd"))
    )
    crc = random.choice((crc32(plain), crc32(plain), 0, 1))
    length = random.choice((len(plain), len(plain), len(plain), 0, 1 << 60))
    head = CHUNK_HEAD.pack(begin_ns, end_ns, length, crc, len(name))
    return head + name + struct.pack("<Q", len(packed)) + packed


def _unpacked(body: bytes) -> tuple[int, int, bytes]:
    begin_ns, end_ns, length, _, name_length = CHUNK_HEAD.unpack_from(body)
    at = CHUNK_HEAD.size + name_length
    name, packed = body[CHUNK_HEAD.size : at], body[at + 8 :]
    if length > LONGEST_CHUNK:
        raise ValueError("a chunk too long to be changed")
    if name == b"lz4":
        return begin_ns, end_ns, lz4.frame.decompress(packed)
    if name == b"zstd":
        return begin_ns, end_ns, zstandard.decompress(packed, max_output_size=LONGEST_CHUNK)
    return begin_ns, end_ns, packed


def changed_changes(content: bytes, random: Random) -> bytes:
    """One more change of the recording that the target `damage` has, or one less."""
    changes = [content[at : at + DAMAGE.size] for at in range(0, len(content), DAMAGE.size)][:MOST_DAMAGES]
    if changes and random.randrange(3) == 0:
        del changes[random.randrange(len(changes))]
    length = random.choice((1, 4, 83, 83, 512, 4096))
    changes.append(DAMAGE.pack(random.randrange(6), random.getrandbits(16), length, random.choice((0, 255, 1, 5, 10))))
    return b"".join(changes)


def changed_archive(content: bytes, random: Random) -> bytes:
    """One of the members of a zip archive changed, lost or under another name; their checksums are right."""
    try:
        with zipfile.ZipFile(BytesIO(content)) as archive:
            members = {name: archive.read(name)[:LONGEST_CHUNK] for name in archive.namelist()}
    except Exception:  # noqa: BLE001 - of a damaged archive zipfile says anything
        return content
    if members:
        name = random.choice(list(members))
        body = members.pop(name)
        if random.randrange(6):
            members[random.choice((name, name, name, "x/cube.npy", "identity.npy"))] = _changed_body(body, random)
    made = BytesIO()
    with zipfile.ZipFile(made, "w", random.choice((zipfile.ZIP_STORED, zipfile.ZIP_DEFLATED))) as archive:
        for each, body in members.items():
            archive.writestr(each, body)
    return made.getvalue()
