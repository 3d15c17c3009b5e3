"""A diagnosis as the command and the library ask for it."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from firmware_sim.effects.catalogue import CATALOGUE
from firmware_sim.rig import load_rig
from firmware_sim.yaml_file import FileError
from gyrodrift.diagnose.stages import DiagnosisRequest
from gyrodrift.io.progress import OnProgress
from gyrodrift.session.checks.given import AS_GIVEN, InputOptions, check_count, check_name
from gyrodrift.session.checks.stated import ReadingOptions
from gyrodrift.session.files import session_paths
from gyrodrift.values.errors import UsageError


@dataclass(frozen=True, slots=True)
class DiagnoseOptions:
    """Options of a diagnosis.

    paths, baseline
        Sessions or folders of sessions; earlier ones of the same device, to explain the difference to them.
    rig
        Rig file of the simulator; None for the shipped rig.
    withhold
        Effects excluded from the candidates.
    jobs
        Processes.
    baseline_reading
        Columns and units of the baseline; None for those of the sessions.

    Raises
    ------
    UsageError
        If an effect does not exist, or a number is out of range.
    """

    paths: Sequence[Path]
    rig: Path | None = None
    baseline: Sequence[Path] = ()
    withhold: frozenset[str] = frozenset()
    jobs: int = 1
    inputs: InputOptions = AS_GIVEN
    baseline_reading: ReadingOptions | None = None

    def __post_init__(self) -> None:
        for name in sorted(self.withhold):
            check_name("withhold", name, CATALOGUE, "effect")
        check_count("jobs", self.jobs)

    def request(self, progress: OnProgress) -> DiagnosisRequest:
        """The request, with the rig and the sessions of all folders.

        Raises
        ------
        UsageError
            If the rig file is wrong, or an output is an input.
        DataError
            If a session does not exist or is damaged.
        """
        try:
            rig = load_rig(self.rig)
        except FileError as error:
            raise UsageError(str(error)) from error
        paths, baseline = session_paths(self.paths), session_paths(self.baseline)
        self.inputs.check([*paths, *baseline], [self.rig] if self.rig else [])
        return DiagnosisRequest(
            paths,
            rig,
            self.withhold,
            self.jobs,
            progress,
            baseline,
            reading=self.inputs.reading,
            baseline_reading=self.inputs.reading if self.baseline_reading is None else self.baseline_reading,
            is_rig_stated=self.rig is not None,
        )
