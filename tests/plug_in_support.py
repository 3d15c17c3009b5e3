"""Packages with plug-ins, installed for a test as pip does it: a module, and metadata beside it."""

import shutil
import tomllib
from dataclasses import dataclass
from pathlib import Path

EXAMPLES = Path(__file__).parent.parent / "docs" / "examples" / "plug-ins"


@dataclass(frozen=True)
class Site:
    """A folder of the path, in which packages are installed."""

    folder: Path

    def install(self, package: str, group: str, name: str, value: str, source: str | None = None) -> None:
        """A package with a plug-in; its source is that of a module with the name of the package."""
        if source is not None:
            (self.folder / f"{package}.py").write_text(source)
        metadata = self.folder / f"{package}-1.0.dist-info"
        metadata.mkdir()
        (metadata / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: 1.0\n")
        (metadata / "entry_points.txt").write_text(f"[{group}]\n{name} = {value}\n")

    def install_example(self, kind: str) -> str:
        """The example of the docs for a kind; returns its name."""
        project = tomllib.loads((EXAMPLES / kind / "pyproject.toml").read_text())["project"]
        ((group, entries),) = project["entry-points"].items()
        ((name, value),) = entries.items()
        shutil.copy(EXAMPLES / kind / f"{project['name']}.py", self.folder)
        self.install(project["name"], group, name, value)
        return str(name)
