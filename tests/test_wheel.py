"""The wheel, as `pipx install .` builds it: installed into an environment of its own, run from a folder of its own."""

import json
import os
import re
import shlex
import subprocess
import sys
import venv
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest
import yaml
from distribution_support import built_distributions

import gyrodrift

ROOT = Path(__file__).parent.parent

pytestmark = [pytest.mark.packaging, pytest.mark.xdist_group("wheel")]  # it is built once

WITHOUT_CMA = "import sys; sys.modules['cma'] = None; from gyrodrift.cli import main; sys.exit(main(sys.argv[1:]))"


@dataclass(frozen=True)
class Installed:
    """A Python with gyrodrift, and a folder that has nothing to do with where it comes from."""

    bin: Path
    folder: Path

    def run(self, *words: str | Path) -> "subprocess.CompletedProcess[str]":
        return subprocess.run(
            self.command(*words), cwd=self.folder, env=without_clone(), capture_output=True, text=True, check=False
        )

    def command(self, *words: str | Path) -> list[str]:
        return [str(self.bin / words[0]), *map(str, words[1:])]

    @contextmanager
    def running(self, *words: str | Path) -> "Iterator[subprocess.Popen[str]]":
        """A command that does not end by itself; it is stopped at the end of the block."""
        process = subprocess.Popen(
            self.command(*words),
            cwd=self.folder,
            env=without_clone(),
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        try:
            yield process
        finally:
            process.terminate()
            process.communicate()


def without_clone() -> dict[str, str]:
    """The environment of a user who has the wheel alone."""
    return {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}


def commands_without_parts(link: Path) -> list[list[str]]:
    """Commands of the page "From parts to yaw" for users without hardware, on a link of the test."""
    page = (ROOT / "docs" / "from-parts-to-yaw.md").read_text().partition("\n## Without parts\n")[2]
    block = re.search(r"^```sh\n(.*?)^```$", page.partition("\n## ")[0], re.MULTILINE | re.DOTALL)
    assert block, "the page has commands for users without parts"
    text = block[1].replace("/tmp/gyro", str(link)).replace("--output web", "--output web:port=0")
    return [shlex.split(line, comments=True) for line in text.splitlines()]


@pytest.fixture(scope="module")
def installed(tmp_path_factory: pytest.TempPathFactory) -> Installed:
    """From a wheel that was just built; what it depends on is that of the tests."""
    folder, wheel = tmp_path_factory.mktemp("wheel"), built_distributions().wheel
    venv.create(folder / "venv", with_pip=False)
    python = folder / "venv" / "bin" / "python"
    install = [sys.executable, "-m", "pip", "--python", str(python), "install", "--no-deps", "--no-index", str(wheel)]
    subprocess.run(install, capture_output=True, check=True)
    (site,) = (folder / "venv" / "lib").glob("python*/site-packages")
    (site / "of-the-tests.pth").write_text("".join(f"{p}\n" for p in sys.path if p.endswith("site-packages")))
    position = folder / "elsewhere"
    position.mkdir()
    return Installed(python.parent, position)


def test_it_says_where_it_runs_from(installed: Installed) -> None:
    done = installed.run("gyrodrift", "--version")
    assert done.returncode == 0
    assert done.stdout.startswith(f"gyrodrift {gyrodrift.__version__} from {installed.bin.parent}/lib/")
    assert f"{installed.bin}/python" in done.stdout


def test_its_types_are_for_others_too(installed: Installed) -> None:
    (site,) = (installed.bin.parent / "lib").glob("python*/site-packages")
    assert (site / "gyrodrift" / "py.typed").is_file()
    assert (site / "firmware_sim" / "py.typed").is_file()


def test_rigs_profiles_and_config_are_inside(installed: Installed) -> None:
    """A simulated session is filtered, and the demo runs with what is shipped."""
    simulated = installed.run("gyrodrift", "simulate", "--out", "s", "--minutes", "0.05", "--profile", "identify")
    assert simulated.returncode == 0
    assert "s/session-01.mcap" in simulated.stderr
    filtered = installed.run("gyrodrift", "filter", "s/session-01.mcap", "--out", "yaw.csv")
    assert filtered.returncode == 0
    assert "yaw_sigma_deg" in (installed.folder / "yaw.csv").read_text().splitlines()[0]
    demo = installed.run("gyrodrift", "demo", "--duration", "2", "--speed", "20")
    assert (demo.returncode, demo.stderr) == (0, "")
    assert "gyrodrift        mean |error|" in demo.stdout


@pytest.mark.parametrize("target", ["arduino", "zephyr", "esphome", "micropython", "c"])
def test_the_firmware_is_inside(installed: Installed, target: str) -> None:
    """The command writes each library without a clone."""
    written = installed.run("gyrodrift", "firmware", "--out", f"board-{target}", "--target", target)
    assert (written.returncode, written.stderr) == (0, "")
    folder = installed.folder / f"board-{target}"
    name = "gyrodrift_native.py" if target == "micropython" else "gyrodrift.h"
    assert [path.name for path in folder.rglob(name)] == [name]


@pytest.mark.parametrize("where", ["wheel", "clone"])
def test_the_command_that_a_message_gives_installs_the_extra(where: str, installed: Installed) -> None:
    item = installed if where == "wheel" else Installed(Path(sys.executable).parent, installed.folder)
    done = item.run("python", "-c", WITHOUT_CMA, "tune", "s", "--out", "found.yaml")
    assert done.returncode == 2
    statement, _, command = done.stderr.rstrip("\n").partition(": ")[2].partition(": ")
    assert statement == "tune needs the package cma"
    words = [word for word in shlex.split(command) if word != "--editable"]  # which needs a package to build with
    offline = ["--no-index", "--no-build-isolation", "--dry-run"]
    tried = subprocess.run([*words, *offline], capture_output=True, text=True, check=False)
    assert tried.returncode == 0, tried.stderr
    assert re.search(r"/\S+\[lab\]'?$", command)


@pytest.mark.promise("Installation and systems")
@pytest.mark.long
def test_the_page_from_parts_to_yaw_works_without_parts(installed: Installed, tmp_path: Path) -> None:
    """With an installed wheel, the commands of From parts to yaw work without hardware."""
    link = tmp_path / "gyro"
    device, devices, doctor, calibrate, serve = commands_without_parts(link)
    assert (device[:2], device.pop()) == (["gyrodrift", "simulated-device"], "&")
    with installed.running("python", ROOT / "tests" / "patient_device.py", *device[2:], "--speed", "3") as simulated:
        while not link.is_symlink():
            assert simulated.poll() is None, "the simulated device ended"
        listed = installed.run("python", "-c", only_below(tmp_path), *devices[1:])
        assert f"{link}\n" in listed.stdout
        assert re.search(r"speaks +native", listed.stdout), listed.stdout
        looked = installed.run(*doctor)
        assert looked.returncode == 0, looked.stdout + looked.stderr
        calibrated = installed.run(*calibrate)
        assert calibrated.returncode == 0, calibrated.stderr
        result = yaml.safe_load((installed.folder / "my.yaml").read_text())["calibration"]
        assert (result["scale_ccw"], result["scale_cw"]) == pytest.approx((1 / 1.012, 1 / 1.012), abs=2e-4)
        with installed.running(*serve) as service:
            assert service.stdout is not None
            samples = map(json.loads, service.stdout)
            turn = next(sample for sample in samples if sample["encoder_deg"] == 360.0)
    assert turn["yaw_deg"] == pytest.approx(360.0, abs=0.5)


def only_below(folder: Path) -> str:
    """A program that runs gyrodrift where no other simulated devices are: those of other tests are left alone."""
    return f"""
import sys
from pathlib import Path
from firmware_sim import reservation
all_links = reservation.reserved_links
reservation.reserved_links = lambda: [link for link in all_links() if link.is_relative_to({str(folder)!r})]
from gyrodrift.cli import main
sys.exit(main(sys.argv[1:]))
"""
