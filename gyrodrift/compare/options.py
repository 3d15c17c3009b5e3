"""A comparison as the command and the library ask for it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from gyrodrift.compare.comparison import ComparisonRequest, config_file
from gyrodrift.compare.methods.registry import methods
from gyrodrift.filters.filter import FilterParams
from gyrodrift.io.progress import OnProgress
from gyrodrift.session.checks.given import AS_GIVEN, InputOptions, check_count, check_seeds
from gyrodrift.session.files import session_paths


@dataclass(frozen=True, slots=True)
class CompareOptions:
    """Options of a comparison.

    paths, train, stills
        Sessions or folders: to compare on, to tune every method on, and those in which the device did not move.
    config, blocks
        Config, None for the defaults; and its parameters by filter.
    iterations, seed
        Evaluations and seed of the search for each method.
    jobs
        Processes.

    Raises
    ------
    UsageError
        If a number is out of range.
    """

    paths: Sequence[Path]
    train: Sequence[Path] = ()
    stills: Sequence[Path] = ()
    config: Path | None = None
    blocks: Mapping[str, FilterParams] = field(default_factory=dict)
    iterations: int = 3000
    seed: int = 0
    jobs: int = 1
    inputs: InputOptions = AS_GIVEN

    def __post_init__(self) -> None:
        check_count("iterations", self.iterations)
        check_seeds((self.seed,))
        check_count("jobs", self.jobs)

    def request(self, progress: OnProgress) -> ComparisonRequest:
        """The request, with the sessions of all folders.

        Raises
        ------
        UsageError
            If an output is an input.
        DataError
            If a session does not exist or is damaged.
        """
        stills = session_paths(self.stills)
        request = ComparisonRequest(
            paths=list(dict.fromkeys([*session_paths(self.paths), *stills])),
            methods=methods(self.blocks),
            train=session_paths(self.train),
            stills=frozenset(stills),
            iterations=self.iterations,
            seed=self.seed,
            config=None if self.config is None else config_file(self.config, self.blocks),
            jobs=self.jobs,
            progress=progress,
            reading=self.inputs.reading,
        )
        self.inputs.check([*request.paths, *request.train], [self.config] if self.config else [])
        return request
