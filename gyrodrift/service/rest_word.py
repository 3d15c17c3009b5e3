"""Rest as stated by `ctl rest`; it replaces the statement of the device for all later samples."""

from dataclasses import dataclass
from math import isnan, nan

from gyrodrift.values.sample import Sample


@dataclass(slots=True)
class RestWord:
    """1 for rest, 0 for motion, NaN for no statement."""

    still: float = nan

    def with_rest(self, samples: list[Sample]) -> list[Sample]:
        """Samples with the stated rest."""
        still = self.still
        return samples if isnan(still) else [sample._replace(still=still) for sample in samples]
