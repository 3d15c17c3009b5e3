"""A fault: one small change of one file, and the tests that must fail with it."""

from dataclasses import dataclass
from pathlib import Path


class FaultError(Exception):
    """A fault cannot be tried: its text is gone, or its tests cannot run."""


@dataclass(frozen=True, slots=True)
class Fault:
    """One deliberate fault.

    name
        `area/what`, unique.
    file
        Path from the root of the project.
    old, new
        The text that is replaced, which occurs exactly once in the file, and its replacement.
    breaks
        One sentence: what no longer holds.
    tests
        Paths or node ids of the tests that must fail.
    """

    name: str
    file: str
    old: str
    new: str
    breaks: str
    tests: tuple[str, ...]

    @property
    def area(self) -> str:
        """The part of the project that the fault belongs to."""
        return self.name.partition("/")[0]

    def applied_to(self, source: str) -> str:
        """The text of the file with the fault in it.

        Raises
        ------
        FaultError
            Where the old text does not occur exactly once.
        """
        count = source.count(self.old)
        if count != 1:
            raise FaultError(
                f"fault {self.name} does not apply any more: its text occurs {count} times in {self.file}; "
                "change the fault in benchmark/mutate/faults as the file has changed"
            )
        return source.replace(self.old, self.new)

    def check(self, root: Path) -> None:
        """Raise FaultError where the fault or its tests do not fit the project in `root`."""
        path = root / self.file
        if not path.is_file():
            raise FaultError(f"fault {self.name} does not apply any more: there is no {self.file}")
        self.applied_to(path.read_text())
        for test in self.tests:
            file, _, function = test.partition("::")
            if not (root / file).exists():
                raise FaultError(f"fault {self.name}: there is no {file}")
            if function and f"def {function.partition('[')[0]}(" not in (root / file).read_text():
                raise FaultError(f"fault {self.name}: there is no {function} in {file}")
