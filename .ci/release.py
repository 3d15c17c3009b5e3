"""Build the files of a release: `python .ci/release.py [FOLDER]`, by default `dist`.

wheel, sdist, .deb, gyrodrift-c-VERSION.tar.gz, SBOM and checksums. What cannot be built on this machine is named on
stderr, and the exit status is 1.
"""

import gzip
import hashlib
import io
import json
import os
import re
import shutil
import subprocess
import sys
import tarfile
import tempfile
import tomllib
from collections.abc import Iterator
from datetime import UTC, datetime
from email.utils import format_datetime
from pathlib import Path
from typing import Any
from uuid import NAMESPACE_URL, uuid5

from man_pages import pages, release_date

from gyrodrift import __version__
from gyrodrift.firmware.targets import TARGETS, files_of

ROOT = Path(__file__).parent.parent
DEBIAN = ROOT / ".ci" / "debian"
FORMS = {"c": "", "arduino": "arduino/gyrodrift/", "platformio": "platformio/gyrodrift/"}
FORMS |= {"esp-idf": "esp-idf/gyrodrift/", "zephyr": "zephyr/gyrodrift/"}
"""Folder of each form of the C library in its archive."""

EXTRAS = ("websocket", "mqtt", "nmea", "prometheus")
"""Extras in the Debian package, as in the container."""

PYTHON = "/usr/bin/python3"
VENDORED = "usr/lib/gyrodrift"


class UnavailableError(Exception):
    """A file that this machine cannot build; the text says why."""


def release_time_s() -> int:
    """Time of the release: SOURCE_DATE_EPOCH, or the date of the version in the changelog."""
    stated = os.environ.get("SOURCE_DATE_EPOCH")
    if not (stated or release_date()):
        raise SystemExit(f"docs/CHANGELOG.md has no release {__version__} with a date")
    return int(stated or datetime.fromisoformat(release_date()).replace(tzinfo=UTC).timestamp())


def wheel_and_sdist(out: Path) -> None:
    """The sdist of the clone and the wheel of the sdist, the same bytes each time."""
    _build("sdist", ROOT, out)
    with tempfile.TemporaryDirectory() as folder:
        with tarfile.open(next(out.glob("gyrodrift-*.tar.gz"))) as archive:
            archive.extractall(folder, filter="data")
        _build("wheel", next(Path(folder).iterdir()), out)


def _build(target: str, source: Path, out: Path) -> None:
    environment = {**os.environ, "SOURCE_DATE_EPOCH": str(release_time_s())}
    words = [sys.executable, "-m", "hatchling", "build", "--target", target, "--directory", str(out.resolve())]
    _run(words, source, environment)


def c_library(out: Path) -> None:
    """Header, license and the forms for Arduino, PlatformIO, ESP-IDF and Zephyr."""
    top = f"gyrodrift-c-{__version__}"
    files = {f"{top}/{folder}{path}": text for name, folder in FORMS.items() for path, text in _form(name).items()}
    with tempfile.SpooledTemporaryFile() as packed:
        with tarfile.open(fileobj=packed, mode="w", format=tarfile.PAX_FORMAT) as archive:
            for path, text in sorted(files.items()):
                member = tarfile.TarInfo(path)
                content = text.encode()
                member.size, member.mtime, member.mode = len(content), release_time_s(), 0o644
                archive.addfile(member, io.BytesIO(content))
        packed.seek(0)
        (out / f"{top}.tar.gz").write_bytes(gzip.compress(packed.read(), mtime=release_time_s()))


def _form(name: str) -> dict[str, str]:
    return files_of(TARGETS[name])


def sbom(out: Path) -> None:
    """Components that the wheel needs, with the versions and hashes of uv.lock, as CycloneDX 1.6."""
    packages = {package["name"]: package for package in tomllib.loads(_text("uv.lock"))["package"]}
    named = _reachable(packages, "gyrodrift", {*EXTRAS, "lab"})
    components = [_component(packages[name]) for name in sorted(named - {"gyrodrift"})]
    uplot = _text("gyrodrift/outputs/web/page/uplot/LICENSE").partition("\n")[0]
    components.append({"type": "library", "name": "uplot", "bom-ref": "uplot", "description": f"live page; {uplot}"})
    content = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.6",
        "serialNumber": f"urn:uuid:{uuid5(NAMESPACE_URL, f'gyrodrift-{__version__}')}",
        "version": 1,
        "metadata": {
            "timestamp": datetime.fromtimestamp(release_time_s(), UTC).isoformat().replace("+00:00", "Z"),
            "component": {
                "type": "application",
                "name": "gyrodrift",
                "version": __version__,
                "bom-ref": "gyrodrift",
                "purl": f"pkg:pypi/gyrodrift@{__version__}",
                "licenses": [{"license": {"id": "MIT"}}],
            },
        },
        "components": components,
        "dependencies": [
            {"ref": name, "dependsOn": sorted({d["name"] for d in packages[name].get("dependencies", [])} & named)}
            for name in sorted(named)
        ],
    }
    (out / f"gyrodrift-{__version__}.cdx.json").write_text(json.dumps(content, indent=1) + "\n")


