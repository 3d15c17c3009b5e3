"""Run gyrodrift as on Windows: python elsewhere.py MODULE ARGUMENTS, or -c CODE.

The modules termios, fcntl, pty and others cannot be imported. Functions and constants that Windows lacks are deleted.
`select.select` takes sockets only. Opening a text file without its encoding is an error, since it is not UTF-8 there.
Packages of others adapt to the real system, so they are imported before.
"""

import asyncio
import concurrent.futures.process
import contextlib
import ctypes.util
import getpass
import importlib
import logging.handlers
import multiprocessing.pool
import multiprocessing.resource_tracker
import os
import runpy
import select
import shutil
import signal
import socket
import socketserver
import stat
import subprocess
import sys
import tempfile
import warnings
from types import SimpleNamespace
from typing import Any

import serial
import serial.tools.list_ports

STANDARD = (asyncio, concurrent, ctypes, getpass, logging, multiprocessing, shutil, socketserver, subprocess, tempfile)
LAB_PACKAGES = ("matplotlib.pyplot", "numba", "scipy.stats", "cma")
MODULES = ("curses", "fcntl", "grp", "pty", "pwd", "readline", "resource", "syslog", "termios", "tty")
ABSENT: dict[Any, str] = {
    os: "O_CLOEXEC O_DIRECTORY O_NOCTTY O_NOFOLLOW O_NONBLOCK chown fchmod fchown fdatasync fork forkpty getegid "
    "geteuid getgid getgroups getloadavg getpgid getpriority getsid getuid killpg lchown major makedev minor mkfifo "
    "nice openpty pipe2 posix_fadvise posix_fallocate pread pwrite sched_getaffinity sched_setaffinity sched_yield "
    "set_blocking setpgid setpriority setsid statvfs sysconf ttyname uname",
    select: "PIPE_BUF POLLERR POLLHUP POLLIN POLLOUT POLLPRI epoll poll",
    signal: "ITIMER_PROF SIGALRM SIGCONT SIGHUP SIGKILL SIGPIPE SIGPROF SIGQUIT SIGSTOP SIGTSTP SIGUSR1 SIGUSR2 "
    "SIGWINCH pthread_kill pthread_sigmask setitimer sigwait",
    socket: "AF_UNIX MSG_DONTWAIT SCM_RIGHTS SOCK_CLOEXEC SOCK_NONBLOCK SOCK_SEQPACKET SO_PEERCRED",
}

real_select = select.select


def select_sockets(reading: list[int], writing: list[int], rest: list[int], timeout_s: float) -> Any:
    """Windows refuses descriptors that are no sockets, and to wait for nothing."""
    assert reading or writing
    assert all(stat.S_ISSOCK(os.fstat(fd).st_mode) for fd in (*reading, *writing))
    return real_select(reading, writing, rest, timeout_s)


def socket_pair() -> tuple[socket.socket, socket.socket]:
    """Windows connects two TCP sockets."""
    with socket.create_server(("127.0.0.1", 0)) as server:
        client = socket.create_connection(server.getsockname())
        return client, server.accept()[0]


def import_lab() -> None:
    for name in LAB_PACKAGES:
        with contextlib.suppress(ImportError):  # the extra lab is optional here too
            importlib.import_module(name)


def become_windows() -> None:
    importlib.import_module("numpy")
    for module in (os, select):  # pyserial and shutil keep the functions of this system
        setattr(serial.serialposix, module.__name__, SimpleNamespace(**vars(module)))
    vars(shutil)["os"] = SimpleNamespace(**vars(os))
    for name in MODULES:
        sys.modules[name] = None  # type: ignore[assignment]
    for module, names in ABSENT.items():
        for name in names.split():
            if hasattr(module, name):
                delattr(module, name)
    socket.socketpair = socket_pair  # type: ignore[assignment]


if __name__ == "__main__":
    warnings.filterwarnings("ignore", category=EncodingWarning)  # in packages of others
    warnings.filterwarnings("error", category=EncodingWarning, module="gyrodrift|firmware_sim")
    del sys.argv[0]
    if sys.argv[0] == "-c":
        import_lab()
        become_windows()
        exec(compile(sys.argv[1], "<command>", "exec"), {"__name__": "__main__"})
    else:
        become_windows()
        runpy.run_module(sys.argv[0], run_name="__main__", alter_sys=True)
