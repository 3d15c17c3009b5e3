"""Reason why this user may not open a port, and how to get permission: groups, udev, containers."""

import grp
import os
import pwd
import stat
from contextlib import suppress
from pathlib import Path

SERIAL_GROUPS = ("dialout", "uucp")
"""Groups of serial ports: dialout on Debian and Fedora, uucp on Arch."""

PRIVILEGED = frozenset({"root", "wheel", "sudo", "adm", "kmem", "disk", "shadow"})
"""Groups with more rights than a serial port needs."""

TERMINALS = "tty"
"""Group of terminals; its members may not open the terminals of others."""

READ_WRITE = stat.S_IRGRP | stat.S_IWGRP


def how_to_get_permission(path: str) -> str:
    """Advice for a user who may not open this port."""
    device = Path(os.path.realpath(path))
    status = device.stat()
    name = _group_name(status.st_gid)
    has_group_access = status.st_mode & READ_WRITE == READ_WRITE
    if os.geteuid() == 0 or (has_group_access and status.st_gid in {os.getegid(), *os.getgroups()}):
        return "its owner and group allow it, so a container without this device, or a sandbox, refuses it"
    if name is None and has_group_access:
        gid = status.st_gid
        return f"it belongs to group {gid}, which has no name here: start the container with --group-add {gid}"
    if name == TERMINALS:
        return f"it is a terminal of {_user_name(status.st_uid)}, not a serial port"
    if name is None or name in PRIVILEGED or not has_group_access:
        return _by_a_rule(device, status)
    if _is_member(name):
        return f"you are in its group {name}, but not since this login: log in again, or run 'newgrp {name}' first"
    return f"it belongs to group {name}: run 'sudo usermod -aG {name} $USER' and log in again"


def _by_a_rule(device: Path, status: os.stat_result) -> str:
    """Advice for a port without a group for users: a udev rule."""
    owner, group = _user_name(status.st_uid), _group_name(status.st_gid) or str(status.st_gid)
    mode = stat.S_IMODE(status.st_mode)
    serial = next((name for name in SERIAL_GROUPS if _exists(name)), SERIAL_GROUPS[0])
    rule = f'KERNEL=="{device.name}", GROUP="{serial}", MODE="0660"'
    join = "" if _is_member(serial) else f" and join it with 'sudo usermod -aG {serial} $USER'"
    return (
        f"it belongs to {owner}:{group} with mode {mode:04o}, which users cannot join; until the next boot, "
        f"'sudo setfacl -m u:$USER:rw {device}' opens it; to keep it, put {rule} into "
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
    """Whether the user is a member by the group database, whatever this login has."""
    with suppress(KeyError):
        entry, user = grp.getgrnam(group), pwd.getpwuid(os.getuid())
        return user.pw_name in entry.gr_mem or user.pw_gid == entry.gr_gid
    return False
