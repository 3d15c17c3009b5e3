"""Base of faults: a scenario with parameters and a time, which acts on measurements, frames or the cable.

Times count from the first power-on; a clock that restarts or steps does not move them. An inactive fault changes
no bit.
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
    """Base of all faults; it changes nothing.

    from_s
        Beginning, s since power-on.
    """

    fault: ClassVar[str]
    from_s: Seconds = 2.0

    def on_blocks(self, blocks: Iterator[Block]) -> Iterator[Block]:
        """Measurements with this fault."""
        return blocks

    def on_frames(self, frames: Iterator[Frame], rng: Rng) -> Iterator[Frame]:
        """Frames with this fault."""
        _ = rng
        return frames


class Lasting(Fault):
    """Base of faults with an end.

    to_s
        End, s since power-on; None for never.
    """

    to_s: Annotated[float | None, Field(ge=0.0, le=1e9)] = None

    @field_validator("to_s")
    @classmethod
    def _end_comes_after_the_beginning(cls, to_s: float | None, info: ValidationInfo) -> float | None:
        from_s = info.data.get("from_s", 0.0)
        if to_s is not None and to_s <= from_s:
            raise PydanticCustomError("window", "Expected more than from_s, which is {from_s}", {"from_s": from_s})
        return to_s

    @property
    def end_s(self) -> float:
        """End, s; infinite without one."""
        return float("inf") if self.to_s is None else self.to_s

    def is_on(self, t_s: float) -> bool:
        """Whether it is active at `t_s`."""
        return self.from_s <= t_s < self.end_s

    def is_on_at(self, block: Block) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
        """Whether it is active, for every measurement of a block."""
        on: np.ndarray[tuple[int], np.dtype[np.bool_]] = (block.t_host_s >= self.from_s) & (block.t_host_s < self.end_s)
        return on
