"""Survey of a session file: whole stretches, and the losses between them."""

from dataclasses import dataclass

from gyrodrift.session.damage import LostSamples, RecordingDamage, timed
from gyrodrift.session.mcap.checksums import Table
from gyrodrift.session.mcap.walk import ByteStretch
from gyrodrift.values.arrays import Floats


@dataclass(frozen=True, slots=True)
class PlacedTable:
    """A table with its present offset."""

    offset: int
    table: Table

    @property
    def shift(self) -> int:
        """Present offset minus the offset when it was written, bytes."""
        return self.offset - self.table.region.stop


@dataclass(frozen=True, slots=True)
class Survey:
    """Survey of a file.

    stretches
        Stretches of whole records, in the order of writing.
    lost
        Lost samples in order.
    record_losses
        Numbers of samples before each loss of other records.
    remarks
        Other damage, a phrase each.
    is_ours
        Whether the file has checksum tables, which only gyrodrift writes.
    is_sure
        Whether checksums prove the stretches.
    bad_tail_bytes
        Bytes at the end of an interrupted recording that are no records and not the result of a kill or a power cut.
    last_table
        Last checksum table; None if the end of the file already proves all bytes.
    """

    stretches: tuple[ByteStretch, ...]
    lost: tuple[LostSamples, ...] = ()
    record_losses: tuple[int, ...] = ()
    remarks: tuple[str, ...] = ()
    is_ours: bool = False
    is_sure: bool = True
    last_table: PlacedTable | None = None
    bad_tail_bytes: int = 0

    @property
    def is_damaged(self) -> bool:
        """Whether any byte is damaged; an interrupted recording is not."""
        return self.has_inner_damage or bool(self.bad_tail_bytes)

    @property
    def has_inner_damage(self) -> bool:
        """Whether there is damage before the end of the last record."""
        return bool(self.lost or self.remarks) or not self.is_sure

    def kept_before(self, number: int) -> int:
        """Number of whole samples among the first `number` samples of the recording."""
        return number - sum(min(loss.count or 0, max(0, number - loss.first)) for loss in self.lost)

    def damage(self, t_device_s: Floats) -> RecordingDamage | None:
        """Damage with times, from the device times of the whole samples, shape (n,); None without damage."""
        if not self.is_damaged:
            return None
        bad_tail = [f"its last {self.bad_tail_bytes} bytes are no records"] if self.bad_tail_bytes else []
        is_proved = self.is_sure and not self.bad_tail_bytes  # the last table may have been among these bytes
        return RecordingDamage(timed(self.lost, t_device_s), len(t_device_s), (*self.remarks, *bad_tail), is_proved)