def _reachable(packages: dict[str, Any], name: str, extras: set[str]) -> set[str]:
    optional = packages[name].get("optional-dependencies", {})
    needed = [*packages[name].get("dependencies", []), *(d for extra in extras for d in optional.get(extra, []))]
    reached = {name}
    while needed:
        package = needed.pop()["name"]
        if package not in reached:
            reached.add(package)
            needed += packages[package].get("dependencies", [])
    return reached


def _component(package: dict[str, Any]) -> dict[str, Any]:
    files = [*package.get("wheels", []), *([package["sdist"]] if "sdist" in package else [])]
    hashes = [{"alg": "SHA-256", "content": file["hash"].removeprefix("sha256:")} for file in files]
    name, version = package["name"], package["version"]
    component: dict[str, Any] = {"type": "library", "name": name, "version": version, "bom-ref": name}
    return component | {"purl": f"pkg:pypi/{name}@{version}", "hashes": hashes}


def debian_package(out: Path) -> None:
    """Package for Debian and its relatives, for the Python and the processor of this machine."""
    if shutil.which("dpkg-buildpackage") is None or shutil.which("dh") is None:
        raise UnavailableError("no .deb: it needs Debian's tools; apt-get install dpkg-dev debhelper")
    with tempfile.TemporaryDirectory() as folder:
        source = Path(folder) / f"gyrodrift-{__version__}"
        _debian_source(source, next(out.glob("*.whl")))
        environment = {**os.environ, "SOURCE_DATE_EPOCH": str(release_time_s()), "DEB_BUILD_OPTIONS": "nocheck"}
        _run(["dpkg-buildpackage", "--build=binary", "--no-sign", "-d"], source, environment)
        for package in Path(folder).glob("*.deb"):
            shutil.copy(package, out)


def _debian_source(source: Path, wheel: Path) -> None:
    shutil.copytree(DEBIAN, source / "debian")
    version = subprocess.run(
        [PYTHON, "-c", "import sys; print(*sys.version_info[:2])"], capture_output=True, text=True, check=True
    )
    major, minor = map(int, version.stdout.split())
    words = {"@PYTHON@": f"{major}.{minor}", "@NEXT_PYTHON@": f"{major}.{minor + 1}"}
    words["@LICENSE@"] = "\n".join(f" {line}" if line else " ." for line in _text("LICENSE").splitlines()[2:])
    for name in ("control", "copyright"):
        path = source / "debian" / name
        path.write_text(re.sub("@[A-Z_]+@", lambda match: words[match[0]], path.read_text()))
    date = format_datetime(datetime.fromtimestamp(release_time_s(), UTC))
    signed = " -- The gyrodrift authors <gyrodrift@localhost.localdomain>  " + date
    entry = f"gyrodrift ({__version__}) unstable; urgency=medium\n\n  * Release {__version__}.\n\n{signed}\n"
    (source / "debian" / "changelog").write_text(entry)
    (source / "debian" / "rules").chmod(0o755)
    _tree(source / "tree", wheel)
    manual = source / "manual"
    manual.mkdir()
    for name, text in pages().items():
        (manual / name).write_text(text, encoding="utf-8")
    (source / "debian" / "gyrodrift.manpages").write_text("manual/*\n")
    (source / "debian" / "gyrodrift.service").write_text(_unit())


