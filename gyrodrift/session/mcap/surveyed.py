"""What a survey of a session file found: stretches that are whole, and what is missing between them."""

from dataclasses import dataclass

from gyrodrift.arrays import Floats
from gyrodrift.session.damage import LostSamples, RecordingDamage, timed
from gyrodrift.session.mcap.checksums import Table
from gyrodrift.session.mcap.walk import ByteStretch


@dataclass(frozen=True, slots=True)
class PlacedTable:
    """A table and where it stands now."""

    at: int
    table: Table

    @property
    def shift(self) -> int:
        """How far it stands behind where it was written."""
        return self.at - self.table.region.stop


@dataclass(frozen=True, slots=True)
class Survey:
    """What is left of a file.

    stretches
        Whole records, in the order in which they were written.
    lost
        Samples that are not in them, in their order.
    unheard
        Where records that are no samples are lost: how many samples come before.
    remarks
        What is damaged beside the samples.
    is_ours
        Whether the file has tables of checksums, which gyrodrift alone writes.
    is_sure
        Whether the stretches are known to be as they were written.
    bad_tail_bytes
        Bytes at the end of an interrupted recording that are no records, nor what a kill or a power cut leaves.
    last_table
        The last table of checksums, where the end of the file did not make looking for them needless.
    """

    stretches: tuple[ByteStretch, ...]
    lost: tuple[LostSamples, ...] = ()
    unheard: tuple[int, ...] = ()
    remarks: tuple[str, ...] = ()
    is_ours: bool = False
    is_sure: bool = True
    last_table: PlacedTable | None = None
    bad_tail_bytes: int = 0

    @property
    def is_damaged(self) -> bool:
        """Whether anything is not as it was written; an interrupted recording is not damaged."""
        return self.is_hit or bool(self.bad_tail_bytes)

    @property
    def is_hit(self) -> bool:
        """Whether damage is anywhere but behind the last record."""
        return bool(self.lost or self.remarks) or not self.is_sure

    def kept_before(self, number: int) -> int:
        """How many samples are left of the first `number` of the recording."""
        return number - sum(min(each.count or 0, max(0, number - each.first)) for each in self.lost)

    def damage(self, t_device_s: Floats) -> RecordingDamage | None:
        """What to tell, by the device times of the samples that are left, shape (n,)."""
        if not self.is_damaged:
            return None
        bad_tail = [f"its last {self.bad_tail_bytes} bytes are no records"] if self.bad_tail_bytes else []
        return RecordingDamage(timed(self.lost, t_device_s), len(t_device_s), (*self.remarks, *bad_tail), self.is_sure)
