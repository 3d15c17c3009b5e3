"""What a fault is: a scenario with parameters and a time, which acts on measurements, frames or the cable.

Its times are those of the device since its very first power-on: a clock that restarts or steps does not move them.
A fault that is not at work leaves everything as it is, to the bit.
"""

from collections.abc import Iterator
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, ValidationInfo, field_validator
from pydantic_core import PydanticCustomError

from firmware_sim.measure import Block
from firmware_sim.pty import Cable
from firmware_sim.wire.encoder import Frame
from firmware_sim.yaml_file import Checked

Rng = np.random.Generator
Seconds = Annotated[float, Field(ge=0.0, le=1e9)]


class Fault(Checked, Cable):
    """Base of all faults; by itself it changes nothing, neither what is sent nor the cable.

    from_s
        When it begins, s since power-on.
    """

    fault: ClassVar[str]
    from_s: Seconds = 2.0

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """The measurements that are taken."""
        return blocks

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """The frames that leave."""
        _ = rng
        return frames


class Lasting(Fault):
    """Base of the faults that end again.

    to_s
        When it ends, s since power-on; for ever where nothing is said.
    """

    to_s: Annotated[float | None, Field(ge=0.0, le=1e9)] = None

    @field_validator("to_s")
    @classmethod
    def _end_comes_after_the_beginning(cls, to_s: float | None, others: ValidationInfo) -> float | None:
        from_s = others.data.get("from_s", 0.0)
        if to_s is not None and to_s <= from_s:
            raise PydanticCustomError("window", "Expected more than from_s, which is {from_s}", {"from_s": from_s})
        return to_s

    @property
    def end_s(self) -> float:
        """When it ends, s; infinite where it does not."""
        return float("inf") if self.to_s is None else self.to_s

    def is_on(self, t_s: float) -> bool:
        """Whether it is at work at `t_s`."""
        return self.from_s <= t_s < self.end_s

    def is_on_at(self, block: Block) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Whether it is at work, for each measurement of a block."""
        on: np.ndarray[tuple[int], np.dtype[np.bool_]] = (block.t_host_s >= self.from_s) & (block.t_host_s < self.end_s)
        return on
