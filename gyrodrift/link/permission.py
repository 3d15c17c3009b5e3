"""Why a port may not be opened, and what gives this user the right to: groups, udev, containers."""

import grp
import os
import pwd
import stat
from contextlib import suppress
from pathlib import Path

SERIAL_GROUPS = ("dialout", "uucp")
"""Groups that distributions give serial ports to: Debian and Fedora the first, Arch the second."""

PRIVILEGED = frozenset({"root", "wheel", "sudo", "adm", "kmem", "disk", "shadow"})
"""Groups that give far more than a port."""

TERMINALS = "tty"
"""Group of terminals; joining it opens nobody else's."""

READ_WRITE = stat.S_IRGRP | stat.S_IWGRP


def how_to_get_permission(path: str) -> str:
    """What to tell a user who may not open this port."""
    device = Path(os.path.realpath(path))
    status = device.stat()
    name = _group_name(status.st_gid)
    has_group_access = status.st_mode & READ_WRITE == READ_WRITE
    if os.geteuid() == 0 or (has_group_access and status.st_gid in {os.getegid(), *os.getgroups()}):
        return "its owner and group allow it, so something else refuses: a container without this device, or a sandbox"
    if name is None and has_group_access:
        gid = status.st_gid
        return f"it belongs to group {gid}, which has no name here: in a container, start that with --group-add {gid}"
    if name == TERMINALS:
        return f"it is a terminal of {_user_name(status.st_uid)}, and no serial port"
    if name is None or name in PRIVILEGED or not has_group_access:
        return _by_a_rule(device, status)
    if _is_member(name):
        return f"you are in its group {name}, but not since this login: log in again, or run 'newgrp {name}' first"
    return f"it belongs to group {name}: run 'sudo usermod -aG {name} $USER' and log in again"


def _by_a_rule(device: Path, status: os.stat_result) -> str:
    """Of a port that no group of common users may open: a rule of udev gives it to one."""
    owner, group = _user_name(status.st_uid), _group_name(status.st_gid) or str(status.st_gid)
    mode = stat.S_IMODE(status.st_mode)
    serial = next((name for name in SERIAL_GROUPS if _exists(name)), SERIAL_GROUPS[0])
    rule = f'KERNEL=="{device.name}", GROUP="{serial}", MODE="0660"'
    join = "" if _is_member(serial) else f" and join it with 'sudo usermod -aG {serial} $USER'"
    return (
        f"it belongs to {owner}:{group} with mode {mode:04o}, which is no group for users; until the next boot, "
        f"'sudo setfacl -m u:$USER:rw {device}' opens it; for good, put {rule} into "
        f"/etc/udev/rules.d/99-gyro.rules{join}"
    )


def _group_name(group_id: int) -> str | None:
    try:
        return grp.getgrgid(group_id).gr_name
    except KeyError:
        return None


def _exists(group: str) -> bool:
    with suppress(KeyError):
        return bool(grp.getgrnam(group))
    return False


def _user_name(user_id: int) -> str:
    try:
        return pwd.getpwuid(user_id).pw_name
    except KeyError:
        return f"user {user_id}"


def _is_member(group: str) -> bool:
    """By the database, whatever this login has."""
    with suppress(KeyError):
        found, user = grp.getgrnam(group), pwd.getpwuid(os.getuid())
        return user.pw_name in found.gr_mem or user.pw_gid == found.gr_gid
    return False
