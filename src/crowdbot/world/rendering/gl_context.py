"""A place to draw without a screen: EGL where it works, otherwise OSMesa."""

from __future__ import annotations

import atexit
import functools
import importlib
import os
import subprocess
import sys
from typing import Any

from crowdbot.core import InputError
from crowdbot.world.physics.engine import engine

__all__ = ["backend", "canvas", "closed"]

KNOWN = ("egl", "osmesa", "glfw", "cgl")
PROBE = "import mujoco.{name} as way; context = way.GLContext(16, 16); context.make_current(); context.free()"
OPEN: list[Any] = []
"""Contexts that are in use."""
LONGEST = 60.0
"""Seconds that a trial of a way to draw may take."""


@functools.cache
def backend() -> str:
    """Return the way to draw: what ``MUJOCO_GL`` asks for, otherwise the first of EGL and OSMesa that works.

    Raises:
        InputError: neither works, or ``MUJOCO_GL`` asks for something unknown.
        MissingExtra: mujoco is not installed.
    """
    engine()
    asked = os.environ.get("MUJOCO_GL", "").lower() or os.environ.get("PYOPENGL_PLATFORM", "").lower()
    if asked:
        if asked not in KNOWN:
            raise InputError(f"MUJOCO_GL = {asked!r} must be one of {', '.join(KNOWN)} to draw, or unset")
        return asked
    if sys.platform == "darwin":
        return "cgl"
    if sys.platform == "win32":
        return "glfw"
    for name in ("egl", "osmesa"):
        if _works(name):
            return name
    raise InputError(
        "there is no way to draw here: neither EGL nor OSMesa works; install one (Debian: apt install libosmesa6)"
    )


def canvas(width: int, height: int) -> Any:
    """Return a context of OpenGL of this size, made current.

    Raises:
        InputError: there is no way to draw.
    """
    name = backend()
    try:
        made = importlib.import_module(f"mujoco.{name}").GLContext(width, height)
        made.make_current()
    except Exception as error:  # each way to draw has errors of its own
        raise InputError(
            f"drawing through {name} does not work here ({str(error).strip() or type(error).__name__});"
            " set MUJOCO_GL to egl or osmesa before Python starts"
        ) from error
    if not OPEN:
        atexit.register(_closed)  # after the way to draw was loaded, so that it is closed before that is
    OPEN.append(made)
    return made


def closed(context: Any, drawn_by: Any) -> None:
    """Give a context back, and what draws in it."""
    if context in OPEN:
        OPEN.remove(context)
        context.make_current()
        drawn_by.free()
        context.free()


def _closed() -> None:
    while OPEN:
        OPEN.pop().free()


def _works(name: str) -> bool:
    """Try in a process of its own: a way that failed would spoil the next one."""
    program = PROBE.format(name=name)
    try:
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, timeout=LONGEST, check=False)  # noqa: S603
    except (OSError, subprocess.TimeoutExpired):
        return False
    return run.returncode == 0
