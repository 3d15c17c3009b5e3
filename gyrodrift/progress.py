"""How far something that takes long has come, on a terminal; nothing in a pipe."""

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from types import TracebackType
from typing import TYPE_CHECKING, Self, TextIO, TypeVar

if TYPE_CHECKING:
    from rich.progress import Progress as Bars
    from rich.progress import TaskID

OnProgress = Callable[[str, int, int], None]
"""Told what is being done, how much of it is, and of how much; of 0 where nobody knows."""

ALL, PERCENT = "all of it", 100.0

EVERY = 2000
"""Items from one telling to the next, where they are many and quick."""

WINDOW_S = 120.0
"""Of the time that is left, how far back it is measured how fast things go."""

Item = TypeVar("Item")


def untold(_what: str, _done: int, _of: int) -> None:
    """Progress that nobody looks at."""


def counted(
    what: str, items: Iterable[Item], of: int, progress: OnProgress, size: Callable[[Item], int]
) -> Iterator[Item]:
    """The items as they are, told as they pass; `size` is how much of the whole one is."""
    done = told = 0
    progress(what, 0, of)
    for item in items:
        yield item
        done += size(item)
        if done - told >= EVERY:
            progress(what, done, of)
            told = done
    progress(what, of, of)


class Progress:
    """A bar for each thing that is done, with the time that is left; they are gone when all is done.

    Parameters
    ----------
    stream
        Where somebody may look on; nothing is written where it is no terminal.
    is_quiet
        Whether nothing is to be shown there either.
    shares
        What will be done, with its share of the time, for a bar of all of it.
    """

    def __init__(self, stream: TextIO, shares: Mapping[str, float] | None = None, *, is_quiet: bool = False) -> None:
        self._bars = None if is_quiet or not _is_for_eyes(stream) else _bars(stream)
        self._tasks: dict[str, TaskID] = {}
        self._shares = dict(shares or {})
        self._whole = sum(self._shares.values())

    def __enter__(self) -> Self:
        if self._bars is not None:
            if self._shares:
                self._tasks[ALL] = self._bars.add_task(ALL, total=PERCENT, count="")
            self._bars.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._bars is not None:
            self._bars.stop()

    def evaluated(self, what: str, done: int, of: int) -> None:
        """So many evaluations of a search are made, or sessions read; `of` 0 where nobody knows how many there are."""
        if self._bars is None:
            return
        if what not in self._tasks:
            self._end_others()
            self._tasks[what] = self._bars.add_task(what, total=of or None, count="")
        self._bars.update(self._tasks[what], completed=done, total=of or None, count=f"{done}/{of}" if of else "")
        if what in self._shares:
            self._tell_all(what, done / of if of else 0.0)

    @contextmanager
    def aside(self) -> Iterator[None]:
        """Room for what is printed meanwhile."""
        if self._bars is not None:
            self._bars.stop()
        yield
        if self._bars is not None:
            self._bars.start()

    def _end_others(self) -> None:
        """What was done before is over when something else begins."""
        assert self._bars is not None  # noqa: S101 - asked before
        for task in self._bars.tasks:
            if task.description != ALL:
                of = int(task.total or 1)
                self._bars.update(task.id, total=of, completed=of, count=f"{of}/{of}" if task.total else "")

    def _tell_all(self, what: str, share: float) -> None:
        """Everything that stands before this is done, since the shares are in their order."""
        assert self._bars is not None  # noqa: S101 - asked before
        before = 0.0
        for name, each in self._shares.items():
            if name == what:
                break
            before += each
        done = PERCENT * (before + share * self._shares[what]) / self._whole
        self._bars.update(self._tasks[ALL], completed=done, count=f"{done:.0f} %")


def _is_for_eyes(stream: TextIO) -> bool:
    return stream.isatty() and os.environ.get("TERM") != "dumb"


def _bars(stream: TextIO) -> "Bars":
    """Nothing that is written to stdout passes through them: it may go elsewhere.

    While they are shown only their own thread draws. Ctrl-C reaches the main thread; one that was at drawing
    would leave rows that are on the screen and not counted, and they would stay there.
    """
    from rich.console import Console  # noqa: PLC0415 - costs only who sees it
    from rich.progress import (  # noqa: PLC0415
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )

    class DrawnByItsThread(Progress):
        def refresh(self) -> None:
            """A task more is seen with the next of the thread's rounds, a tenth of a second later at most."""

    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[count]}"), TimeElapsedColumn())
    return DrawnByItsThread(
        *columns,
        TextColumn("left"),
        TimeRemainingColumn(),
        console=Console(file=stream, force_terminal=True),
        transient=True,
        redirect_stdout=False,
        speed_estimate_period=WINDOW_S,
    )
