"""Progress of long work: bars on a terminal, nothing in a pipe."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Self, TextIO, TypeVar

from gyrodrift.io.terminal import is_screen

if TYPE_CHECKING:
    from rich.progress import Progress as Bars
    from rich.progress import Task, TaskID
    from rich.text import Text

OnProgress = Callable[[str, int, int], None]
"""Called with the name of a stage, how much of it is done, and its total, which is 0 if unknown."""

TOTAL, PERCENT = "total", 100.0
"""Name of the stage that stands for all stages."""

COMPILING = "compiling, only once on this machine"
"""Stage in which filters are compiled; the compiled code is kept for later runs."""

EVERY = 2000
"""Items from one report to the next, if items are many and quick."""

WINDOW_S = 120.0
"""The time left is estimated from the speed over this time, s: chosen."""

Item = TypeVar("Item")


def ignore_progress(_stage: str, _done: int, _total: int) -> None:
    """Ignore progress."""


def counted(
    stage: str, items: Iterable[Item], total: int, progress: OnProgress, size: Callable[[Item], int]
) -> Iterator[Item]:
    """Yield the items and report their progress; `size` is the share of an item in the total."""
    done = reported = 0
    progress(stage, 0, total)
    for item in items:
        yield item
        done += size(item)
        if done - reported >= EVERY:
            progress(stage, done, total)
            reported = done
    progress(stage, total, total)


class Progress:
    """One bar for each stage; the bars vanish at the end.

    The time left is shown for a command of one stage, or for the total. A stage of several does not show it: the
    later stages would be missing from it.

    Parameters
    ----------
    stream
        Stream of the bars; nothing is drawn if it is not a terminal.
    is_quiet
        Draw nothing on a terminal either.
    shares
        Share of each stage in the duration, in the order of the stages, for a bar of the total. Empty for stages
        whose shares are unknown; None for a command of one stage.
    """

    def __init__(self, stream: TextIO, shares: Mapping[str, float] | None = None, *, is_quiet: bool = False) -> None:
        self._bars = None if is_quiet or not is_screen(stream) else _bars(stream)
        self._tasks: dict[str, TaskID] = {}
        self._has_one_stage = shares is None
        self._shares = dict(shares or {})
        self._whole = sum(self._shares.values())

    def __enter__(self) -> Self:
        if self._bars is not None:
            if self._shares:
                self._add(TOTAL, PERCENT)
            self._bars.start()
        return self

    def __exit__(self, *_: object) -> None:
        if self._bars is not None:
            self._bars.stop()

    def report(self, stage: str, done: int, total: int) -> None:
        """Report the progress of a stage; `total` is 0 if unknown."""
        if self._bars is None:
            return
        if stage == TOTAL:
            self._update_total(PERCENT * done / total if total else 0.0)
            return
        if stage not in self._tasks:
            self._end_other_stages()
            self._add(stage, total or None)
        count = f"{done}/{total}" if total else ""
        self._bars.update(self._tasks[stage], completed=done, total=total or None, count=count)
        if stage in self._shares:
            self._update_total(self._percent_of_total(stage, done / total if total else 0.0))

    @contextmanager
    def paused(self) -> Iterator[None]:
        """Hide the bars while something is printed."""
        if self._bars is not None:
            self._bars.stop()
        yield
        if self._bars is not None:
            self._bars.start()

    def _add(self, stage: str, total: float | None) -> None:
        assert self._bars is not None  # noqa: S101 - checked by the callers
        has_time_left = self._has_one_stage or stage == TOTAL
        self._tasks[stage] = self._bars.add_task(stage, total=total, count="", has_time_left=has_time_left)

    def _end_other_stages(self) -> None:
        """Complete the stages so far, as another one begins."""
        assert self._bars is not None  # noqa: S101 - checked by the callers
        for task in self._bars.tasks:
            if task.description != TOTAL:
                total = int(task.total or 1)
                count = f"{total}/{total}" if task.total else ""
                self._bars.update(task.id, total=total, completed=total, count=count)

    def _percent_of_total(self, stage: str, share: float) -> float:
        """All stages before this one are complete."""
        names = list(self._shares)
        before = sum(self._shares[name] for name in names[: names.index(stage)])
        return PERCENT * (before + share * self._shares[stage]) / self._whole

    def _update_total(self, percent: float) -> None:
        assert self._bars is not None  # noqa: S101 - checked by the callers
        if TOTAL not in self._tasks:
            self._add(TOTAL, PERCENT)
        self._bars.update(self._tasks[TOTAL], completed=percent, count=f"{percent:.0f} %")


def _bars(stream: TextIO) -> "Bars":
    """Bars that leave stdout alone: it may be a file or a pipe.

    Only the thread of the bars draws. Ctrl-C interrupts the main thread. If that thread were drawing, it would leave
    rows on the screen that are not counted, and they would stay there.
    """
    from rich.console import Console  # noqa: PLC0415 - imported only for a terminal
    from rich.progress import (  # noqa: PLC0415
        BarColumn,
        Progress,
        TextColumn,
        TimeElapsedColumn,
        TimeRemainingColumn,
    )
    from rich.text import Text  # noqa: PLC0415

    class DrawnByItsThread(Progress):
        def refresh(self) -> None:
            """Leave the drawing to the thread, which draws ten times a second."""

    class TimeLeft(TimeRemainingColumn):
        def render(self, task: "Task") -> "Text":
            """Time left of an unfinished task with a known total, if it shows it."""
            is_shown = task.fields["has_time_left"] and task.total is not None and not task.finished
            return Text.assemble("left ", super().render(task)) if is_shown else Text()

    columns = (TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[count]}"), TimeElapsedColumn())
    return DrawnByItsThread(
        *columns,
        TimeLeft(),
        console=Console(file=stream, force_terminal=True),
        transient=True,
        redirect_stdout=False,
        speed_estimate_period=WINDOW_S,
    )