def _tree(tree: Path, wheel: Path) -> None:
    """The files of the package that debhelper does not install itself."""
    packages = tree / VENDORED
    packages.mkdir(parents=True)
    needed = tree.parent / "requirements.txt"
    export = [str(Path(sys.executable).parent / "uv"), "export", "--quiet", "--frozen", "--no-emit-project"]
    extras = [word for extra in EXTRAS for word in ("--extra", extra)]
    _run([*export, "--no-default-groups", *extras, "--output-file", str(needed)], ROOT, dict(os.environ))
    install = [sys.executable, "-m", "pip", "--python", PYTHON, "install", "--quiet", "--no-compile", "--no-deps"]
    install += ["--target", str(packages)]
    _run([*install, "--require-hashes", "--requirement", str(needed)], tree.parent, dict(os.environ))
    _run([*install, str(wheel.resolve())], tree.parent, dict(os.environ))
    shutil.rmtree(packages / "bin", ignore_errors=True)
    _without_tests(packages)
    program = tree / "usr" / "bin" / "gyrodrift"
    program.parent.mkdir(parents=True)
    # Processes that gyrodrift starts inherit the path; without PYTHONSAFEPATH a folder of the user would come first.
    words = f'PYTHONPATH=/{VENDORED} PYTHONSAFEPATH=1 exec {PYTHON} -m gyrodrift "$@"'
    program.write_text(f"#!/bin/sh\n{words}\n")
    program.chmod(0o755)
    config = tree / "etc" / "gyrodrift" / "gyrodrift.yaml"
    config.parent.mkdir(parents=True)
    shutil.copyfile(ROOT / "config" / "gyrodrift.yaml", config)
    completion = tree / "usr" / "share" / "bash-completion" / "completions" / "gyrodrift"
    completion.parent.mkdir(parents=True)
    done = subprocess.run(
        [sys.executable, "-m", "gyrodrift", "completion", "bash"], cwd=ROOT, capture_output=True, check=True
    )
    completion.write_bytes(done.stdout)


def _without_tests(packages: Path) -> None:
    """Remove the tests and headers of packages, which no program needs; no file may be executable."""
    for folder in [
        *packages.glob("numpy/**/tests"),
        *packages.glob("numpy/**/include"),
        *packages.glob("**/__pycache__"),
    ]:
        shutil.rmtree(folder, ignore_errors=True)
    for path in packages.rglob("*"):
        if path.is_file():
            path.chmod(0o644)


def _unit() -> str:
    """The unit of `gyrodrift install-service`, with the port and the options of /etc/default/gyrodrift and a user."""
    serve = "/usr/bin/gyrodrift serve --port ${PORT} --timeout 0 --log-format text $OPTIONS"
    control = "/run/gyrodrift/control"
    text = (
        _text("config/systemd/gyrodrift.service")
        .partition("\n")[2]
        .format(
            port="the port of /etc/default/gyrodrift",
            docs="man:gyrodrift-serve(1)",
            serve=f"{serve} --control {control}",
            reload=f"/usr/bin/gyrodrift ctl {control} reload",
            home="yes",
            source="",
        )
    )
    text = text.replace("DynamicUser=yes", "User=gyrodrift\nGroup=gyrodrift")
    return text.replace("[Service]\n", "[Service]\nEnvironmentFile=/etc/default/gyrodrift\n")


def checksums(out: Path) -> None:
    """SHA-256 of each file, as `sha256sum --check` reads them."""
    lines = [f"{hashlib.sha256(path.read_bytes()).hexdigest()}  {path.name}" for path in _files(out)]
    (out / "SHA256SUMS").write_text("\n".join(lines) + "\n")


def _files(out: Path) -> Iterator[Path]:
    return (path for path in sorted(out.iterdir()) if path.name != "SHA256SUMS")


def _run(words: list[str], folder: Path, environment: dict[str, str]) -> None:
    done = subprocess.run(words, cwd=folder, env=environment, capture_output=True, text=True, check=False)
    if done.returncode:
        raise UnavailableError(f"{words[0]} ended with {done.returncode}:\n{done.stdout[-2000:]}{done.stderr[-2000:]}")


def _text(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def main() -> int:
    """Build all files; 1 if one of them cannot be built here."""
    out = Path(sys.argv[1] if len(sys.argv) > 1 else ROOT / "dist")
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    missing = 0
    for step in (wheel_and_sdist, c_library, sbom, debian_package, checksums):
        try:
            step(out)
        except UnavailableError as error:
            print(f"release: {error}", file=sys.stderr)
            missing = 1
    for path in _files(out):
        print(f"{path.stat().st_size:>10}  {path}")
    return missing


if __name__ == "__main__":
    sys.exit(main())
