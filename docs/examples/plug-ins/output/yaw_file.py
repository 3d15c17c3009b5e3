"""Output `yaw_file:path=FILE`: the newest yaw in a file, for a program that reads files."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from gyrodrift.outputs.options import About
from gyrodrift.outputs.output import Output, OutputError
from gyrodrift.sample import Corrected

GYRODRIFT_API = 1


@dataclass(frozen=True, slots=True)
class YawFileOptions:
    """File to write."""

    path: Annotated[str, About("file that gets the newest yaw")] = "yaw.txt"


class YawFile(Output[YawFileOptions]):
    """The newest yaw in a file."""

    options_type = YawFileOptions

    async def open(self) -> None:
        """Name the file as the address."""
        self.address = self.options.path

    def take(self, samples: Sequence[Corrected]) -> None:
        """Write the newest of the samples."""
        try:
            Path(self.options.path).write_text(f"{samples[-1].yaw_deg:.3f}\n", encoding="ascii")
        except OSError as error:
            raise OutputError(f"{self.options.path}: {error.strerror}") from error
