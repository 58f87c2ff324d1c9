"""The parts of the sandbox: Landlock rules, a seccomp filter and resource limits. This module is for Linux only.

See https://docs.kernel.org/userspace-api/landlock.html and https://docs.kernel.org/userspace-api/seccomp_filter.html.
"""

from __future__ import annotations

import ctypes
import errno
import os
import platform
import resource
import struct
import sys
from collections.abc import Iterable
from pathlib import Path

from crowdbot.core import InputError

assert sys.platform == "linux"

NO_NEW_PRIVILEGES, SET_SECCOMP, FILTER = 38, 22, 2
CREATE_RULESET, ADD_RULE, RESTRICT_SELF = 444, 445, 446
EXECUTE, WRITE, READ, READ_DIRECTORY = 1 << 0, 1 << 1, 1 << 2, 1 << 3
ACCESS_BITS = (13, 14, 15, 15, 16)
"""Number of kinds of access to files in each version of Landlock, the last one also for later versions."""
ALLOWED, REFUSED, MISSING = 0x7FFF0000, 0x00050000 | errno.EPERM, 0x00050000 | errno.ENOSYS
THREAD = 0x00010000
"""CLONE_THREAD: a new thread, not a new process."""

_X86 = {
    "shmget": 29, "socket": 41, "connect": 42, "accept": 43, "sendto": 44, "sendmsg": 46, "bind": 49, "listen": 50,
    "socketpair": 53, "clone": 56, "fork": 57, "vfork": 58, "execve": 59, "kill": 62, "truncate": 76, "chmod": 90,
    "fchmod": 91, "chown": 92, "fchown": 93, "lchown": 94, "ptrace": 101, "utime": 132, "mount": 165, "umount2": 166,
    "setxattr": 188, "lsetxattr": 189, "fsetxattr": 190, "removexattr": 197, "lremovexattr": 198, "tkill": 200,
    "tgkill": 234, "utimes": 235, "mq_open": 240, "keyctl": 250, "fchownat": 260, "futimesat": 261, "fchmodat": 268,
    "unshare": 272, "utimensat": 280, "accept4": 288, "perf_event_open": 298, "prlimit64": 302,
    "open_by_handle_at": 304, "setns": 308, "process_vm_readv": 310, "process_vm_writev": 311, "bpf": 321,
    "execveat": 322, "io_uring_setup": 425, "pidfd_send_signal": 424, "pidfd_open": 434, "clone3": 435,
    "pidfd_getfd": 438, "fchmodat2": 452,
}  # fmt: skip
_ARM = {
    "setxattr": 5, "lsetxattr": 6, "fsetxattr": 7, "removexattr": 14, "lremovexattr": 15, "umount2": 39, "mount": 40,
    "truncate": 45, "fchmod": 52, "fchmodat": 53, "fchownat": 54, "fchown": 55, "utimensat": 88, "unshare": 97,
    "ptrace": 117, "kill": 129, "tkill": 130, "tgkill": 131, "mq_open": 180, "shmget": 194, "socket": 198,
    "socketpair": 199, "bind": 200, "listen": 201, "accept": 202, "connect": 203, "sendto": 206, "sendmsg": 211,
    "keyctl": 219, "clone": 220, "execve": 221, "perf_event_open": 241, "accept4": 242, "prlimit64": 261,
    "open_by_handle_at": 265, "setns": 268, "process_vm_readv": 270, "process_vm_writev": 271, "bpf": 280,
    "execveat": 281, "io_uring_setup": 425, "pidfd_send_signal": 424, "pidfd_open": 434, "clone3": 435,
    "pidfd_getfd": 438, "fchmodat2": 452,
}  # fmt: skip
MACHINES = {"x86_64": (0xC000003E, _X86), "aarch64": (0xC00000B7, _ARM)}
"""Audit architecture and numbers of system calls by processor."""


def kernel_problem() -> str | None:
    """Return what the processor or the kernel lacks for the sandbox, None if nothing."""
    if platform.machine() not in MACHINES:
        return f"the sandbox knows {' and '.join(MACHINES)}, this is {platform.machine()}"
    if _landlock_version(ctypes.CDLL(None, use_errno=True)) < 1:
        return "the sandbox needs Landlock, which this kernel does not have or has switched off"
    return None


