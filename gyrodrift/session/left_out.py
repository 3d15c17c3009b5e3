"""Contents of a recording that another format cannot hold."""

from collections import Counter
from pathlib import Path

from mcap.opcode import Opcode

from gyrodrift.session.foreign.channels import ForeignFile, chosen_topic, contents_of
from gyrodrift.session.foreign.records import ForeignRecord, records
from gyrodrift.session.mcap.layout import AIDS, EVENTS, READS, SAMPLES, STILLS
from gyrodrift.session.mcap.walk import PlacedRecord, SampleRows, Walk
from gyrodrift.session.session import TABLE, Session
from gyrodrift.values.words import counted

OWN_CHANNELS = {READS.name: "read of raw bytes", EVENTS.name: "link event"}
COMMENTED = (".csv", ".tsv", ".txt", ".log")
IMU_REST, AIDS_LEFT_OUT = "orientation", "measurements of second sources"


def left_out(source: Path, session: Session, topic: str | None, form: str, *, holds_aids: bool = True) -> list[str]:
    """Contents of a recording that are left out, in words.

    Parameters
    ----------
    source, session, topic
        File, session read from it, and the chosen channel.
    form
        `csv`, or the message type of an .mcap file: `sample`, `imu` or `json`.
    holds_aids
        Whether a table of this ending has a column of text for second sources.
    """
    columns = {
        "encoder angle": session.encoder_deg,
        "temperature": session.temp_c,
        "rest flag": session.still,
        "counter": session.seq,
        "yaw of the device's own filter": session.device_yaw_deg,
    }
    names = [name for name, column in columns.items() if form == "imu" and column is not None]
    names += [AIDS_LEFT_OUT] if session.aids and (form == "imu" or not holds_aids) else []
    if session.damage is not None:
        names.append("damaged parts")
    names += (
        _other_channels(source, session, topic)
        if source.suffix == ".mcap"
        else _comments(source)
        if source.suffix.lower() in COMMENTED
        else []
    )
    kept = [name for name in session.metadata if name != TABLE]
    if form == "csv" and kept:
        names.append(f"metadata ({', '.join(kept)})")
    return names


def _comments(source: Path) -> list[str]:
    with source.open("rb") as file:
        lines = sum(line.startswith(b"#") for line in file)
    return [counted(lines, "comment line")] if lines else []


def _other_channels(source: Path, session: Session, topic: str | None) -> list[str]:
    """Contents of other channels, and the other quantities of an Imu message."""
    if session.damage is not None:  # its contents are unknown
        return []
    contents = _contents(source)
    channels = sorted(contents.channels.values(), key=lambda channel: channel.topic)
    read = chosen_topic(source, channels, topic)
    names = [IMU_REST] if any(channel.is_imu for channel in channels if channel.topic == read) else []
    for channel in channels:
        if channel.topic in OWN_CHANNELS:
            names.append(counted(channel.count, OWN_CHANNELS[channel.topic]))
        elif channel.topic not in {read, STILLS.name, AIDS.name}:
            names.append(f"{counted(channel.count, 'message')} on {channel.topic}")
    return [*names, counted(contents.attachments, "attachment")] if contents.attachments else names


def _contents(source: Path) -> ForeignFile:
    """Channels and attachments of a file; samples of this program are counted in blocks."""
    counts: Counter[int] = Counter()
    declared: list[ForeignRecord] = []
    with source.open("rb") as file:
        walk = Walk(file)
        for step in walk:
            match step:
                case SampleRows(rows=rows):
                    counts[SAMPLES.channel_id] += len(rows)
                case PlacedRecord(opcode=Opcode.CHUNK):
                    return contents_of(records(file))
                case PlacedRecord(opcode=Opcode.DATA_END):
                    break
                case PlacedRecord(opcode=Opcode.MESSAGE):
                    counts[int.from_bytes(walk.body(step)[:2], "little")] += 1
                case PlacedRecord():
                    declared.append(ForeignRecord(step.opcode, walk.body(step), is_whole=True))
    return contents_of(declared, counts)
