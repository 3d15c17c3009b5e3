"""Install a systemd service that reads one port; it starts at boot and when the gyro is plugged in.

It writes a unit and, for a USB adapter, a udev rule that names it /dev/gyro. --dry-run prints the files and commands.
Root controls the service through /run/gyrodrift/control: gyrodrift ctl.
"""

import argparse
import os
import subprocess
from pathlib import Path

from gyrodrift.cli.options import AUTO_PORT
from gyrodrift.config.model import load_config
from gyrodrift.config.outputs import output_of
from gyrodrift.io.files import write_whole
from gyrodrift.outputs.options import OutputSpec, secrets
from gyrodrift.values.errors import UsageError

EXAMPLES = """\
gyrodrift install-service --port /dev/ttyUSB0 --dry-run
gyrodrift install-service --port /dev/ttyUSB0 --config /etc/gyrodrift.yaml --output tcp
"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("--port", required=True, help="serial port of the device, such as /dev/ttyUSB0")
    parser.add_argument(
        "--config", type=Path, metavar="FILE", help="config of the service, followed while it runs (default: none)"
    )
    parser.add_argument(
        "--output",
        action="append",
        default=[],
        metavar="NAME[:KEY=VALUE,...]",
        help="output as in serve --output; repeatable (default: none)",
    )
    parser.add_argument("--dry-run", action="store_true", help="print the files and commands, change nothing")


def run(arguments: argparse.Namespace) -> int:
    """Write the files and start the service; exit status 0."""
    from gyrodrift.service.install import COMMANDS, files, usb_identity

    if arguments.port == AUTO_PORT:
        raise UsageError("--port auto: a service needs a fixed port; gyrodrift devices --listen shows it")
    for output in arguments.output:
        _check_is_public(output_of(output))
    if arguments.config is not None:
        load_config(arguments.config)
    written = files(arguments.port, arguments.config, arguments.output, usb_identity(arguments.port))
    if arguments.dry_run:
        for path, text in written.items():
            print(f"# {path}\n{text}")
        for command in COMMANDS:
            print(f"# run: {' '.join(command)}")
        return 0
    if os.geteuid() != 0:
        raise UsageError("install-service writes to /etc: run it as root, or use --dry-run")

    for path, text in written.items():
        path.parent.mkdir(parents=True, exist_ok=True)
        write_whole(path, [text])
        path.chmod(0o644)
        print(f"written: {path}")
    for command in COMMANDS:
        _run(command)
    return 0


def _check_is_public(spec: OutputSpec) -> None:
    """Refuse a secret in the unit, which every user of the machine can read."""
    for name in sorted(secrets(type(spec.options))):
        if getattr(spec.options, name):
            raise UsageError(f"--output {spec}: every user may read the unit: give {name} in a file, as {name}_file")


def _run(command: tuple[str, ...]) -> None:
    print(f"run: {' '.join(command)}")
    try:
        done = subprocess.run(command, check=False)  # noqa: S603 - a fixed list
    except FileNotFoundError as error:
        raise UsageError(f"{command[0]} is missing: this machine does not run systemd") from error
    if done.returncode:
        raise UsageError(f"{' '.join(command)} ended with {done.returncode}")
