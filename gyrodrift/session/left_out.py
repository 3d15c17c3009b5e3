"""What a recording holds that does not go along when it is written in another form."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from mcap.opcode import Opcode

from gyrodrift.session.foreign.channels import ForeignFile, chosen_topic, contents_of
from gyrodrift.session.foreign.records import ForeignRecord, records
from gyrodrift.session.mcap.layout import EVENTS, READS, SAMPLES, STILLS
from gyrodrift.session.mcap.walk import PlacedRecord, SampleRows, Walk
from gyrodrift.session.session import TABLE, Session

OWN_CHANNELS = {READS.name: "read of raw bytes", EVENTS.name: "link event"}
COMMENTED = (".csv", ".tsv", ".txt", ".log")
IMU_REST = "orientation, acceleration and rates about x and y"


def left_out(source: Path, session: Session, topic: str | None, form: str) -> list[str]:
    """What of a recording does not go along, in a person's words.

    Parameters
    ----------
    source, session, topic
        The file, what was read of it, and the channel that was asked for.
    form
        `csv`, or what the messages of an .mcap file are: `sample`, `imu` or `json`.
    """
    columns = {
        "encoder angle": session.encoder_deg,
        "temperature": session.temp_c,
        "word of rest": session.still,
        "counter": session.seq,
    }
    found = [name for name, column in columns.items() if form == "imu" and column is not None]
    if session.damage is not None:
        found.append("what is damaged")
    found += (
        _beside_samples(source, session, topic)
        if source.suffix == ".mcap"
        else _comments(source)
        if source.suffix.lower() in COMMENTED
        else []
    )
    kept = [name for name in session.metadata if name != TABLE]
    if form == "csv" and kept:
        found.append(f"metadata ({', '.join(kept)})")
    return found


def listed(names: Sequence[str]) -> str:
    """As a sentence has them: `a, b and c`."""
    return ", ".join(names[:-1]) + " and " * (len(names) > 1) + "".join(names[-1:])


def _comments(source: Path) -> list[str]:
    with source.open("rb") as file:
        lines = sum(line.startswith(b"#") for line in file)
    return [_counted(lines, "comment line")] if lines else []


def _beside_samples(source: Path, session: Session, topic: str | None) -> list[str]:
    """What stands on other channels, and what an Imu has beside its rate about z."""
    if session.damage is not None:  # what it holds is not known
        return []
    contents = _contents(source)
    channels = sorted(contents.channels.values(), key=lambda channel: channel.topic)
    read = chosen_topic(source, channels, topic)
    found = [IMU_REST] if any(channel.is_imu for channel in channels if channel.topic == read) else []
    for channel in channels:
        if channel.topic in OWN_CHANNELS:
            found.append(_counted(channel.count, OWN_CHANNELS[channel.topic]))
        elif channel.topic not in {read, STILLS.name}:
            found.append(f"{_counted(channel.count, 'message')} on {channel.topic}")
    return [*found, _counted(contents.attachments, "attachment")] if contents.attachments else found


def _contents(source: Path) -> ForeignFile:
    """What a file declares; samples of ours are counted a table at a time."""
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


def _counted(count: int, what: str) -> str:
    first, _, rest = what.partition(" ")
    if count == 1:
        return f"1 {what}"
    return f"{count} {first}s {rest}" if rest.startswith("of ") else f"{count} {what}s"
