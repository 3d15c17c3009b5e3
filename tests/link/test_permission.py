"""A port that may not be opened: what this user is told, by whose it is, its mode, and the groups that there are.

The system's refusal is played, since tests may run as root, who is refused nothing; so are its groups and users.
"""

import grp
import os
import pwd
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import pytest
import serial
from support import speaking_on

from gyrodrift.link.port import Port
from gyrodrift.values.errors import PortDeniedError

GROUPS = {"root": 0, "tty": 5, "dialout": 20, "uucp": 986, "rig": 1234}
USER, USER_ID = "ada", 1000
UNKNOWN = 4321

Refused = Callable[..., str]


@pytest.fixture
def refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Refused:
    def refuse(*_: object, **__: object) -> None:
        raise PermissionError(13, "Permission denied")

    def message(group: int, mode: int = 0o660, joined: tuple[str, ...] = (), here: tuple[int, ...] = ()) -> str:
        entries = {
            name: SimpleNamespace(gr_name=name, gr_gid=number, gr_mem=[USER] if name in joined else [])
            for name, number in GROUPS.items()
        }
        by_number = {entry.gr_gid: entry for entry in entries.values()}
        monkeypatch.setattr(serial, "Serial", refuse)
        monkeypatch.setattr(grp, "getgrnam", entries.__getitem__)
        monkeypatch.setattr(grp, "getgrgid", by_number.__getitem__)
        monkeypatch.setattr(pwd, "getpwuid", _user)
        monkeypatch.setattr(os, "getuid", lambda: USER_ID)
        monkeypatch.setattr(os, "geteuid", lambda: USER_ID)
        monkeypatch.setattr(os, "getegid", lambda: USER_ID)
        monkeypatch.setattr(os, "getgroups", lambda: list(here))
        with speaking_on(tmp_path / "gyro") as device:
            os.chown(device.slave_name, -1, group)
            Path(device.slave_name).chmod(mode)
            with pytest.raises(PortDeniedError) as caught:
                Port(str(tmp_path / "gyro"), 115200)
        return str(caught.value).partition("no permission to open it; ")[2]

    return message


def _user(number: int) -> SimpleNamespace:
    return SimpleNamespace(pw_name=USER if number == USER_ID else "root", pw_gid=number)


@pytest.mark.parametrize("group", ["dialout", "uucp", "rig"])
def test_a_group_of_users_is_joined(refused: Refused, group: str) -> None:
    advice = f"it belongs to group {group}: run 'sudo usermod -aG {group} $USER' and log in again"
    assert refused(GROUPS[group]) == advice


@pytest.mark.parametrize(("group", "mode"), [("root", 0o600), ("root", 0o660), ("dialout", 0o600), ("dialout", 0o640)])
def test_nobody_is_told_to_join_root_or_a_group_that_may_not_open_it(refused: Refused, group: str, mode: int) -> None:
    """A rule of udev is what helps, and an access list until then."""
    statement = refused(GROUPS[group], mode)
    assert f"usermod -aG {group} " not in statement or group == "dialout"
    assert statement.startswith(f"it belongs to root:{group} with mode {mode:04o}, which users cannot join")
    assert "sudo setfacl -m u:$USER:rw /dev/pts/" in statement
    assert 'GROUP="dialout", MODE="0660" into /etc/udev/rules.d/99-gyro.rules' in statement
    assert statement.endswith("join it with 'sudo usermod -aG dialout $USER'")


def test_a_user_of_the_group_of_the_rule_need_not_join_it_again(refused: Refused) -> None:
    """The rule alone is left to be done."""
    assert refused(0, 0o600, joined=("dialout",)).endswith("into /etc/udev/rules.d/99-gyro.rules")


def test_a_group_that_was_joined_since_this_login_counts_from_the_next(refused: Refused) -> None:
    """The most common stumble of all."""
    statement = refused(GROUPS["dialout"], joined=("dialout",))
    assert (
        statement
        == "you are in its group dialout, but not since this login: log in again, or run 'newgrp dialout' first"
    )


def test_who_may_open_it_and_is_refused_is_held_back_by_something_else(refused: Refused) -> None:
    assert "so a container" in refused(GROUPS["dialout"], here=(GROUPS["dialout"],))


def test_a_terminal_is_no_serial_port(refused: Refused) -> None:
    assert refused(GROUPS["tty"], 0o620) == "it is a terminal of root, not a serial port"


def test_a_group_of_the_host_without_a_name_in_a_container_is_added_to_it(refused: Refused) -> None:
    assert refused(UNKNOWN).endswith(f"start the container with --group-add {UNKNOWN}")
