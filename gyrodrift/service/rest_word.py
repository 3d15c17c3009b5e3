"""What `ctl rest` has said of rest: of all samples from then on, in place of what the device says itself."""

from dataclasses import dataclass
from math import isnan, nan

from gyrodrift.sample import Sample


@dataclass(slots=True)
class RestWord:
    """1 while the device is said to stand still, 0 while it is said to move; NaN while nobody says."""

    still: float = nan

    def told(self, samples: list[Sample]) -> list[Sample]:
        """Samples with what was said of them."""
        still = self.still
        return samples if isnan(still) else [Sample(*sample[:-1], still) for sample in samples]