def restrict_process(
    readable: Iterable[Path], writable: Iterable[Path], memory: int | None, cpu: int | None, programs: bool
) -> None:
    """Put this process into the sandbox for good, see :func:`~crowdbot.navigation.process.sandbox.enter_sandbox`.

    Raises:
        InputError: the kernel refuses it.
    """
    library = ctypes.CDLL(None, use_errno=True)
    _limit(memory, cpu)
    _drop_capabilities(library)
    if library.prctl(NO_NEW_PRIVILEGES, 1, 0, 0, 0):
        raise InputError(f"the sandbox cannot be entered: {os.strerror(ctypes.get_errno())}")
    _close_files(library, readable, writable)
    _close_calls(library, programs)


def _landlock_version(library: ctypes.CDLL) -> int:
    return int(library.syscall(CREATE_RULESET, None, 0, 1))


def _limit(memory: int | None, cpu: int | None) -> None:
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000_000, 100_000_000))
    resource.setrlimit(resource.RLIMIT_NOFILE, (256, 256))
    if memory is not None:
        resource.setrlimit(resource.RLIMIT_AS, (memory, memory))
    if cpu is not None:
        resource.setrlimit(resource.RLIMIT_CPU, (cpu, cpu))


def _drop_capabilities(library: ctypes.CDLL) -> None:
    """Give up the rights of the superuser, so that limits hold for it too."""
    header, nothing = struct.pack("<Ii", 0x20080522, 0), bytes(24)
    _check(library.capset(header, nothing) == 0)


def _close_files(library: ctypes.CDLL, readable: Iterable[Path], writable: Iterable[Path]) -> None:
    version = min(_landlock_version(library), len(ACCESS_BITS))
    everything = (1 << ACCESS_BITS[version - 1]) - 1
    handled = ctypes.c_uint64(everything)
    rules = library.syscall(CREATE_RULESET, ctypes.byref(handled), 8, 0)
    _check(rules >= 0)
    for access, paths in ((READ | READ_DIRECTORY | EXECUTE, readable), (everything, writable)):
        for path in paths:
            try:
                place = os.open(path, os.O_PATH | os.O_CLOEXEC)
            except OSError:
                continue
            allowed = access if path.is_dir() else access & (READ | EXECUTE | WRITE)
            attributes = struct.pack("<Qi", allowed, place)
            _check(library.syscall(ADD_RULE, rules, 1, attributes, 0) == 0)
            os.close(place)
    _check(library.syscall(RESTRICT_SELF, rules, 0) == 0)
    os.close(rules)


class _Program(ctypes.Structure):
    """``struct sock_fprog``."""

    _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_char_p))


def _close_calls(library: ctypes.CDLL, programs: bool) -> None:
    """Refuse the listed system calls; ``clone`` may start threads, and ``clone3`` seems to be missing."""
    code = _filter(programs)
    program = _Program(len(code) // 8, code)
    _check(library.prctl(SET_SECCOMP, FILTER, ctypes.byref(program), 0, 0) == 0)


def _filter(programs: bool) -> bytes:
    load, equal, bits, end = 0x20, 0x15, 0x45, 0x06

    def line(code: int, value: int, yes: int = 0, no: int = 0) -> bytes:
        return struct.pack("<HBBI", code, yes, no, value)

    architecture, calls = MACHINES[platform.machine()]
    found = [line(load, 4), line(equal, architecture, 1, 0), line(end, REFUSED), line(load, 0)]
    if platform.machine() == "x86_64":  # calls of the x32 interface have other numbers
        found += [line(0x35, 0x40000000, 0, 1), line(end, REFUSED)]
    for name, number in calls.items():
        if programs and name in ("execve", "execveat"):
            continue
        if name in ("clone", "prlimit64"):  # threads only; limits of this process only
            test = line(bits, THREAD, 1, 0) if name == "clone" else line(equal, 0, 1, 0)
            found += [line(equal, number, 0, 4), line(load, 16), test, line(end, REFUSED), line(end, ALLOWED)]
        else:
            found += [line(equal, number, 0, 1), line(end, MISSING if name == "clone3" else REFUSED)]
    return b"".join([*found, line(end, ALLOWED)])


def _check(good: bool) -> None:
    if not good:
        raise InputError(f"the sandbox cannot be entered: {os.strerror(ctypes.get_errno())}")
