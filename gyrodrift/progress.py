"""How far a tuning has come, on a terminal; nothing in a pipe."""

from types import TracebackType
from typing import Self, TextIO

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from rich.progress import Progress as Bars


class Progress:
    """A bar for each thing that is done, with the time that is left."""

    def __init__(self, stream: TextIO) -> None:
        console = Console(file=stream)
        columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
        self._bars = Bars(
            *columns, TextColumn("left"), TimeRemainingColumn(), console=console, disable=not console.is_terminal
        )
        self._tasks: dict[str, int] = {}

    def __enter__(self) -> Self:
        self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._bars.stop()

    def evaluated(self, what: str, done: int, of: int) -> None:
        """So many evaluations of a search are made, or sessions read."""
        if what not in self._tasks:
            self._tasks[what] = int(self._bars.add_task(what, total=of))
        self._bars.update(self._bars.task_ids[self._tasks[what]], completed=done)
